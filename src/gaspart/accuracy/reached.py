"""Accuracy reached by a run with `--until`, and the rule that ends the run.

A run is examined when it has 64, 96, 128, 192 ... frames. The first quarter of the frames is discarded. The
result does not depend on the speed of the machine or on interruptions. Each examination gives a value and its
standard error e with f degrees of freedom. Suppose that a run ended at the first examination whose e is small
enough. Then it would often end because e is too small by chance. The 95 % intervals would contain the true
value in only 88 to 94 % of such runs. Two rules prevent this:

- The error that counts is the larger error of two successive examinations. The earlier error is first
  multiplied by the square root of the ratio of the two lengths. So a single error that is small by chance
  does not end the run. Intervals from the larger error, with Student's t for f degrees of freedom, contain
  the true value in 95 % of runs.
- An upper bound of this error must be at most the required error. The bound is e sqrt(f / chi2), where chi2
  is the lower 10 % quantile of chi-square for f; it is 1.32 e for f = 15 and 1.10 e for 100. f must be at
  least 15, from 16 independent blocks. With this rule the true standard error is at most the required error
  in 98 % of runs.

If all samples are equal, the computed error is 0. This is not reliable, because the next sample may differ.
Such a run continues. Without a maximum duration it is stopped after 16384 frames. A series that changed k
times has at most k degrees of freedom, so a few jumps do not end a run either.

For independent replicas the value is the mean. The error is computed from the errors of the replicas, and
their degrees of freedom are added. Replicas are examined when all have the same number of frames.

Some runs conserve their initial energy, which depends on the seed. The error of a single run then refers to
this energy only. Runs with other seeds scatter more (`gaspart.accuracy.scatter`). The mean of replicas covers
several energies, so its error includes the scatter of the starts. Longer runs do not reduce this
contribution. The noise must then be at most the remainder of the required accuracy, or at most the accuracy
itself if no remainder is left.

Both rules were tested with autoregressive series (`tests/accuracy/test_until.py`). For intervals of fixed
width and independent samples the first rule is the problem of Chow and Robbins, Ann. Math. Stat. 36, 457
(1965).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from gaspart.accuracy.estimates import LEAST_FREEDOM, bound, components, of_face, scales_of
from gaspart.analysis.observables import OBSERVABLES, TOO_SHORT
from gaspart.errors import SceneError
from gaspart.trajectory.recipe import read_recipe
from gaspart.trajectory.replicas import files_of, opened_together
from gaspart.trajectory.run_options import Requirement, Until, examined_before

if TYPE_CHECKING:
    import xarray as xr

    from gaspart.analysis.estimate import Estimate

_CONFIDENCE = 0.95
IDLE = 16384
"""Number of frames without any contact or change after which a run without a maximum duration ends."""
_Estimates: TypeAlias = "dict[str, tuple[Estimate, float]]"
"""Components of an observable by name, with the values to which their relative errors refer."""
_UNCHANGED = "frames: all are the same so far, which tells no error"


@dataclass(frozen=True)
class AccuracyStatus:
    """Estimate of an observable by a run, compared with the required accuracy.

    request : required accuracy.
    component : name of the least accurate face or axis, "" for a scalar.
    value : value of this component.
    scale : value to which its relative error refers (`estimates.scales_of`).
    noise : standard error for the initial energies of the runs, with correlations. It is the larger error of
        the last two examinations, or inf if nothing was measured; the reason is in `rule`.
    freedom : degrees of freedom of the noise.
    confirmed : True after two examinations.
    scatter : relative standard deviation of the value between seeds due to the initial energy, in addition to
        the noise.
    replicas : number of runs.
    """

    request: Requirement
    component: str = ""
    value: float = math.nan
    scale: float = math.nan
    noise: float = math.inf
    freedom: float = math.inf
    confirmed: bool = False
    rule: str = ""
    scatter: float = 0.0
    replicas: int = 1

    @property
    def of_starts(self) -> float:
        """Relative standard error of replicas' mean by initial energies; 0 for a single run, at its own
        energy.
        """
        return self.scatter / math.sqrt(self.replicas) if self.replicas > 1 else 0.0

    @property
    def error(self) -> float:
        """Standard error of the value, at a single run's energy or with the scatter of replicas' starts."""
        return math.hypot(self.noise, self.of_starts * self.value) if self.of_starts else self.noise

    @property
    def accuracy(self) -> float:
        """Relative standard error, or inf if it is unknown."""
        return self._relative(self.error)

    @property
    def bound(self) -> float:
        """Upper bound of `accuracy`; the true relative error exceeds it with 10 % probability."""
        return math.hypot(self._relative(self.noise) * bound(self.freedom), self.of_starts)

    @property
    def interval(self) -> tuple[float, float]:
        """Interval that contains the true value in 95 % of runs."""
        if not math.isfinite(self.error):
            return -math.inf, math.inf
        half = math.hypot(
            self.noise * _student(self.freedom), self.of_starts * self.value * _student(math.inf)
        )
        return self.value - half, self.value + half

    @property
    def excess(self) -> float:
        """Upper bound of the noise divided by the allowed noise; above 1 until confirmed."""
        if not self.confirmed or not math.isfinite(self.accuracy):
            return math.inf
        few = math.sqrt(LEAST_FREEDOM / self.freedom)
        noise = self._relative(self.noise) * bound(self.freedom)
        return max(noise / noise_allowed(self.request.accuracy, self.of_starts), few if few > 1.0 else 0.0)

    @property
    def met(self) -> bool:
        """True if the required accuracy was reached."""
        return self.excess <= 1.0 and self.of_starts < self.request.accuracy

    def _relative(self, error: float) -> float:
        """Return an error divided by the scale; inf if the scale is unknown."""
        return error / self.scale if math.isfinite(self.scale) and self.scale > 0.0 else math.inf


def noise_allowed(accuracy: float, of_starts: float) -> float:
    """Return the relative noise at which a run ends, given the error due to its starts."""
    return math.sqrt(accuracy**2 - of_starts**2) if of_starts < accuracy else accuracy


def _student(freedom: float) -> float:
    """Return half the width of a 95 % confidence interval in standard errors."""
    from scipy.special import ndtri, stdtrit

    beyond = 0.5 * (1.0 + _CONFIDENCE)
    return float(ndtri(beyond) if math.isinf(freedom) else stdtrit(freedom, beyond))


def confirm_estimate(now: Estimate, before: Estimate | None, ratio: float) -> Estimate:
    """Return an estimate with the larger error of two examinations, the earlier shorter by `ratio`."""
    from gaspart.analysis.estimate import Estimate

    if before is None:
        return now
    return Estimate(now.value, max(now.error, before.error * math.sqrt(ratio)), now.freedom)


def combine_replicas(estimates: Sequence[Estimate]) -> Estimate:
    """Average independent estimates with the error of the mean from theirs, as `analysis.replicas`."""
    first, *others = estimates
    return sum(others, first) / len(estimates) if others else first


def reached_accuracy(path: str | Path) -> list[AccuracyStatus]:
    """Return the accuracies that a run with `--until` has reached.

    Parameters
    ----------
    path : str or Path
        Trajectory, complete or incomplete. One file of several replicas represents all of them.

    Returns
    -------
    list of AccuracyStatus
        Reached accuracies, in the order of the required accuracies, from all frames of the run. For replicas,
        only frames that exist in all replicas are used. The list is empty for a run of a fixed duration.

    Raises
    ------
    SceneError
        If `open_trajectory` rejects the file, or if replicas are missing.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> path = gp.run(scene, seed=1, duration=2.0, sample_interval=0.1, path="gas.nc")
    >>> gp.reached_accuracy(path)
    []
    """
    paths = files_of(path)
    until = read_recipe(paths[0]).until
    if until is None:
        return []
    with opened_together(paths) as runs:
        return Examiner().examine(runs, until.accuracies, min(data.sizes["frame"] for data in runs))


class Examiner:
    """Examination of a run, or of all replicas, that reports its stored last result to `report`."""

    def __init__(self, report: Callable[[list[AccuracyStatus]], None] | None = None) -> None:
        self._report = report
        self._known: dict[tuple[Requirement, int], _Estimates | str] = {}
        self._scatters: dict[Requirement, float] = {}

    def __call__(self, runs: Sequence[xr.Dataset], until: Until, frames: int) -> float:
        """Return the largest error divided by its required value, from the first frames of open trajectories.
        Return 0 to stop a run without a maximum duration in which nothing happens that could be measured.
        """
        reached = self.examine(runs, until.accuracies, frames)
        collisions = sum(_contacts(data.isel(frame=frames - 1)) for data in runs)
        if self._report:
            self._report(reached)
        if until.at_most is None and frames >= IDLE and _is_idle(reached, collisions):
            return 0.0
        return max(status.excess for status in reached)

    def examine(
        self, runs: Sequence[xr.Dataset], accuracies: tuple[Requirement, ...], frames: int
    ) -> list[AccuracyStatus]:
        """Compute the accuracies from the first frames of open trajectories."""
        from gaspart.analysis.run import EQUILIBRATION

        before, results = examined_before(frames), []
        times = runs[0]["time"].values
        for requirement in accuracies:
            now = self._estimates(runs, requirement, frames)
            earlier = self._estimates(runs, requirement, before) if before is not None else {}
            if isinstance(now, str):
                results.append(AccuracyStatus(requirement, rule=now))
                continue
            ratio = 1.0
            if before is not None:
                first, last = (
                    time - (EQUILIBRATION * time if requirement.start is None else requirement.start)
                    for time in (times[before - 1], times[frames - 1])
                )
                ratio = max(first, 0.0) / last
            parts, starts = [], (self._scatter(runs[0], requirement), len(runs))
            for name, (estimate, scale) in now.items():
                if estimate.error == 0.0:
                    parts.append(AccuracyStatus(requirement, name, estimate.value, scale, rule=_UNCHANGED))
                    continue
                other = None if isinstance(earlier, str) else earlier.get(name, (None, 0.0))[0]
                confirmed = confirm_estimate(estimate, other, ratio)
                values = confirmed.value, scale, confirmed.error, confirmed.freedom, other is not None
                parts.append(AccuracyStatus(requirement, name, *values, "", *starts))
            results.append(max(parts, key=lambda status: (status.excess, status.accuracy)))
        return results

    def _scatter(self, run: xr.Dataset, requirement: Requirement) -> float:
        """Return the relative standard deviation of an observable between seeds due to the initial energy."""
        from gaspart.accuracy.scatter import scatter_of_run  # imports gaspart.analysis

        if requirement not in self._scatters:
            self._scatters[requirement] = scatter_of_run(run, requirement.observable, requirement.face).value
        return self._scatters[requirement]

    def _estimates(
        self, runs: Sequence[xr.Dataset], requirement: Requirement, frames: int
    ) -> _Estimates | str:
        """Return the components of an observable, or the reason why the frames are insufficient."""
        key = requirement, frames
        if key not in self._known:
            self._known = {
                cached_key: entry for cached_key, entry in self._known.items() if 2 * cached_key[1] >= frames
            }
            try:
                self._known[key] = _measure([data.isel(frame=slice(frames)) for data in runs], requirement)
            except SceneError as error:
                if error.key not in TOO_SHORT:
                    raise SceneError("until", requirement.name, f"{error.key}: {error.rule}") from None
                self._known[key] = f"{error.key}: {error.rule}"
        return self._known[key]


def _contacts(frame: xr.Dataset) -> float:
    """Count collisions until a frame; with open faces also count entries and wall hits."""
    entered = "entries" in frame and bool(frame["entries"].any())  # some engines do not count these
    names = ("collisions", "entries", "wall_hits") if entered else ("collisions",)
    return float(sum(frame[name].sum() for name in names))


def _is_idle(reached: list[AccuracyStatus], collisions: float) -> bool:
    """Return True if an observable never changed, or if it counts contacts and none occurred."""
    return any(
        status.rule == _UNCHANGED
        or (
            status.value == 0.0
            if "face" in OBSERVABLES[status.request.observable].along
            else collisions == 0.0
        )
        for status in reached
    )


def _measure(runs: Sequence[xr.Dataset], requirement: Requirement) -> _Estimates:
    """Measure each component ("" for a scalar) as the mean over runs, on the requested face, with
    its scale.
    """
    observable = requirement.observable
    results = [components(data, observable, requirement.start) for data in runs]
    names = [name for name in results[0] if all(name in result for result in results)]
    means = [combine_replicas([result[name].estimate for result in results]) for name in names]
    scales = scales_of(observable, np.array([mean.value for mean in means])).tolist()
    rows = zip(names, means, scales, strict=True)
    return {name: (mean, scale) for name, mean, scale in rows if of_face(name, requirement.face)}
