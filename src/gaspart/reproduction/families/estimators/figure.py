"""Figures of estimators."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.table import Table


def estimators(dataset: xr.Dataset) -> Figure:
    """Draw the relative run length that other estimators need, against the packing fraction.

    They are counts in all bins and at walls, and impulses of walls alone.
    """
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
