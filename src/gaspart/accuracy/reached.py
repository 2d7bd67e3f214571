"""What a run that ends when it is accurate has reached, and the rule that ends it.

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

Both were measured with autoregressive series (`tests/accuracy/test_until.py`); for fixed widths and
independent samples the first is the problem of Chow and Robbins, Ann. Math. Stat. 36, 457 (1965).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from gaspart.accuracy.estimates import LEAST_FREEDOM, bound, components, of_face
from gaspart.analysis.observables import OBSERVABLES, TOO_SHORT
from gaspart.errors import SceneError
from gaspart.trajectory.opening import run_path
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import read_recipe
from gaspart.trajectory.until import Requirement, Until, examined_before

if TYPE_CHECKING:
    import xarray as xr

    from gaspart.analysis.estimate import Estimate

_CONFIDENCE = 0.95
IDLE = 16384
"""Frames without any contact after which a run ends that has no longest duration."""


@dataclass(frozen=True)
class AccuracyStatus:
    """What a run knows of an observable.

    asked: what is required; component: the face or axis that is known worst, "" for a scalar; value; error:
    its standard error, correlations included, the larger one of the last two examinations, inf where nothing
    was measured, for the reason in `rule`; freedom: its degrees of freedom; confirmed: whether there were
    two examinations.
    """

    asked: Requirement
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
        return self.accuracy * bound(self.freedom)

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


def confirmed(now: Estimate, before: Estimate | None, ratio: float) -> Estimate:
    """An estimate with the larger one of its error and that of the examination before, for a run whose
    measured part was shorter by `ratio`."""
    from gaspart.analysis.estimate import Estimate

    if before is None:
        return now
    return Estimate(now.value, max(now.error, before.error * math.sqrt(ratio)), now.freedom)


def reached_accuracy(path: str | Path) -> list[AccuracyStatus]:
    """What a run `until` some accuracies has reached, in their order, by all of its frames, finished or not.

    An empty list for a run of a fixed duration. Raises SceneError as `open_trajectory` does.
    """
    until = read_recipe(run_path(path)).until
    if until is None:
        return []
    with open_trajectory(path) as data:
        return Examiner().examine(data, until.accuracies, data.sizes["frame"])


class Examiner:
    """Examines a run, and calls `report` with the result. Remembers the last examination, whose frames do not
    change any more."""

    def __init__(self, report: Callable[[list[AccuracyStatus]], None] | None = None) -> None:
        self._report = report
        self._known: dict[tuple[Requirement, int], dict[str, Estimate] | str] = {}

    def __call__(self, path: Path, until: Until, frames: int) -> float:
        """The largest error over the required one, by the first frames of a file; 0 for a run without a
        longest duration that is given up, since nothing happens that could be measured."""
        with open_trajectory(path) as data:
            reached = self.examine(data, until.accuracies, frames)
            collisions = float(data["collisions"][frames - 1])
        if self._report:
            self._report(reached)
        if until.at_most is None and frames >= IDLE and _is_idle(reached, collisions):
            return 0.0
        return max(one.excess for one in reached)

    def examine(
        self, data: xr.Dataset, accuracies: tuple[Requirement, ...], frames: int
    ) -> list[AccuracyStatus]:
        """What the first frames of an open trajectory give."""
        from gaspart.analysis.run import EQUILIBRATION

        before, results = examined_before(frames), []
        times = data["time"].values
        for asked in accuracies:
            now = self._estimates(data, asked, frames)
            earlier = self._estimates(data, asked, before) if before is not None else {}
            if isinstance(now, str):
                results.append(AccuracyStatus(asked, rule=now))
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
                parts.append(
                    AccuracyStatus(asked, name, made.value, made.error, made.freedom, other is not None)
                )
            results.append(max(parts, key=lambda one: (one.excess, one.accuracy)))
        return results

    def _estimates(self, data: xr.Dataset, asked: Requirement, frames: int) -> dict[str, Estimate] | str:
        """The components of an observable, or the rule that the frames break."""
        key = asked, frames
        if key not in self._known:
            self._known = {known: it for known, it in self._known.items() if 2 * known[1] >= frames}
            try:
                self._known[key] = _measure(data.isel(frame=slice(frames)), asked)
            except SceneError as error:
                if error.key not in TOO_SHORT:
                    raise SceneError("until", asked.name, f"{error.key}: {error.rule}") from None
                self._known[key] = f"{error.key}: {error.rule}"
        return self._known[key]


def _is_idle(reached: list[AccuracyStatus], collisions: float) -> bool:
    """Whether an observable is made of contacts of which there was none."""
    return any(
        one.value == 0.0 if "face" in OBSERVABLES[one.asked.observable].along else collisions == 0.0
        for one in reached
    )


def _measure(data: xr.Dataset, asked: Requirement) -> dict[str, Estimate]:
    """An observable by component, "" for a scalar; of pressures those that are asked for."""
    found = components(data, asked.observable, asked.start)
    return {name: one.estimate for name, one in found.items() if of_face(name, asked.face)}
