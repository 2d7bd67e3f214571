"""Figure of buoyancy: what a large disc displaces, and where it floats."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates
from gaspart.theory.buoyancy import displaced_area

METHODS = (("force", "force", "from the force"), ("missing", "count", "small discs missing"))


def buoyancy(ds: xr.Dataset) -> Figure:
    """Force against density, the radius that counts as displaced, and the heights of free discs."""
    has_source = "source" in ds.sizes
    figure, axes = style.new((2.1, 2.1), (2.1,), *([(2.1,)] if has_source else []))
    top, middle, bottom = axes[:3]
    ratio = ds.attrs["size_ratio"]
    packing = ds["fixed_packing_fraction"].values
    eta = np.linspace(0.0, 1.1 * packing.max(), 200)
    theory = displaced_area(eta, ratio)
    for area, label, dashes in (
        (np.full_like(eta, ratio**2), "radius $R$", ":"),
        (np.full_like(eta, (ratio + 1.0) ** 2), "radius $R+r$", "--"),
        (theory, "scaled-particle theory", "-"),
    ):
        colour = style.DATA if dashes == "-" else style.GREY
        top.plot(eta, area * eta, ls=dashes, color=colour, label=label, zorder=2)
        middle.plot(eta, np.sqrt(area) - ratio, ls=dashes, color=colour, zorder=2)
    for kind, (mass, radius, label) in enumerate(METHODS):
        look: dict[str, Any] = {"kind": kind, "hollow": bool(kind)}
        for axis, name in ((top, mass), (middle, f"{radius}_radius")):
            look["label"] = label if axis is top else None
            style.measured(axis, packing, estimates(ds, f"fixed_{name}"), **look)
    top.set_ylabel(r"mass displaced $F/mg$")
    top.legend(loc="upper left")
    middle.set_ylabel(r"$(R_\mathrm{eff} - R)/r$")
    middle.set_ylim(-0.15, 1.35)
    middle.set_xlabel(r"packing fraction $\eta$ of the fluid at that height")
    _heights(bottom, ds)
    if has_source:
        _source(axes[3], ds)
    style.letters(*axes)
    return figure


def _heights(axis: Axes, ds: xr.Dataset) -> None:
    """Free discs: mean heights and their fluctuations, with theory."""
    axis.plot(ds["displaced"], ds["height"], color=style.DATA, label=r"displaces $M$", zorder=2)
    mass, height, spread = (ds[f"free_{name}"].values for name in ("mass", "height", "spread"))
    for at, low, high in zip(mass, height - spread, height + spread, strict=True):
        label = "fluctuates" if at == mass[0] else None
        axis.plot([at, at], [low, high], color=style.COLOURS[0], lw=5, alpha=0.25, label=label, zorder=1)
    style.points(axis, mass, height, ds["free_height_error"].values, label="mean height")
    style.points(axis, mass, ds["free_expected"].values, kind=1, label="theory", marker="_", markersize=11)
    axis.set_xlim(0.0, 1.08 * mass.max())
    axis.set_ylim(0.0, ds.attrs["top"])
    axis.set_xlabel("mass $M/m$ of a free disc")
    axis.set_ylabel("height $z$ (length)")
    axis.legend(loc="upper right")


def _source(axis: Axes, ds: xr.Dataset) -> None:
    """The source's discs of many densities: mean heights, with theory, from the floor to the ceiling."""
    density = ds["source_density"].values / ds.attrs["source_density"]
    for name in ("lowest", "highest"):
        style.level(axis, float(ds[f"source_{name}"][0]), ls=":")
    axis.plot(density, ds["source_expected"], color=style.DATA, label="theory", zorder=2)
    style.measured(axis, density, estimates(ds, "source_height"), label="source's discs")
    axis.axvline(1.0, color=style.GREY, ls="--", lw=0.8, zorder=1)
    axis.set_xlabel("density of the disc over the fluid's mean")
    axis.set_ylabel("height $z$ (length)")
    axis.legend(loc="upper right")
