"""Figures of estimators."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.table import Table


def estimators(dataset: xr.Dataset) -> Figure:
    """How many times counts must be as long a run, against the packing fraction: in all bins and at walls."""
    figure, axes = style.new((2.4,), (2.4,))
    cases = Table(dataset, "case")
    for kind, (width, rows) in enumerate(cases.by("width")):
        rows = rows.sorted_by("packing_fraction")
        name = f"bins of {width:g} diameters"
        for axis, found in zip(axes, (rows.mixture, rows.at_walls), strict=True):
            style.points(axis, rows.packing_fraction, found, kind=kind, label=name)
    for axis, where in zip(axes, ("all bins", "bins at the walls"), strict=True):
        style.level(axis, 1.0)
        axis.set_yscale("log")
        label = f"variance ratio, {where}"
        style.labelled(axis, "packing fraction", label, legend="upper right")
    style.letters(*axes)
    return figure
