"""Figure of buoyancy: displaced mass, and height, of a large disc."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.table import Table
from gaspart.theory.brownian import displaced_area


def buoyancy(ds: xr.Dataset) -> Figure:
    """Draw the force against density, the displaced radius, and the heights of free discs."""
    fixed, free, source = (Table.from_prefixed(ds, kind) for kind in ("fixed", "free", "source"))
    figure, axes = style.new((2.1, 2.1), (2.1,), *([(2.1,)] if source else []))
    top, middle, bottom = axes[:3]
    _draw_displacement(top, middle, fixed, ds.attrs["size_ratio"])
    _heights(bottom, free, Table(ds, "height"))
    if source:
        _source(axes[3], source)
    style.letters(*axes)
    return figure


def _draw_displacement(top: Axes, middle: Axes, discs: Table, ratio: float) -> None:
    """Draw the mass that fixed discs displace, and the displaced radius, with theory.

    The radius is computed from the force, and also from the number of missing small discs.
    """
    packing = discs.packing_fraction.value
    eta = np.linspace(0.0, 1.1 * packing.max(), 200)
    for area, label, dashes in (
        (np.full_like(eta, ratio**2), "radius $R$", ":"),
        (np.full_like(eta, (ratio + 1.0) ** 2), "radius $R+r$", "--"),
        (displaced_area(eta, ratio), "scaled-particle theory", "-"),
    ):
        colour = style.DATA if dashes == "-" else style.GREY
        top.plot(eta, area * eta, ls=dashes, color=colour, label=label, zorder=2)
        middle.plot(eta, np.sqrt(area) - ratio, ls=dashes, color=colour, zorder=2)
    style.points(top, packing, discs.force, label="from the force")
    style.points(top, packing, discs.missing, kind=1, hollow=True, label="missing small discs")
    style.points(middle, packing, discs.force_radius)
    style.points(middle, packing, discs.count_radius, kind=1, hollow=True)
    style.label_axes(top, y=r"displaced mass $F/mg$", legend="upper left")
    labels = r"packing fraction $\eta$ of the fluid at that height", r"$(R_\mathrm{eff} - R)/r$"
    style.label_axes(middle, *labels, ylim=(-0.15, 1.35))


def _heights(axis: Axes, discs: Table, fluid: Table) -> None:
    """Draw mean heights and their fluctuations for free discs, with theory."""
    axis.plot(fluid.displaced, fluid.height, color=style.DATA, label=r"displaced mass $M$", zorder=2)
    for disc in discs:
        label = "standard deviation" if disc.mass == discs.mass[0] else None
        ends = [disc.height.value - disc.spread.value, disc.height.value + disc.spread.value]
        axis.plot([disc.mass] * 2, ends, color=style.COLOURS[0], lw=5, alpha=0.25, label=label, zorder=1)
    style.points(axis, discs.mass, discs.height, label="mean height")
    style.points(axis, discs.mass, discs.expected, kind=1, label="theory", marker="_", markersize=11)
    labels = "mass $M/m$ of a free disc", "height $z$ (length)"
    style.label_axes(axis, *labels, legend="upper right", ylim=(0.0, discs.top))
    axis.set_xlim(0.0, 1.08 * discs.mass.max())


def _source(axis: Axes, discs: Table) -> None:
    """Draw the mean heights of discs of many densities, as in the source, with theory.

    The axis extends from the floor to the ceiling.
    """
    density = discs.density / discs.source_density
    for end in (discs.lowest[0], discs.highest[0]):
        style.level(axis, end, ls=":")
    axis.plot(density, discs.expected, color=style.DATA, label="theory", zorder=2)
    style.points(axis, density, discs.height, label="source's discs")
    axis.axvline(1.0, color=style.GREY, ls="--", lw=0.8, zorder=1)
    labels = "density of the disc / mean of the fluid", "height $z$ (length)"
    style.label_axes(axis, *labels, legend="upper right")
