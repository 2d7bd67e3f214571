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
from gaspart.reproduction.table import Table
from gaspart.theory.partition import ideal_boxes_per_particle

NEAR = 3.0
"""A minimum is fitted to partitions whose cost is at most this multiple of the smallest cost."""
SYSTEMATIC = 0.02
"""Relative error that is added to the error of a time in a fit, because caches and clock rates affect entire
runs."""


def median(seconds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute the median over the last axis, and its standard error.

    The standard error is sqrt(pi/2) times the standard error of a mean. The standard deviation is estimated
    as 1.4826 times the median deviation. Therefore a disturbance in one of five repeats changes neither
    result.
    """
    middle = np.median(seconds, axis=-1)
    spread = 1.4826 * np.median(np.abs(seconds - middle[..., None]), axis=-1)
    return middle, math.sqrt(0.5 * math.pi / seconds.shape[-1]) * spread


def per_particle(run: xr.Dataset) -> xr.Dataset:
    """Return the costs per particle and step, for each partition of a time-stepped gas.

    The variables are ``boxes_per_side``, ``boxes_per_particle``, ``seconds`` with ``seconds_error``,
    ``pair_tests``, ``box_visits`` and ``boxes_emptied``.
    """
    particle_steps = run.attrs["count"] * run.steps.values
    seconds, error = median(run.seconds.values)
    boxes = run.boxes.values / run.attrs["count"]
    columns = {
        "boxes_per_side": run.boxes_per_side.values,
        "boxes_per_particle": boxes,
        "seconds": seconds / particle_steps,
        "seconds_error": error / particle_steps,
        "pair_tests": run.pair_tests.values / particle_steps,
        "box_visits": run.box_visits.values / particle_steps,
        "boxes_emptied": boxes,
    }
    return _dataset(columns, seconds="s", seconds_error="s")


def per_event(run: xr.Dataset) -> xr.Dataset:
    """Compute the costs per event (collision or wall hit) for each partition.

    The gas is event-driven. The variables are ``boxes_per_side``, ``boxes_per_particle``, ``events``,
    ``seconds`` with ``seconds_error``, ``pair_tests``, ``box_visits``, and ``crossings`` of box boundaries.
    """
    events = (run.collisions + run.wall_hits).values
    seconds, error = median(run.seconds.values)
    columns = {
        "boxes_per_side": run.boxes_per_side.values,
        "boxes_per_particle": run.boxes.values / run.attrs["count"],
        "events": events,
        "seconds": seconds / events,
        "seconds_error": error / events,
        "pair_tests": run.pair_tests.values / events,
        "box_visits": run.box_visits.values / events,
        "crossings": run.crossings.values / events,
    }
    return _dataset(columns, seconds="s", seconds_error="s")


def _dataset(columns: dict, **units: str) -> xr.Dataset:
    return xr.Dataset(
        {name: ("partition", values, {"units": units.get(name, "1")}) for name, values in columns.items()}
    )


def weights(seconds: Estimate, *work: float | np.ndarray) -> statistics.Fit:
    """Fit the cost of each kind of work: seconds = sum of weight x work.

    The fit is a least-squares fit of relative deviations. The arrays of seconds and of each kind of work have
    the shape (points,). If the scatter is larger than the errors (and `SYSTEMATIC`) explain, the covariance
    is scaled up.
    """
    times, errors = seconds.value, _spread(seconds)
    fit = statistics.fit_linear(np.stack(np.broadcast_arrays(*work), axis=1), times, errors)
    if fit.degrees_of_freedom:
        fit.covariance[...] *= max(1.0, fit.chi_square / fit.degrees_of_freedom)
    return fit


def _spread(seconds: Estimate) -> np.ndarray:
    """Compute the errors of times in a fit."""
    return np.asarray(np.hypot(seconds.error, SYSTEMATIC * seconds.value))


def ideal(costs: xr.Dataset, dimension: int) -> dict[str, Any]:
    """Compute the ideal number of boxes per particle of a gas, from `per_particle` costs.

    Each number has its 95 % interval.

    The first method uses times. ``ideal`` is the minimum of a + b / boxes + c boxes, with ``ideal_low``,
    ``ideal_high`` and ``ideal_interior``. Between ``flat_low`` and ``flat_high`` the cost is at most 5 %
    higher. The second method uses work. For the same partitions, seconds = a + b tests + c boxes is fitted,
    all per particle. The minimum ``model`` is at sqrt(3^d b / 2 c), with ``model_low`` and ``model_high``;
    NaN if a weight is not positive. The weights with their ``_error`` are ``particle_seconds`` a (moving,
    sorting, and box visits, whose number hardly changes), ``test_seconds`` b, and ``box_seconds`` c.
    """
    scan = Table(costs, "partition")
    best = statistics.optimum(scan.boxes_per_particle, scan.seconds.value, within=NEAR)
    near = scan[_near(scan.seconds.value)]
    fit = weights(near.seconds, 1.0, near.pair_tests, near.boxes_per_particle)
    (particle, test, box), errors = fit.values, fit.errors
    model = spread = math.nan
    if test > 0.0 and box > 0.0:
        model = float(ideal_boxes_per_particle(test, box, dimension))
        gradient = np.array([0.0, 0.5 / test, -0.5 / box])  # 95 % interval of ln model
        spread = 1.96 * math.sqrt(gradient @ fit.covariance @ gradient)
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
        "particle_seconds": particle,
        "particle_seconds_error": errors[0],
        "test_seconds": test,
        "test_seconds_error": errors[1],
        "box_seconds": box,
        "box_seconds_error": errors[2],
    }


def penalty(costs: xr.Dataset, boxes_per_particle: float) -> tuple[float, float]:
    """Compute the time at a number of boxes per particle divided by the least time.

    The standard error is also returned. Results are NaN beyond the timed partitions.

    Both times are computed from a + b / boxes + c boxes, fitted to the times near the minimum. A single
    disturbed timing then has little effect. The coefficients are not negative, because no work has a negative
    cost.
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
    # 95 % interval of ln ratio
    gradient = requested / (requested @ fit.values) - least / (least @ fit.values)
    return ratio, ratio * math.sqrt(gradient @ fit.covariance @ gradient)


def _near(seconds: np.ndarray) -> np.ndarray:
    """Select partitions for the fit: up to `NEAR` times the least time, or the four cheapest."""
    return seconds <= max(NEAR * seconds.min(), np.sort(seconds)[min(3, len(seconds) - 1)])


def log_ratios(run: xr.Dataset, work: np.ndarray) -> np.ndarray:
    """Compute ln of the time per unit of work (partitions,) relative to a rival.

    The first half of the runs has the settings `without`. The second half, the rivals, does not have them.
    Both are timed alternately. The result is the median over repeats.
    """
    own, beside = np.split(np.log(run.seconds.values / work[:, None]), 2)
    return np.median(own - beside, axis=1)


def ratio_of_jobs(logs: Sequence[float] | np.ndarray) -> Estimate:
    """Average the logarithms of a ratio over several jobs; return the ratio with its error.

    The uncertainty is the scatter of the jobs. It is NaN for a single job.
    """
    mean = statistics.mean_of(logs) if len(logs) > 1 else Estimate(float(logs[0]), math.nan, math.nan)
    ratio = math.exp(mean.value)
    return Estimate(ratio, ratio * mean.error, mean.freedom)


def trend(count: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Fit the exponent of a power law, and its error from the scatter.

    The result is NaN if fewer than three points can be used.
    """
    usable = np.isfinite(values)
    if usable.sum() < 3:
        return math.nan, math.nan
    fit = statistics.fit_power_law(count[usable], values[usable])
    return fit.exponent, fit.exponent_error


def one_box(runs: list[xr.Dataset]) -> xr.Dataset:
    """Return pair tests and time of one step with one box, over ``count``."""
    runs = sorted(runs, key=lambda run: run.attrs["count"])
    steps = np.array([int(run.steps[0]) for run in runs])
    times = np.array([median(run.seconds.values[0]) for run in runs]).reshape(-1, 2) / steps[:, None]
    tests = np.array([int(run.pair_tests[0]) for run in runs]) / steps
    return xr.Dataset(
        {
            "pair_tests": ("count", tests, {"units": "1"}),
            "seconds": ("count", times[:, 0], {"units": "s"}),
            "seconds_error": ("count", times[:, 1], {"units": "s"}),
        },
        coords={"count": [run.attrs["count"] for run in runs]},
    )


def list_costs(runs: list[xr.Dataset], gases: xr.Dataset) -> xr.Dataset:
    """Return the costs per particle of neighbour lists, over ``listed``.

    The variables are ``list_seconds`` and so on, as in `per_particle`; ``list_count``, ``list_radius``; and
    ``list_share``. ``list_share`` is the time divided by the time of the gas in `gases` with equal count and
    radius, with error. It is NaN without such a gas.
    """
    costs = xr.concat(
        [per_particle(run).isel(partition=0) for run in runs], "listed", join="outer", compat="equals"
    )
    shares, partitioned = [], Table(gases, "gas")
    for run, own in zip(runs, Table(costs, "listed"), strict=True):
        same = partitioned[(partitioned.count == run.attrs["count"]) & (partitioned.radius == run.radius)]
        shares.append(own.seconds / same[-1].seconds if same else Estimate(math.nan, math.nan))
    share = Estimate.stack(shares)
    return (
        costs[["seconds", "seconds_error", "pair_tests"]]
        .rename(seconds="list_seconds", seconds_error="list_seconds_error", pair_tests="list_pair_tests")
        .assign(
            list_count=("listed", [run.attrs["count"] for run in runs]),
            list_radius=("listed", [run.radius for run in runs]),
            list_share=("listed", share.value),
            list_share_error=("listed", share.error),
        )
    )


def extrapolate(naive: xr.Dataset, count: float) -> Estimate:
    """Compute the time of a naive step with `count` particles.

    The time is fitted by a N + b tests.
    """
    gases = Table(naive, "count")
    fit = weights(gases.seconds, gases.count.astype(float), gases.pair_tests)
    work = np.array([count, 0.5 * count * (count - 1.0)])
    return Estimate(work @ fit.values, math.sqrt(work @ fit.covariance @ work))
