"""Density between two walls by counts, by impulses and by their mixture, and the pressure on the walls.

All estimates are from the same runs, which have walls across the last axis.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart.accuracy.estimates import components
from gaspart.analysis.flow import Grid
from gaspart.analysis.impulses import mixture, numbers_by_impulses, read_impulses
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import mean_of
from gaspart.errors import SceneError
from gaspart.keys import list_of, positive
from gaspart.rendering import style
from gaspart.rendering.style import Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table

TITLE, CHAPTER = "Pressure on walls and pistons", "Equation of state and structure"
WIDTHS = "widths of bins, in diameters: whole multiples of those that runs keep"
SETTINGS = {"widths": list_of(positive(""), WIDTHS)}
BLOCKS = 32  # of time
FILLED = 0.2  # least density of a bin over the mean density; other bins are partly inaccessible


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure ratios of the variance of counts to that of other estimators, for each point and width of bins.
    The ratios are those of each replica, from blocks of time; the result is their mean.
    """
    cases = [(point, width) for point in points for width in settings["widths"]]
    return table("case", cases, _row)


def _row(case: tuple[Point, float]) -> dict[str, Any]:
    point, width = case
    diameter = 2.0 * point.scene.largest_radius
    replicas = [_compare(run, width * diameter) | pressures_of(run) for run in runs(point)]
    rows = {name: mean_of([replica[name] for replica in replicas]) for name in replicas[0]}
    return {"packing_fraction": point.scene.packing_fraction, "width": width, **rows}


def _compare(run: Run, width: float) -> dict[str, float]:
    """Compare the estimators of the density: medians of all bins, and the mean of the bins at the walls.
    `mean_square` is that of (counts - impulses) / error over its value for Student's distribution;
    `additions` are those to the tally per tested pair of particles.
    """
    counted, impulses = blocks_of(run, width)
    filled = np.flatnonzero(counted.mean(axis=0) > FILLED * counted.mean())
    counted, impulses = counted[:, filled], impulses[:, filled]
    apart = counted - impulses
    mixed = counted - mixture(counted, impulses, periodic=False) * apart
    own, other, both = (estimator.var(axis=0, ddof=1) for estimator in (counted, impulses, mixed))
    square = apart.mean(axis=0) ** 2 / apart.var(axis=0, ddof=1) * BLOCKS
    tally = {name: run.increments(name).sum(axis=0) for name in ("collisions", "wall_hits", "pair_tests")}
    return {
        "mixture": float(np.median(own / both)),
        "impulses": float(np.median(own / other)),
        "at_walls": float((own / both)[[0, -1]].mean()),
        "mean_square": float(square.mean() * (BLOCKS - 3.0) / (BLOCKS - 1.0)),
        "additions": float((4 * tally["collisions"] + 2 * tally["wall_hits"].sum()) / tally["pair_tests"]),
    }


def pressures_of(run: Run) -> dict[str, float]:
    """Compare pressures by impulses alone and with known means: squared errors, and relative difference. The
    results are means of both walls; with known means both have the same pressure, except for rounding.
    """
    start = float(run.time[0])
    both = (components(data, "pressure", start) for data in (run.data.assign_attrs(tallies="[]"), run.data))
    plain, better = ([component.estimate for component in entries.values()] for entries in both)
    pairs = list(zip(plain, better, strict=True))
    return {
        "pressure": float(np.mean([(first.error / second.error) ** 2 for first, second in pairs])),
        "pressures_apart": float(np.mean([first.value / second.value - 1.0 for first, second in pairs])),
    }


def blocks_of(run: Run, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Compute the mean particle numbers (blocks, bins), by counts and by impulses. Raises SceneError if the
    width is no multiple of the bins of the run.
    """
    axis, has = run.dimension - 1, read_impulses(run.data)
    length = float(run.scene.container.lengths[axis])
    bins = round(length / width)
    numbers = numbers_by_impulses(run, axis, bins, None)
    if numbers is None or not math.isclose(bins * width, length):
        rule = f"its bins, {has and has.to_text()}, do not divide a width of {width:g}"
        raise SceneError("impulses", has and has.to_text(), rule)
    size = len(numbers) // BLOCKS
    used = size * BLOCKS
    grid = Grid.line(0.0, length, bins)
    cells = grid.cells(run.positions[1 : used + 1, :, axis, None], inside=True)
    counted = grid.sums(cells, None, np.arange(used) // size) / size
    time = np.diff(run.time)[:used].reshape(BLOCKS, size).sum(axis=1)[:, None]
    return counted, numbers[:used].reshape(BLOCKS, size, bins).sum(axis=1) / time


DILUTE, NARROW = 0.1, 0.15  # packing fraction; width in diameters


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims that counts and impulses agree, and that the mixture and known means are better."""
    cases = Table(dataset, "case")
    narrow = cases[cases.width < NARROW]
    is_dilute = narrow.packing_fraction < DILUTE
    for case in cases:
        yield Claim(
            "mean square of counts less impulses over errors, "
            f"at {case.packing_fraction:.2g} in bins of {case.width:g}", case.mean_square, 1.0, 0.4,
            "both are unbiased; errors by blocks, Student's distribution",
            "impulses are missed, or the temperature of a particle depends on its place",
        )  # fmt: skip
    of_dilute = (
        20.0, 4.0, "the noise of counting is absent (requirement)",
        "impulses have noise of their own, or weights are too small",
    )  # fmt: skip
    of_dense = (
        1.3, 0.2, "a mixture is never worse than counts (requirement)", "weights are chosen by noise",
    )  # fmt: skip
    for part, rest in ((narrow[is_dilute], of_dilute), (narrow[~is_dilute], of_dense)):
        for case in part:
            where = f"at {case.packing_fraction:.2g} in bins of {case.width:g}"
            text = f"variance of counts over that of the mixture, {where}"
            yield Claim.at_least(text, case.mixture, *rest)
    once = narrow[narrow.width == narrow.width.min()]
    for case in once:
        yield Claim(
            f"pressure by impulses over that with what is known, less 1, at {case.packing_fraction:.2g}",
            case.pressures_apart, 0.0, 0.01, "what is taken off has the mean 0 in equilibrium",
            "directions have unequal parts of the energy, or coefficients follow from the noise",
        )  # fmt: skip
    for case in once[once.packing_fraction < DILUTE]:
        yield Claim.at_least(
            f"squared error of the pressure over that with what is known, at {case.packing_fraction:.2g}",
            case.pressure, 8.0, 4.0, "without contacts nothing else fluctuates (requirement)",
            "the energy along the axis is not what the wall is given",
        )  # fmt: skip


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the gain in run length against packing fraction: in all bins, at walls, of the pressure."""
    figure, axes = style.new((2.0, 2.0), (2.0,))
    everywhere, at_walls, pressure = axes
    cases = Table(dataset, "case")
    for kind, (width, rows) in enumerate(cases.by("width")):
        rows = rows.sorted_by("packing_fraction")
        name = f"bins of {width:g} diameters"
        for axis, ratio in ((everywhere, rows.mixture), (at_walls, rows.at_walls)):
            style.points(axis, rows.packing_fraction, ratio, kind=kind, label=name)
    once = cases[cases.width == cases.width.min()].sorted_by("packing_fraction")
    style.points(pressure, once.packing_fraction, once.pressure, kind=0, label="both walls")
    for axis, where in zip(axes, ("all bins", "bins at the walls", "pressure"), strict=True):
        style.level(axis, 1.0)
        axis.set_yscale("log")
        style.label_axes(axis, "packing fraction", f"variance ratio, {where}", legend="upper right")
    style.letters(*axes)
    return figure


FIGURES = {"estimators": Parts(SETTINGS, measure, claims, draw)}
