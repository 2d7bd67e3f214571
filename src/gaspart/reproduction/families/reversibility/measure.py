"""Memory of a gas: growth of echoes, and of the distance of neighbouring runs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import partial

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import mean_of
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table

WINDOW = {"float64": (1e-10, 1e-2), "float32": (1e-5, 1e-2)}
"""Distances, in diameters, between which a growth is fitted: below saturation, and three decades above the
first deviations. These are of all particles alike, and grow faster than by the largest exponent until they
have turned to the direction of fastest growth: from 1e-9, for two runs 1e-10 apart at first, by 1.13(3) of it
in spheres of a packing fraction of 0.001, from 1e-7 by 1.03(4)."""
APART = WINDOW["float64"]
"""Window for the distance of two runs."""
FORGOTTEN = 0.1
"""Distance of the echo from the start, in diameters, at which the memory ends."""


def reversibility(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the growth of the echo per collision, and the memory in collisions.

    The latter are the collisions of a particle after which the initial state is forgotten.

    Points are `echo` jobs. Over (``row``, ``sample``): ``collisions`` (mean) and ``echo`` (median over seeds,
    in diameters). Over ``row``: ``dimension``, ``packing_fraction``, ``count``, ``side`` (in diameters),
    ``engine``, ``precision``; ``growth`` of the logarithm of the echo per collision of a particle,
    ``divergence`` of two exact runs per collision, ``exponent``, of the linearised dynamics (NaN for time
    steps), and ``memory``, in collisions per particle, until the echo is `FORGOTTEN`, each with its
    ``_error`` over the seeds; ``jumps``, the part of the echoes that leave the window in one interval from
    its lower half.
    """
    rows = table("row", points, _row, inner=("sample",))
    return rows.sortby(["dimension", "packing_fraction"])


def _row(point: Point) -> dict:
    """Return the row of one point, with all seeds together."""
    run = xr.load_dataset(point.path)
    window = WINDOW[run.attrs["precision"]]
    collisions, echoes, apart = (run[name].values for name in ("collisions", "echo", "divergence"))
    kept = ("dimension", "count", "side", "engine", "precision")
    return {name: run.attrs[name] for name in kept} | {
        "packing_fraction": round(run.attrs["packing_fraction"], 12),
        "collisions": collisions.mean(axis=0),
        "echo": np.median(echoes, axis=0),
        "jumps": float(np.mean([_jumps(echo, *window) for echo in echoes])),
        "growth": _mean(map(partial(_slope, window), collisions, echoes)),
        "divergence": _mean(map(partial(_slope, APART), collisions, apart)),
        "memory": _mean(map(_memory, collisions, echoes)),
        "exponent": _mean(run.exponent.values),
    }


def _mean(values: Iterable[float]) -> Estimate:
    """Average over the seeds with a known value; NaN for fewer than two."""
    finite = [value for value in values if np.isfinite(value)]
    return mean_of(finite) if len(finite) > 1 else Estimate(math.nan, math.nan, math.nan)


def _slope(window: tuple[float, float], s: np.ndarray, distance: np.ndarray) -> float:
    """Fit the growth of ln distance with s until it first leaves the window.

    NaN with fewer than three points.
    """
    low, high = window
    out = np.flatnonzero(distance >= high)
    end = out[0] if out.size else distance.size
    inside = np.flatnonzero(distance[:end] > low)
    if inside.size < 3:
        return np.nan
    return float(np.polyfit(s[inside], np.log(distance[inside]), 1)[0])


def _memory(s: np.ndarray, distance: np.ndarray) -> float:
    """Find the collisions at which the distance first is `FORGOTTEN`; NaN if it never is.

    The logarithm is interpolated between samples.
    """
    out = np.flatnonzero(distance >= FORGOTTEN)
    if not out.size or out[0] == 0:
        return np.nan
    before, after = np.log(distance[out[0] - 1 : out[0] + 1])
    part = (np.log(FORGOTTEN) - before) / (after - before)
    return float(s[out[0] - 1] + part * (s[out[0]] - s[out[0] - 1]))


def _jumps(distance: np.ndarray, low: float, high: float) -> bool:
    """Return True if the distance jumps from the lower half of the window to beyond it.

    The halves are of the logarithms.
    """
    out = np.flatnonzero(distance >= high)
    return bool(out.size and out[0] > 0 and distance[out[0] - 1] < np.sqrt(low * high))
