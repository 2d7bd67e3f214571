"""How long a gas remembers its start: growth of echoes, and of the distance of neighbouring runs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from gaspart.analysis.statistics import mean_of
from gaspart.reproduction.families.shared.rows import from_rows
from gaspart.reproduction.points.point import Point

WINDOW = {"float64": (1e-13, 1e-2), "float32": (1e-5, 1e-2)}
"""Distances, in diameters, between which a growth is fitted: above the first roundings, below saturation."""
FORGOTTEN = 0.1
"""The memory ends where the echo is so many diameters from the start."""


def reversibility(points: list[Point], settings: dict) -> xr.Dataset:
    """Growth of the echo per collision of a particle, and the collisions after which the initial state is
    forgotten.

    points: `echo` jobs. Over (``row``, ``sample``): ``collisions`` (mean) and ``echo`` (median over seeds, in
    diameters). Over ``row``: ``dimension``, ``packing_fraction``, ``count``, ``side`` (in diameters),
    ``engine``, ``precision``; ``growth`` of the logarithm of the echo per collision of a particle,
    ``divergence`` of two exact runs likewise, ``exponent``, of the linearised dynamics (NaN for time steps),
    and ``memory``, in collisions per particle, until the echo is `FORGOTTEN`, each with its ``_error`` over
    the seeds; ``jumps``, the part of the echoes that leave the window in one interval from its lower half.
    """
    rows = [_row(xr.load_dataset(point.path)) for point in points]
    rows = sorted(rows, key=lambda row: (row["dimension"], row["packing_fraction"]))
    return from_rows("row", rows, ("sample",))


def _row(run: xr.Dataset) -> dict:
    """One point: all seeds together."""
    precision = run.attrs["precision"]
    found = {
        "growth": [_slope(s, y, *WINDOW[precision]) for s, y in _pairs(run, "echo")],
        "divergence": [_slope(s, y, 1e-9, 1e-2) for s, y in _pairs(run, "divergence")],
        "memory": [_memory(s, y) for s, y in _pairs(run, "echo")],
        "exponent": run.exponent.values,
    }
    row = {
        "dimension": run.attrs["dimension"],
        "packing_fraction": round(run.attrs["packing_fraction"], 12),
        "count": run.attrs["count"],
        "side": run.attrs["side"],
        "engine": run.attrs["engine"],
        "precision": precision,
        "collisions": run.collisions.mean("seed").values,
        "echo": run.echo.median("seed").values,
        "jumps": float(np.mean([_jumps(y, *WINDOW[precision]) for _, y in _pairs(run, "echo")])),
    }
    for name, values in found.items():
        values = np.array(values)[np.isfinite(values)]
        estimate = mean_of(values) if values.size > 1 else None
        row[name] = estimate.value if estimate else np.nan
        row[f"{name}_error"] = estimate.error if estimate else np.nan
        row[f"{name}_freedom"] = estimate.freedom if estimate else np.nan
    return row


def _pairs(run: xr.Dataset, name: str) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    return zip(run.collisions.values, run[name].values, strict=True)


def _slope(s: np.ndarray, distance: np.ndarray, low: float, high: float) -> float:
    """Growth of ln distance with s until it first leaves the window; NaN with fewer than three points."""
    out = np.flatnonzero(distance >= high)
    end = out[0] if out.size else distance.size
    inside = np.flatnonzero(distance[:end] > low)
    if inside.size < 3:
        return np.nan
    return float(np.polyfit(s[inside], np.log(distance[inside]), 1)[0])


def _memory(s: np.ndarray, distance: np.ndarray) -> float:
    """Where the distance first is `FORGOTTEN`, between samples by its logarithm; NaN if it never is."""
    out = np.flatnonzero(distance >= FORGOTTEN)
    if not out.size or out[0] == 0:
        return np.nan
    before, after = np.log(distance[out[0] - 1 : out[0] + 1])
    part = (np.log(FORGOTTEN) - before) / (after - before)
    return float(s[out[0] - 1] + part * (s[out[0]] - s[out[0] - 1]))


def _jumps(distance: np.ndarray, low: float, high: float) -> bool:
    """Whether it comes from the lower half (of the logarithms) of the window to beyond it at once."""
    out = np.flatnonzero(distance >= high)
    return bool(out.size and out[0] > 0 and distance[out[0] - 1] < np.sqrt(low * high))
