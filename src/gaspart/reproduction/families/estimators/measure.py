"""Density between two walls by counts and impulses, and the pressure on the walls.

The mixture of both estimators is measured too; all are from the same runs.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from gaspart.accuracy.estimates import components
from gaspart.analysis.flow import Grid
from gaspart.analysis.impulses import mixture, numbers_by_impulses, read_impulses
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import mean_of
from gaspart.errors import SceneError
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table

_BLOCKS = 32
_FILLED = 0.2
"""Fraction of the mean density below which bins, which walls close in part, are left out."""


def estimators(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure variances of densities along the last axis, for gases between walls across it.

    The setting is `widths`.

    Returns over `case`, each point with each width of bins: packing_fraction; width, in diameters; mixture
    and impulses, the variance of counts divided by their variance, the median of all bins; at_walls, the
    first in the two bins at the walls, each the mean over replicas, by blocks of time; mean_square, of the
    difference of counts and impulses over its error, divided by its value for Student's distribution;
    additions, of the tally for each pair of particles that the engine has tested; pressure, the squared error
    of the pressure on a wall by its impulses divided by the squared error with known means, and
    pressures_apart, the difference of both over the latter.
    """
    cases = [(point, width) for point in points for width in settings["widths"]]
    return table("case", cases, _row)


def _row(case: tuple[Point, float]) -> dict[str, Any]:
    point, width = case
    diameter = 2.0 * point.scene.largest_radius
    found = [_compared(run, width * diameter) | pressures_of(run) for run in runs(point)]
    rows = {name: mean_of([one[name] for one in found]) for name in found[0]}
    return {"packing_fraction": point.scene.packing_fraction, "width": width, **rows}


def _compared(run: Run, width: float) -> dict[str, float]:
    """Compare the estimators of one run, in bins of this width."""
    counted, impulses = blocks_of(run, width)
    filled = np.flatnonzero(counted.mean(axis=0) > _FILLED * counted.mean())
    counted, impulses = counted[:, filled], impulses[:, filled]
    apart = counted - impulses
    mixed = counted - mixture(counted, impulses, periodic=False) * apart
    own, other, both = (one.var(axis=0, ddof=1) for one in (counted, impulses, mixed))
    square = apart.mean(axis=0) ** 2 / apart.var(axis=0, ddof=1) * _BLOCKS
    tally = {name: run.increments(name).sum(axis=0) for name in ("collisions", "wall_hits", "pair_tests")}
    return {
        "mixture": float(np.median(own / both)),
        "impulses": float(np.median(own / other)),
        "at_walls": float((own / both)[[0, -1]].mean()),
        "mean_square": float(square.mean() * (_BLOCKS - 3.0) / (_BLOCKS - 1.0)),
        "additions": float((4 * tally["collisions"] + 2 * tally["wall_hits"].sum()) / tally["pair_tests"]),
    }


def pressures_of(run: Run) -> dict[str, float]:
    """Compare the pressures of one run on both walls, by two estimators; return the means.

    With the known means both walls have the same pressure but for rounding.
    """
    start = float(run.time[0])
    both = (components(data, "pressure", start) for data in (run.data.assign_attrs(tallies="[]"), run.data))
    plain, better = ([one.estimate for one in found.values()] for found in both)
    pairs = list(zip(plain, better, strict=True))
    return {
        "pressure": float(np.mean([(one.error / other.error) ** 2 for one, other in pairs])),
        "pressures_apart": float(np.mean([one.value / other.value - 1.0 for one, other in pairs])),
    }


def blocks_of(run: Run, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Compute the mean numbers of particles (blocks, bins), by counts and by impulses.

    Raises SceneError for a width that the bins of the run do not divide.
    """
    axis, has = run.dimension - 1, read_impulses(run.data)
    length = float(run.scene.container.lengths[axis])
    bins = round(length / width)
    found = numbers_by_impulses(run, axis, bins, None)
    if found is None or not math.isclose(bins * width, length):
        rule = f"its bins, {has and has.to_text()}, do not divide a width of {width:g}"
        raise SceneError("impulses", has and has.to_text(), rule)
    size = len(found) // _BLOCKS
    used = size * _BLOCKS
    blocks = np.arange(used) // size
    grid = Grid.line(0.0, length, bins)
    cells = grid.cells(run.positions[1 : used + 1, :, axis, None], inside=True)
    counted = grid.sums(cells, None, blocks) / size
    time = np.diff(run.time)[:used].reshape(_BLOCKS, size).sum(axis=1)[:, None]
    return counted, found[:used].reshape(_BLOCKS, size, bins).sum(axis=1) / time
