"""Pressure and order of runs that start as crystal and as fluid, and their distance from equilibrium.

A run that is not in equilibrium is no evidence. Its drift is part of its uncertainty, so that its claims are
inconclusive, not confirmed. A run that is hardly longer than its memory does not know its uncertainty: the
uncertainty has few degrees of freedom, which are kept.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import average, correlated_mean
from gaspart.rendering import style
from gaspart.rendering.style import Axes
from gaspart.reproduction.figure import runs, series_of
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table

STARTS = {"lattice": "crystal", "compressed": "fluid"}
"""Start of a run by its arrangement: a perfect lattice is a crystal, a compressed gas is a fluid."""
LOOKS = {"crystal": 1, "fluid": 0}
"""Index of the colour and marker of each start."""
EQUILIBRIUM_LIMIT = 3.0
"""Largest deviation between starts or halves, in standard deviations, of a run in equilibrium."""
TOLERANCE = 0.02
"""Relative half-width of the interval around a coexistence pressure."""
Order = Callable[[np.ndarray, Sequence[float]], float]
"""Function that computes an order parameter of a frame, from positions and the container's lengths."""


def measure_state(point: Point, order: Order) -> dict[str, Any]:
    """Measure pressure and order of a point, and the difference between its halves."""
    scene = point.scene
    density = scene.number_density * (2.0 * scene.largest_radius) ** scene.dimension
    pressures, orders = [], []
    for run in runs(point):
        frames = run.data["coordinates"].values[1:]
        pressures.append(density * series_of(run).z)
        orders.append(np.array([order(frame, scene.container.lengths) for frame in frames]))
    row: dict[str, Any] = {
        "start": STARTS[point.settings["arrangement"]],
        "packing_fraction": round(scene.packing_fraction, 9),
        "count": scene.count,
        "density": density,
    }
    for name, replicas in (("pressure", pressures), ("order", orders)):
        row[name], row[f"{name}_drift"] = mean_and_drift(replicas)
    return row


def mean_and_drift(replicas: list[np.ndarray]) -> tuple[Estimate, Estimate]:
    """Return the mean of series, and second half minus first half: zero on average in equilibrium."""
    means = [correlated_mean(series).estimate for series in replicas]
    drifts = []
    for series, mean in zip(replicas, means, strict=True):
        first, second = series[: len(series) // 2], series[len(series) // 2 :]
        drifts.append(Estimate(second.mean() - first.mean(), 2.0 * mean.error, mean.freedom))
    return average(means), average(drifts)


def of_start(points: list[Point], start: str) -> dict[float, Point]:
    """Return the points of one start by packing fraction, ascending."""
    own = [point for point in points if STARTS[point.settings["arrangement"]] == start]
    return dict(sorted({round(point.scene.packing_fraction, 9): point for point in own}.items()))


def measure_states(points: list[Point], row: Callable[[Point], dict[str, Any]]) -> xr.Dataset:
    """Return the columns of each start and density, NaN without a run; `disagreement` between starts or
    halves.
    """
    chosen = [point for start in STARTS.values() for point in of_start(points, start).values()]
    dataset = table("point", chosen, row).set_index(point=["start", "packing_fraction"]).unstack("point")
    dataset["count"] = dataset["count"].max("start").astype(int)
    dataset["density"] = dataset["density"].max("start")
    dataset["pressure"].attrs["units"] = "k_B T / sigma^d"
    return dataset.assign(disagreement=("packing_fraction", disagreement(dataset)))


def disagreement(dataset: xr.Dataset) -> np.ndarray:
    """Return the largest deviation of each packing fraction, in standard deviations; NaN without a run."""
    deviations: list[np.ndarray] = []
    for quantity in ("pressure", "order"):
        value, drift = (Estimate.of(dataset, f"{quantity}{which}") for which in ("", "_drift"))
        deviations += [side.deviation for side in drift]
        if len(value) == 2:
            deviations.append((value[0] - value[1]).deviation)
    return np.asarray(np.fmax.reduce(np.abs(deviations)))


def starts(dataset: xr.Dataset, finite: str = "pressure") -> dict[str, Table]:
    """Return the packing fractions of the runs of each start."""
    found = {}
    for side in Table(dataset, "start"):
        own = Table(side.dataset, "packing_fraction")
        found[side.start] = own[np.isfinite(getattr(own, finite).value)]
    return found


def extreme(order: Estimate, melted: bool) -> Estimate:
    """Return the order that is furthest from equilibrium: the largest if all should be melted."""
    return order[int((np.argmax if melted else np.argmin)(order.value))]


def with_drift(measured: Estimate, drift: Estimate) -> Estimate:
    """Add half the drift between the halves of a run to its uncertainty, if significant."""
    added = 0.5 * drift.value if abs(drift.deviation) > EQUILIBRIUM_LIMIT else 0.0
    return Estimate(measured.value, math.hypot(measured.error, added), measured.freedom)


def draw_points(axis: Axes, states: Table, y: Estimate, kind: int, label: str | None = None) -> None:
    """Draw filled symbols in equilibrium, and hollow symbols out of equilibrium."""
    settled = states.disagreement <= EQUILIBRIUM_LIMIT
    for chosen, hollow in ((settled, False), (~settled, True)):
        if chosen.any():
            look: dict[str, Any] = {"kind": kind, "hollow": hollow}
            look["label"] = None if hollow and settled.any() else label
            style.points(axis, states.packing_fraction[chosen], y[chosen], **look)


def draw_order(axis: Axes, sides: dict[str, Table], dimension: int) -> None:
    """Draw the order of each start, and the ends of coexistence."""
    draw_ends(axis, dimension)
    for start, side in sides.items():
        draw_points(axis, side, side.order, LOOKS[start])
    axis.set_xlabel("packing fraction $\\eta$")


def draw_ends(axis: Axes, dimension: int) -> None:
    """Draw the packing fractions at the ends of coexistence."""
    for edge in theory.coexistence_packing_fractions(dimension):
        axis.axvline(edge, color=style.GREY, linewidth=0.6, linestyle=":")
