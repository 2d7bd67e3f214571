"""Figure of an observable against a parameter that varies in a grid."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.analysis.observable import label_of
from gaspart.rendering import style
from gaspart.reproduction.table import Table

_THEORY: dict[str, Any] = {"marker": "_", "markersize": 12, "linestyle": ":", "linewidth": 0.8, "zorder": 2}
"""Style of theory, which is known only at the points; thin lines connect these."""
_FEW = 3
"""Minimum number of points of a theoretical curve that are connected; fewer points are marked instead."""


def observable(dataset: xr.Dataset) -> Figure:
    """Draw the observable of each series with theory, or a curve for each point."""
    points, settings = Table(dataset, "point"), json.loads(dataset.attrs["settings"])
    theory = settings.get("theory", True) and bool(np.isfinite(points.theory.value).any())
    figure, (axis,) = style.new((2.8,))
    draw = _curves if "along_places" in dataset else _numbers
    draw(axis, points, theory)
    axis.set_ylabel(label_of(dataset["value"]))
    scales = settings.get("logarithmic", "none")
    if scales in ("x", "both"):
        axis.set_xscale("log")
    if scales in ("y", "both"):
        axis.set_yscale("log")
    axis.legend()
    return figure


def _numbers(axis: Axes, points: Table, theory: bool) -> None:
    """Draw a series of points for each text of `series`, with theory at these points."""
    for kind, (series, part) in enumerate(points.by("series")):
        style.points(axis, part.against, part.value, kind=kind, label=series or "measured")
        if theory:
            axis.plot(part.against, part.theory.value, color=_colour(kind), **_THEORY)
    if theory:
        axis.plot([], [], color=style.GREY, label="theory", **_THEORY)
    axis.set_xlabel(_words(points.dataset.attrs["against"]))


def _curves(axis: Axes, points: Table, theory: bool) -> None:
    """Draw a curve for each point, with a band of one standard error, and theory.

    The theory of a curve has the colour of the curve.
    """
    look: dict[str, Any] = {"linestyle": "--", "zorder": 4}
    if (~np.isnan(points.theory.value)).sum(axis=1).max() < _FEW:  # like a contact value
        look = {"marker": "x", "linestyle": "none", "zorder": 4}
    for kind, point in enumerate(points):
        x, y, colour = point.along_places, point.value, _colour(kind)
        label = f"{_words(points.dataset.attrs['against'])} {point.against:g}"
        axis.plot(x, y.value, color=colour, label=f"{label}, {point.series}" if point.series else label)
        axis.fill_between(x, y.value - y.error, y.value + y.error, color=colour, alpha=0.3, linewidth=0)
        if theory:
            axis.plot(x, point.theory.value, color=colour, **look)
    if theory:
        axis.plot([], [], color=style.GREY, label="theory", **look)
    axis.set_xlabel(label_of(points.dataset["along_places"]))


def _colour(kind: int) -> str:
    return style.COLOURS[kind % len(style.COLOURS)]


def _words(key: str) -> str:
    return key.removeprefix("scene.").replace("_", " ")
