"""Runs that end when they are accurate: `gaspart.run` and `gaspart.resume`, and what a run has reached.

A run is examined when it has 64, 96, 128, 192 ... frames, whatever the time of day or the number of kills, on
its frames so far without their first quarter. Each examination gives a value and its standard error e with f
degrees of freedom. A run that ended at the first e that is small enough would end when e happens to be too
small: its 95 % intervals would cover the true value in 88 to 94 % of runs. Two rules prevent this:

- The error that counts is the larger one of two successive examinations, that of the earlier one times the
  root of the ratio of their lengths. An error that fell by chance alone does not end the run, and intervals
  from this one, with Student's t for f degrees of freedom, cover the true value in 95 % of runs.
- An upper bound of this error must be as small as required: e sqrt(f / chi2), chi2 the lower 10 % quantile of
  chi-square for f, which is 1.32 e for f = 15 and 1.10 e for 100. f must be 15 or more, as of 16 independent
  blocks. So the true standard error is as small as required in 98 % of runs.

Both were measured with autoregressive series (`tests/tradeoff/test_until.py`); for fixed widths and
independent samples the first is the problem of Chow and Robbins, Ann. Math. Stat. 36, 457 (1965).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from gaspart.engines import Engine
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.trajectory import run as trajectory
from gaspart.trajectory.correlator import Correlations
from gaspart.trajectory.recipe import Recipe, read_recipe
from gaspart.trajectory.recording import Progress
from gaspart.trajectory.until import Accuracy, Until, examined_before

if TYPE_CHECKING:
    import xarray as xr

    from gaspart.analysis.estimate import Estimate

LEAST_FREEDOM = 15.0
"""Degrees of freedom of an error that can end a run."""
_DOUBT = 0.1
"""Probability with which the true error exceeds its bound."""
_CONFIDENCE = 0.95
_FUNCTIONS = {
    "Z": "compressibility_factor",
    "D": "diffusion_coefficient",
    "collision_rate": "collision_rate",
    "shear_viscosity": "shear_viscosity",
}
"""Observables -> functions of `gaspart.analysis`; those of walls are in `_pressures`."""
_TOO_SHORT = ("frames", "duration", "collisions", "start", "D")
"""Keys of the errors of an analysis that a longer run may not have."""


@dataclass(frozen=True)
class Reached:
    """What a run knows of an observable.

    asked: what is required; component: the face or axis that is known worst, "" for a scalar; value; error:
    its standard error, correlations included, the larger one of the last two examinations, inf where nothing
    was measured, for the reason in `rule`; freedom: its degrees of freedom; confirmed: whether there were
    two examinations.
    """

    asked: Accuracy
    component: str = ""
    value: float = math.nan
    error: float = math.inf
    freedom: float = math.inf
    confirmed: bool = False
    rule: str = ""

    @property
    def accuracy(self) -> float:
        """The relative standard error; inf where it is not known."""
        known = math.isfinite(self.value) and self.value != 0.0
        return self.error / abs(self.value) if known else math.inf

    @property
    def bound(self) -> float:
        """The upper bound of `accuracy`, which the true one exceeds with probability 10 % by itself."""
        return self.accuracy * _bound(self.freedom)

    @property
    def interval(self) -> tuple[float, float]:
        """The interval that covers the true value in 95 % of runs."""
        half = self.error * _student(self.freedom) if math.isfinite(self.error) else math.inf
        return self.value - half, self.value + half

    @property
    def excess(self) -> float:
        """The upper bound of the error over the required one; above 1 while it is not confirmed."""
        if not self.confirmed or not math.isfinite(self.accuracy):
            return math.inf
        few = math.sqrt(LEAST_FREEDOM / self.freedom)
        return max(self.bound / self.asked.accuracy, few if few > 1.0 else 0.0)

    @property
    def met(self) -> bool:
        """Whether the required accuracy was reached."""
        return self.excess <= 1.0


def _student(freedom: float) -> float:
    """Half the width of a 95 % interval, in standard errors."""
    from scipy.special import ndtri, stdtrit

    beyond = 0.5 * (1.0 + _CONFIDENCE)
    return float(ndtri(beyond) if math.isinf(freedom) else stdtrit(freedom, beyond))


def _bound(freedom: float) -> float:
    """The upper bound of an error over the error, from the quantile of chi-square."""
    from scipy.special import chdtri

    return 1.0 if math.isinf(freedom) else math.sqrt(freedom / float(chdtri(freedom, 1.0 - _DOUBT)))


def confirmed(now: Estimate, before: Estimate | None, ratio: float) -> Estimate:
    """An estimate with the larger one of its error and that of the examination before, for a run whose
    measured part was shorter by `ratio`."""
    from gaspart.analysis.estimate import Estimate

    if before is None:
        return now
    return Estimate(now.value, max(now.error, before.error * math.sqrt(ratio)), now.freedom)


def run(
    scene: Scene,
    engine: Engine,
    seed: int | tuple[int, ...],
    duration: float | None = None,
    sample_interval: float | None = None,
    path: str | Path | None = None,
    *,
    until: Accuracy | list[Accuracy] | tuple[Accuracy, ...] | None = None,
    at_most: float | None = None,
    displacements: bool = False,
    follow: int | None = None,
    correlations: Correlations | None = None,
    checkpoint_seconds: float = 30.0,
    progress: Progress | None = None,
    examined: Callable[[list[Reached]], None] | None = None,
    overwrite: bool = False,
) -> Path:
    """Run a scene and write its trajectory to `path`; returns `path`.

    A frame at time 0 and at every sample_interval to the duration, which is an integer multiple of it; with
    `displacements` also each particle's float64 way since time 0, unwrapped; with rough contacts also the
    spins; with `follow` only so many particles, from the first on (counters are still those of all). With
    `correlations` each frame has the sums so far of the velocities' correlations, and with `displacements`
    of the mean-squared displacement, over all pairs of samples, which may lie much closer than frames; with
    `Correlations(stress=True)` those of the stress tensor and the heat flux instead. A run of the same recipe
    and program that was cut short is continued, a complete one is not changed. Another trajectory at `path`,
    or unfinished next to it, is replaced only with `overwrite`; a file of another kind never.

    With `until` the run ends when standard error / |value| of all these observables is as small as required,
    which is examined at 64, 96, 128, 192 ... frames, or at_most after so long; see `gaspart.tradeoff.until`
    and `gaspart.reached_accuracy`. The sample_interval is then by default the mean time between collisions.

    `progress(time, duration, collisions)` is called about twice a second, `examined(reached)` after each
    examination. SIGINT and SIGTERM take effect after a checkpoint was written: the handlers of the program
    that calls this are then called, of which Python's own raises KeyboardInterrupt.

    Raises SceneError for invalid settings, a file that cannot be written, and what this run cannot measure;
    SimulationError if it breaks an invariant, with its state kept in `path.failed.npz`.
    """
    if path is None:
        raise SceneError("path", None, "must be given: the file of the trajectory")
    wanted = _request(duration, sample_interval, until, at_most)
    for asked in wanted.accuracies if wanted else ():
        _require_measurable(asked, scene, follow, correlations)
    if sample_interval is None:
        sample_interval = _sample_interval(scene, engine, correlations)
    recipe = Recipe(
        scene, engine, seed, duration, sample_interval, displacements, follow, correlations, wanted
    )
    return trajectory.record(recipe, path, checkpoint_seconds, progress, overwrite, _Examiner(examined))


def _request(
    duration: float | None,
    sample_interval: float | None,
    until: Accuracy | list[Accuracy] | tuple[Accuracy, ...] | None,
    at_most: float | None,
) -> Until | None:
    """What ends a run in place of a duration. Raises SceneError for what excludes or needs each other."""
    if until is not None:
        if duration is not None:
            rule = "excludes until, which ends the run; the longest duration is at_most"
            raise SceneError("duration", duration, rule)
        return Until(tuple(until) if isinstance(until, (list, tuple)) else (until,), at_most)
    if at_most is not None:
        raise SceneError("at_most", at_most, "needs until; without it give duration")
    if duration is None:
        raise SceneError("duration", None, "must be given, or until")
    if sample_interval is None:
        raise SceneError("sample_interval", None, "must be given with a duration")
    return None


def resume(
    path: str | Path,
    checkpoint_seconds: float = 30.0,
    progress: Progress | None = None,
    examined: Callable[[list[Reached]], None] | None = None,
) -> Path:
    """Finish the run that left `path.partial`, from its files only; returns `path`.

    `progress` and `examined` as of `run`. Raises SceneError if there is nothing to resume, if another version
    of the program began it, and for a file at `path` that is no complete trajectory of gaspart.
    """
    return trajectory.resume(path, checkpoint_seconds, progress, _Examiner(examined))


def reached_accuracy(path: str | Path) -> list[Reached]:
    """What a run `until` some accuracies has reached, in their order, by all of its frames, finished or not.

    An empty list for a run of a fixed duration. Raises SceneError as `open_trajectory` does.
    """
    until = read_recipe(path).until
    if until is None:
        return []
    with trajectory.open_trajectory(path) as data:
        return _Examiner().examine(data, until.accuracies, data.sizes["frame"])


class _Examiner:
    """Examines a run, and calls `report` with the result. Remembers the last examination, whose frames do not
    change any more."""

    def __init__(self, report: Callable[[list[Reached]], None] | None = None) -> None:
        self._report = report
        self._known: dict[tuple[Accuracy, int], dict[str, Estimate] | str] = {}

    def __call__(self, path: Path, accuracies: tuple[Accuracy, ...], frames: int) -> float:
        """The largest error over the required one, by the first frames of a file."""
        with trajectory.open_trajectory(path) as data:
            reached = self.examine(data, accuracies, frames)
        if self._report:
            self._report(reached)
        return max(one.excess for one in reached)

    def examine(self, data: xr.Dataset, accuracies: tuple[Accuracy, ...], frames: int) -> list[Reached]:
        """What the first frames of an open trajectory give."""
        from gaspart.analysis.run import EQUILIBRATION

        before, results = examined_before(frames), []
        times = data["time"].values
        for asked in accuracies:
            now = self._estimates(data, asked, frames)
            earlier = self._estimates(data, asked, before) if before is not None else {}
            if isinstance(now, str):
                results.append(Reached(asked, rule=now))
                continue
            ratio = 1.0
            if before is not None:
                first, last = (
                    time - (EQUILIBRATION * time if asked.start is None else asked.start)
                    for time in (times[before - 1], times[frames - 1])
                )
                ratio = max(first, 0.0) / last
            parts = []
            for name, estimate in now.items():
                other = None if isinstance(earlier, str) else earlier.get(name)
                made = confirmed(estimate, other, ratio)
                parts.append(Reached(asked, name, made.value, made.error, made.freedom, other is not None))
            results.append(max(parts, key=lambda one: (one.excess, one.accuracy)))
        return results

    def _estimates(self, data: xr.Dataset, asked: Accuracy, frames: int) -> dict[str, Estimate] | str:
        """The components of an observable, or the rule that the frames break."""
        key = asked, frames
        if key not in self._known:
            self._known = {known: it for known, it in self._known.items() if 2 * known[1] >= frames}
            try:
                self._known[key] = _measure(data.isel(frame=slice(frames)), asked)
            except SceneError as error:
                if error.key not in _TOO_SHORT:
                    raise SceneError("until", asked.name, f"{error.key}: {error.rule}") from None
                self._known[key] = f"{error.key}: {error.rule}"
        return self._known[key]


def _measure(data: xr.Dataset, asked: Accuracy) -> dict[str, Estimate]:
    """An observable by component, "" for a scalar."""
    from gaspart import analysis
    from gaspart.analysis.estimate import Estimate
    from gaspart.analysis.motion import GROUPS

    if asked.observable == "pressure":
        return _pressures(data, asked)
    function = getattr(analysis, _FUNCTIONS[asked.observable])
    result = function(data, start=asked.start)
    freedom = result.attrs.get("freedom", GROUPS - 1)
    if not result.estimate.ndim:
        return {"": Estimate(result.estimate, result.error, freedom)}
    names = [str(name) for name in result[result.estimate.dims[0]].values]
    pairs = zip(result.estimate.values, result.error.values, strict=True)
    return {name: Estimate(*pair, freedom) for name, pair in zip(names, pairs, strict=True)}


def _pressures(data: xr.Dataset, asked: Accuracy) -> dict[str, Estimate]:
    """The pressures on walls, or on the one that is asked for, each from a series over intervals of frames.
    (Those of `analysis.wall_pressure` have the errors of 16 blocks, which no blocks confirm.)"""
    import numpy as np

    from gaspart.analysis.pressure import pressures_on_walls
    from gaspart.analysis.run import measured
    from gaspart.analysis.statistics import correlated_mean

    with measured(data, asked.start) as part:
        faces, series = pressures_on_walls(part, np.arange(len(part.time)))
    if np.isnan(series).any():
        raise SceneError("particles at rest", "NaN", "their thrust on walls is not known")
    if len(series) < LEAST_FREEDOM + 1:
        raise SceneError("frames", len(series) + 1, f"an error needs {LEAST_FREEDOM + 2:g} or more")
    means = {str(face): correlated_mean(one).estimate for face, one in zip(faces, series.T, strict=True)}
    return means if asked.face is None else {asked.face: means[asked.face]}


def _require_measurable(
    asked: Accuracy, scene: Scene, follow: int | None, correlations: Correlations | None
) -> None:
    """Raise SceneError for an observable that a scene does not have, however long the run."""
    periodic, rule = scene.container.periodic, ""
    if asked.observable == "shear_viscosity":
        if correlations is None or not correlations.stress:
            rule = "needs correlations of the stress: --correlations T,L --stress"
    elif asked.observable == "pressure":
        axes = [axis for axis, open_ in zip("xyz", periodic, strict=False) if not open_]
        walls = [f"{axis} {end}" for axis in axes for end in ("low", "high")]
        if not walls or asked.face not in (None, *walls):
            rule = f"the walls are {', '.join(walls)}" if walls else "there are no walls: require Z"
    elif follow is not None and follow < scene.count:
        rule = "needs all particles in the file, without follow"
    elif asked.observable == "Z" and not all(periodic):
        rule = "needs a periodic container; between walls require pressure"
    elif asked.observable == "D" and not any(periodic):
        rule = "needs a periodic axis: displacements between walls are bounded"
    elif asked.observable == "D" and scene.dimension == 2 and any(scene.conserved_axes):
        rule = "discs have no diffusion coefficient: their squared displacement grows like t ln t"
    if rule:
        raise SceneError("until", asked.name, rule)


def _sample_interval(scene: Scene, engine: Engine, correlations: Correlations | None) -> float:
    """The mean time between two collisions of a particle, to two digits, as a multiple of the engine's steps
    and the samples of correlations. Raises SceneError where theory does not give it."""
    from gaspart import theory

    gas, rate = scene.gas, 0.0
    if gas is not None and gas.temperature > 0.0:
        try:
            rate = float(theory.collision_rate(**gas.parameters))
        except ValueError:  # denser than theory goes
            rate = 0.0
    if not rate > 0.0:
        rule = "must be given: the time between collisions is known only of plain gases"
        raise SceneError("sample_interval", None, rule)
    interval = float(f"{1.0 / rate:.2g}")
    unit = correlations.interval if correlations else engine.quantum
    if unit is None:
        return interval
    return max(1, round(interval / unit)) * unit
