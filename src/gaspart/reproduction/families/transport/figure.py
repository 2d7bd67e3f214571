"""Figures of viscosity and thermal conductivity."""

from __future__ import annotations

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Table

SHOWN_FROM = 4.0
"""Collisions of a particle after which the integrals are close to their final values, and fit on the axis."""


def viscosity(ds: xr.Dataset) -> Figure:
    """Draw shear viscosity divided by Enskog's, bulk viscosity, and running integrals.

    Viscosities are drawn against density. The running integral of the shear viscosity extends up to each
    time.
    """
    return _figure(ds, r"$\eta/\eta_\mathrm{Enskog}$")


def conductivity(ds: xr.Dataset) -> Figure:
    """Draw the thermal conductivity divided by Enskog's, and the running integral."""
    return _figure(ds, r"$\lambda/\lambda_\mathrm{Enskog}$")


def logarithmic_growth(ds: xr.Dataset) -> Figure:
    """Draw the integrals of both fluxes of discs against the logarithm of time.

    The containers have several sizes.
    """
    figure, axes = style.new((2.4,), (2.4,))
    gases = Table(ds, "point")
    late = (gases.time >= SHOWN_FROM).all(axis=0)
    names = {
        "viscosity": r"$\eta/\eta_\mathrm{Enskog}$",
        "conductivity": r"$\lambda/\lambda_\mathrm{Enskog}$",
    }
    for axis, (name, label) in zip(axes, names.items(), strict=True):
        axis.set_xscale("log")
        for kind, gas in enumerate(gases):
            time = gas.time[late]
            style.points(axis, time, gas[name][late], kind=kind, label=f"{gas.count} discs")
            axis.plot(time, gas[f"{name}_modes"][late], color=style.COLOURS[kind], lw=1.2)
        axis.plot([], [], color=style.GREY, lw=1.2, label="modes of the container")
        style.label_axes(axis, r"collisions per particle $\nu t$", f"{label}, discs", "lower right")
    style.letters(*axes)
    return figure


def _figure(ds: xr.Dataset, name: str) -> Figure:
    gases = Table(ds, "point")
    present = [dimension for dimension in (3, 2) if (gases.dimension == dimension).any()]
    figure, axes = style.new(*[(2.4,)] * 2 * len(present))
    for n, dimension in enumerate(present):
        own = gases[gases.dimension == dimension].sorted_by("packing_fraction")
        _density(axes[2 * n], own)
        _running(axes[2 * n + 1], own)
        for axis in axes[2 * n : 2 * n + 2]:
            axis.set_ylabel(f"{name}, {PARTICLES[dimension]}")
    style.letters(*axes)
    return figure


def _density(axis: Axes, gases: Table) -> None:
    """Draw both estimates against the packing fraction."""
    eta, shift = gases.packing_fraction, 0.004
    style.points(axis, eta - shift, gases.value, kind=0, label="Green-Kubo")
    style.points(axis, eta + shift, gases.growth, kind=1, hollow=True, label="Helfand")
    if "bulk" in gases.dataset:
        style.points(axis, eta, gases.bulk, kind=2, label="bulk, Green-Kubo")
    axis.axhline(1.0, color=style.GREY, lw=0.8, label="Enskog")
    axis.set_xlim(0.0, 1.1 * eta.max())
    style.label_axes(axis, r"packing fraction $\phi$", legend="upper left")


def _running(axis: Axes, gases: Table) -> None:
    """Draw the integral of the correlation up to each time."""
    for kind, gas in enumerate(gases[:: max(1, len(gases) // 4)]):
        style.points(axis, gas.time, gas.running, kind=kind, label=rf"$\phi={gas.packing_fraction:.3g}$")
    axis.axhline(1.0, color=style.GREY, lw=0.8)
    axis.set_xlim(0.0)
    style.label_axes(axis, r"collisions per particle $\nu t$", legend="lower right", columns=2)
