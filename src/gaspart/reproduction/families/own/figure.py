"""Figure of an observable against what varies in a grid."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.analysis.observable import label_of
from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates

_THEORY: dict[str, Any] = {"marker": "_", "markersize": 12, "linestyle": ":", "linewidth": 0.8, "zorder": 2}
"""Theory is known at the points only, which thin lines connect."""
_FEW = 3
"""Places of a curve, below which those of theory are marked instead of connected."""


def observable(dataset: xr.Dataset) -> Figure:
    """The observable of each series of points, with theory's values; one curve for each point of a curve."""
    settings = json.loads(dataset.attrs["settings"])
    theory = settings.get("theory", True) and bool(np.isfinite(dataset["theory"]).any())
    figure, (axis,) = style.new((2.8,))
    if "along_places" in dataset:
        _curves(axis, dataset, theory)
    else:
        _numbers(axis, dataset, theory)
    axis.set_ylabel(label_of(dataset["value"]))
    scales = settings.get("logarithmic", "none")
    if scales in ("x", "both"):
        axis.set_xscale("log")
    if scales in ("y", "both"):
        axis.set_yscale("log")
    axis.legend()
    return figure


def _numbers(axis: Axes, dataset: xr.Dataset, theory: bool) -> None:
    """One series of points for each text of `series`, and theory's values at their places."""
    for kind, (series, part) in enumerate(dataset.groupby("series")):
        label = str(series) or "measured"
        style.measured(axis, part["against"], estimates(part, "value"), kind, label=label)
        if theory:
            axis.plot(part["against"], part["theory"], color=_colour(kind), **_THEORY)
    if theory:
        axis.plot([], [], color=style.GREY, label="theory", **_THEORY)
    axis.set_xlabel(_words(dataset.attrs["against"]))


def _curves(axis: Axes, dataset: xr.Dataset, theory: bool) -> None:
    """One curve for each point, with a band of one standard error, and theory's in the same colour."""
    look: dict[str, Any] = {"linestyle": "--", "zorder": 4}
    if dataset["theory"].notnull().sum("along").max() < _FEW:  # as at contact
        look = {"marker": "x", "linestyle": "none", "zorder": 4}
    for kind in range(dataset.sizes["point"]):
        row = dataset.isel(point=kind)
        x, (value, error) = row["along_places"].values, estimates(row, "value")
        series = str(row["series"].values)
        label = f"{_words(dataset.attrs['against'])} {float(row['against']):g}"
        axis.plot(x, value, color=_colour(kind), label=f"{label}, {series}" if series else label)
        axis.fill_between(x, value - error, value + error, color=_colour(kind), alpha=0.3, linewidth=0)
        if theory:
            axis.plot(x, row["theory"], color=_colour(kind), **look)
    if theory:
        axis.plot([], [], color=style.GREY, label="theory", **look)
    axis.set_xlabel(label_of(dataset["along_places"]))


def _colour(kind: int) -> str:
    return style.COLOURS[kind % len(style.COLOURS)]


def _words(key: str) -> str:
    return key.removeprefix("scene.").replace("_", " ")
