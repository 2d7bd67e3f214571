"""Components of observables and their errors, for pilot runs and for runs until an accuracy.

The squared error of a mean over a time t is S / t + C / t^2. S is the spectrum of the series at frequency 0,
computed by `correlated_mean`. The term C is due to stored quantities. During a run a wall takes up momentum
and the sum m x v that the gas stores, and returns them later. So impulses in consecutive intervals are
anticorrelated. In a short run the term C dominates, and an error that is extrapolated as t^(-1/2) is too
large. In a series of short intervals, the term C hides S. Both stored quantities are known at each frame.
Therefore the series is regressed on the changes of the stored quantities, and S is the spectrum of the
residual.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.observables import OBSERVABLES
from gaspart.errors import SceneError

if TYPE_CHECKING:
    import xarray as xr

    from gaspart.analysis.observable import Observable
    from gaspart.analysis.run import Run

LEAST_FREEDOM = 15.0
"""Minimum number of degrees of freedom of an error that may end a run; 16 groups or blocks give this number.

An observable without stated degrees of freedom is assumed to have this number.
"""
_SAME = 1e-12
"""Relative scatter below which a series counts as constant."""
_DOUBT = 0.1
"""Probability that the true error exceeds its bound."""


def bound(freedom: float) -> float:
    """Compute the upper bound of an error over the error, by a quantile of chi-square."""
    from scipy.special import chdtri

    return 1.0 if math.isinf(freedom) else math.sqrt(freedom / float(chdtri(freedom, 1.0 - _DOUBT)))


@dataclass(frozen=True)
class Component:
    """Value of one component of an observable, measured during `time`. The component is a face, an axis, a
    pair of species, or the whole observable.

    spectrum, stored : coefficients S and C of the squared error.
    freedom : degrees of freedom of the error.
    scale : value to which the relative error refers: the measured value unless it vanishes on average.
    points : for a curve, the number of measured points and the number of all points.
    """

    value: float
    scale: float
    time: float
    spectrum: float
    stored: float = 0.0
    freedom: float = LEAST_FREEDOM
    points: tuple[int, int] = (1, 1)

    @property
    def estimate(self) -> Estimate:
        """Value with its error in this run."""
        return Estimate(self.value, self.error(self.time), self.freedom)

    @property
    def accuracy(self) -> float:
        """Relative error, or inf if it is unknown."""
        return self.error(self.time) / self.scale if self.scale > 0.0 else math.inf

    def error(self, time: float) -> float:
        """Compute the standard error of a run from the duration of its measured part."""
        return math.sqrt(self.spectrum / time + self.stored / time**2)

    def length(self, accuracy: float) -> float:
        """Compute the measured time for an upper bound `accuracy` of the relative error, as `--until`; else
        inf.
        """
        if not self.accuracy < math.inf or not accuracy > 0.0:
            return math.inf
        remaining = accuracy * self.scale / bound(self.freedom)
        part = 0.5 * self.spectrum / remaining**2
        return part + math.sqrt(part**2 + self.stored / remaining**2)

    def reaches(self, time: float) -> float:
        """Compute the bound of the relative error after a measured time; inverse of `length`."""
        if not self.accuracy < math.inf or not time > 0.0:
            return math.inf
        return self.error(time) / self.scale * bound(self.freedom)


def components(data: xr.Dataset, observable: str, start: float | None = None) -> dict[str, Component]:
    """Estimate each component of an observable of `gaspart measure` from a trajectory. A scalar or a curve
    has one component, "".
    """
    from gaspart.analysis.run import measure_single, open_run

    with open_run(data, start, sheared=True, varying=True) as run:
        if OBSERVABLES[observable].of_impulses:
            return _on_walls(run, observable)
        time = float(run.time[-1] - run.time[0])
    declared, result = OBSERVABLES[observable], measure_single(data, observable, start)
    parts = [np.asarray(of, dtype=float) for of in (result.estimate, result.error, _freedom(result))]
    value, error, freedom = np.broadcast_arrays(*parts)
    is_known, names, points = np.isfinite(value) & np.isfinite(error), [""], (1, 1)
    if declared.form == "names":
        names = [
            name for name, is_finite in zip(_names(result), np.isfinite(value).flat, strict=True) if is_finite
        ]
        value, error, freedom = (of[np.isfinite(value)] for of in (value, error, freedom))
    elif value.ndim:
        points = int(is_known.sum()), is_known.size
        value, error = np.array(_norm(value[is_known])), np.array(_norm(error[is_known]))
        freedom = np.array(LEAST_FREEDOM)
    scales = scales_of(observable, np.ravel(value))
    columns = zip(names, np.ravel(value), scales, np.ravel(error) ** 2 * time, np.ravel(freedom), strict=True)
    return {
        name: Component(float(mean), float(scale), time, float(spectrum), freedom=float(free), points=points)
        for name, mean, scale, spectrum, free in columns
    }


def scales_of(observable: str, values: np.ndarray) -> np.ndarray:
    """Return the values (n,) for relative errors: its own, or the root mean square if some vanish on
    average.
    """
    if OBSERVABLES[observable].relative_to == "norm":
        return np.full(len(values), _norm(values))
    return np.abs(values)


def of_face(name: str, face: str | None) -> bool:
    """Return True if a component belongs to a face of the container; None means any face."""
    return face is None or name == face or name.startswith(f"{face} ")


def _freedom(observable: Observable) -> np.ndarray | float:
    """Return the degrees of freedom of the error, an array if they differ between values."""
    each = observable.get(f"{observable.attrs['quantity']}_freedom")
    return float(observable.attrs.get("freedom", LEAST_FREEDOM)) if each is None else np.asarray(each)


def _names(observable: Observable) -> list[str]:
    """Return the names of the components of an observable, from the names along each dimension."""
    return [
        " ".join(words)
        for words in product(*(observable[dim].values.astype(str) for dim in observable.estimate.dims))
    ]


def _norm(values: np.ndarray) -> float:
    """Compute the root mean square, or 0 for an empty array."""
    return float(np.sqrt(np.mean(values**2))) if values.size else 0.0


def _on_walls(run: Run, observable: str) -> dict[str, Component]:
    """Estimate the pressures or forces on walls; each series consists of intervals between frames."""
    from gaspart.analysis.counters import controlled_on_walls, on_walls
    from gaspart.analysis.impulses import stores

    faces, series = on_walls(run, np.arange(len(run.time)), observable)
    if np.isnan(series).any():
        rule = "is not known of every wall: particles rest, or have several sizes between walls that move"
        raise SceneError(observable, "NaN", rule)
    if len(series) < LEAST_FREEDOM + 1:
        raise SceneError("frames", len(series) + 1, f"an error needs {LEAST_FREEDOM + 2:g} or more")
    improved, stored = controlled_on_walls(run, observable), stores(run)
    interval = float(np.diff(run.time).mean())
    by_face = {}
    for index, (face, values) in enumerate(zip(map(str, faces), series.T, strict=True)):
        if index in improved:
            _, controls, rest = improved[index]
            by_face[face] = without_stores(values, rest, interval, controls)
        else:
            by_face[face] = with_stores(values, stored["xyz".index(face[0])], interval)
    return by_face


def without_stores(series: np.ndarray, rest: np.ndarray, interval: float, controls: int) -> Component:
    """Estimate the mean of equal intervals (K,) from the residual after regression on `controls`
    variables.
    """
    from gaspart.analysis.statistics import correlated_mean

    mean, time = correlated_mean(rest).estimate, len(rest) * interval
    freedom = _remaining_freedom(series, mean, controls)
    return Component(mean.value, abs(mean.value), time, mean.error**2 * time, freedom=freedom)


def _remaining_freedom(series: np.ndarray, rest: Estimate, controls: int) -> float:
    """Return the degrees of freedom of the error of a series (K,) after the regression. The regressors may
    explain a series up to rounding. The error is known to be 0, and its degrees of freedom are computed from
    the changes of the series.
    """
    from gaspart.analysis.statistics import count_changes

    freedom = rest.freedom if rest.error > 0.0 else float(count_changes(series))
    return max(1.0, freedom - controls)


def with_stores(series: np.ndarray, stores: np.ndarray, interval: float) -> Component:
    """Estimate the mean of a series (K,) that includes changes of stored quantities. `stores` (K + 1, n) are
    the n stored quantities at the ends of the intervals of equal length. The coefficients of the changes come
    from a regression of the series. The sum of all changes remains in the mean. The variance of this sum is
    twice the variance of the stored quantities.
    """
    from gaspart.analysis.statistics import correlated_mean

    mean, time = float(series.mean()), len(series) * interval
    kept = stores[:, np.ptp(stores, axis=0) > _SAME * np.abs(stores).max(axis=0, initial=0.0)]
    changes = np.diff(kept, axis=0) / interval
    centred = changes - changes.mean(axis=0)
    slopes = np.linalg.lstsq(centred, series - mean, rcond=None)[0]
    rest = correlated_mean(series - centred @ slopes).estimate
    stored = 2.0 * float(np.var(kept @ slopes)) if slopes.size else 0.0
    freedom = _remaining_freedom(series, rest, controls=0)
    return Component(mean, abs(mean), time, rest.error**2 * time, stored, freedom)
