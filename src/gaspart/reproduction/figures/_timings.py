"""Costs per particle and per event, and their minimum, from repeated timings of `measure_cost`.

*Work* is counted, and is equal on every machine: tested pairs, visited boxes, and emptied boxes. The
time-stepped engine sorts all particles in every step, so all its boxes are emptied once per step. *Time* is
CPU time: the median of the repeats, with the standard error of the median.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis import statistics
from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.table import Table, entries

SOURCE_A, SOURCE_C = "[source A]", "[source C]"
OTHER_MACHINE = "on this machine, and by this program, tests and boxes have other relative costs"
NEAR = 3.0  # a minimum is fitted to partitions whose cost is at most this multiple of the smallest cost
# Relative error of a time in a fit, beside its own, because caches and clock rates affect entire runs.
SYSTEMATIC = 0.02


def median(seconds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute the median over the last axis, and its standard error. The standard error is sqrt(pi/2) times
    the standard error of a mean. The standard deviation is estimated as 1.4826 times the median deviation.
    Therefore a disturbance in one of five repeats changes neither result.
    """
    middle = np.median(seconds, axis=-1)
    spread = 1.4826 * np.median(np.abs(seconds - middle[..., None]), axis=-1)
    return middle, math.sqrt(0.5 * math.pi / seconds.shape[-1]) * spread


def per_particle(run: xr.Dataset) -> xr.Dataset:
    """Return the costs per particle and step, for each partition of a time-stepped gas."""
    costs = _costs(run, run.attrs["count"] * run.steps.values, "pair_tests", "box_visits")
    return costs.assign(boxes_emptied=costs.boxes_per_particle)


def per_event(run: xr.Dataset) -> xr.Dataset:
    """Return the costs per event (collision or wall hit), for each partition of an event-driven gas."""
    events = (run.collisions + run.wall_hits).values
    costs = _costs(run, events, "pair_tests", "box_visits", "crossings")
    return costs.assign(events=("partition", events, {"units": "1"}))


def _costs(run: xr.Dataset, number: np.ndarray, *counted: str) -> xr.Dataset:
    seconds, error = median(run.seconds.values)
    columns = {
        "boxes_per_side": run.boxes_per_side.values,
        "boxes_per_particle": run.boxes.values / run.attrs["count"],
        **{name: run[name].values / number for name in counted},
    }
    times = {"seconds": seconds / number, "seconds_error": error / number}
    return xr.Dataset(
        {name: ("partition", values, {"units": "1"}) for name, values in columns.items()}
        | {name: ("partition", values, {"units": "s"}) for name, values in times.items()}
    )


def weights(seconds: Estimate, *work: float | np.ndarray) -> statistics.Fit:
    """Fit the cost of each kind of work (points,): seconds = sum of weight x work, with scatter in the
    errors.
    """
    design = np.stack(np.broadcast_arrays(*work), axis=1)
    fit = statistics.fit_linear(design, seconds.value, _spread(seconds))
    if fit.degrees_of_freedom:
        fit.covariance[...] *= max(1.0, fit.chi_square / fit.degrees_of_freedom)
    return fit


def _spread(seconds: Estimate) -> np.ndarray:
    """Compute the errors of times in a fit."""
    return np.asarray(np.hypot(seconds.error, SYSTEMATIC * seconds.value))


def ideal(costs: xr.Dataset, dimension: int) -> dict[str, Any]:
    """Compute the ideal number of boxes per particle from `per_particle` costs, with 95 % intervals. `ideal`
    is the minimum of a + b / boxes + c boxes, fitted to times; between `flat_low` and `flat_high` the cost is
    at most 5 % higher. `model` is the minimum of seconds = a + b tests + c boxes, all per particle, fitted
    for the same partitions: sqrt(3^d b / 2 c), NaN if a weight is not positive. The weight a is for moving,
    sorting, and box visits, whose number hardly changes.
    """
    scan = Table(costs, "partition")
    best = statistics.optimum(scan.boxes_per_particle, scan.seconds.value, within=NEAR)
    near = scan[_near(scan.seconds.value)]
    fit = weights(near.seconds, 1.0, near.pair_tests, near.boxes_per_particle)
    _, test, box = fit.values
    model = spread = math.nan
    if test > 0.0 and box > 0.0:
        model = float(np.sqrt(0.5 * 3.0**dimension * test / box))
        gradient = np.array([0.0, 0.5 / test, -0.5 / box])  # 95 % interval of ln model
        spread = 1.96 * math.sqrt(gradient @ fit.covariance @ gradient)
    names = "particle_seconds", "test_seconds", "box_seconds"
    fitted = zip(names, zip(fit.values, fit.errors, strict=True), strict=True)
    return {
        "ideal": best.location,
        "ideal_low": best.low,
        "ideal_high": best.high,
        "ideal_interior": int(best.interior),
        "flat_low": best.flat_low,
        "flat_high": best.flat_high,
        "model": model,
        "model_low": model * math.exp(-spread),
        "model_high": model * math.exp(spread),
        **entries(dict(fitted)),
    }


def penalty(costs: xr.Dataset, boxes_per_particle: float) -> tuple[float, float]:
    """Compute the time at a number of boxes per particle divided by the least time, and its error. Both times
    are computed from a + b / boxes + c boxes, fitted to the times near the minimum. A single disturbed timing
    then has little effect. The coefficients are not negative, because no work has a negative cost. Results
    are NaN beyond the timed partitions.
    """
    from scipy.optimize import nnls

    scan = Table(costs, "partition")
    boxes = scan.boxes_per_particle
    if not boxes.min() <= boxes_per_particle <= boxes.max():
        return math.nan, math.nan
    near = scan[_near(scan.seconds.value)]
    fine = np.append(boxes_per_particle, np.geomspace(boxes.min(), boxes.max(), 1001))
    at, curve = (np.stack([np.ones(x.size), 1.0 / x, x], axis=1) for x in (near.boxes_per_particle, fine))
    spread = _spread(near.seconds)
    costly = nnls(at / spread[:, None], near.seconds.value / spread)[0] > 0.0
    fit, curve = weights(near.seconds, *at[:, costly].T), curve[:, costly]
    requested, least = curve[0], curve[np.argmin(curve @ fit.values)]
    ratio = requested @ fit.values / (least @ fit.values)
    gradient = requested / (requested @ fit.values) - least / (least @ fit.values)  # of ln ratio
    return ratio, ratio * math.sqrt(gradient @ fit.covariance @ gradient)


def _near(seconds: np.ndarray) -> np.ndarray:
    """Select partitions for the fit: up to `NEAR` times the least time, or the four cheapest."""
    return seconds <= max(NEAR * seconds.min(), np.sort(seconds)[min(3, len(seconds) - 1)])


def log_ratios(run: xr.Dataset, work: np.ndarray) -> np.ndarray:
    """Compute ln of the time per unit of work (partitions,) relative to a rival, as medians over repeats. The
    first half of the runs has the settings `without`. The second half, the rivals, does not have them. Both
    are timed alternately.
    """
    own, beside = np.split(np.log(run.seconds.values / work[:, None]), 2)
    return np.median(own - beside, axis=1)


def ratio_of_jobs(logs: Sequence[float] | np.ndarray) -> Estimate:
    """Return a ratio from its logarithms in several jobs; its error, their scatter, is NaN for one job."""
    mean = statistics.mean_of(logs) if len(logs) > 1 else Estimate(float(logs[0]), math.nan, math.nan)
    ratio = math.exp(mean.value)
    return Estimate(ratio, ratio * mean.error, mean.freedom)


def trend(count: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Fit the exponent of a power law, and its error from the scatter; NaN for fewer than three points."""
    usable = np.isfinite(values)
    if usable.sum() < 3:
        return math.nan, math.nan
    fit = statistics.fit_power_law(count[usable], values[usable])
    return fit.exponent, fit.exponent_error
