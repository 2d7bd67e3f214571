"""Figures of viscosity and conductivity."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared.claims import PARTICLES, rows
from gaspart.reproduction.families.shared.rows import estimates

SHOWN_FROM = 4.0
"""Collisions of a particle after which the integrals are near enough to their ends for the axis."""


def viscosity(ds: xr.Dataset) -> Figure:
    """The shear viscosity over Enskog's, and the bulk viscosity, against density, and the integral of the
    former until each time."""
    return _figure(ds, r"$\eta/\eta_\mathrm{Enskog}$")


def conductivity(ds: xr.Dataset) -> Figure:
    """The conductivity of heat over Enskog's, likewise."""
    return _figure(ds, r"$\lambda/\lambda_\mathrm{Enskog}$")


def logarithmic_growth(ds: xr.Dataset) -> Figure:
    """The integrals of both fluxes of discs against the logarithm of time, in containers of several sizes."""
    figure, axes = style.new((2.4,), (2.4,))
    names = {
        "viscosity": r"$\eta/\eta_\mathrm{Enskog}$",
        "conductivity": r"$\lambda/\lambda_\mathrm{Enskog}$",
    }
    for axis, (name, label) in zip(axes, names.items(), strict=True):
        axis.set_xscale("log")
        for kind, row in enumerate(rows(ds.isel(lag=(ds["time"] >= SHOWN_FROM).all("point")), "point")):
            value, error = estimates(row, name)
            text = f"{int(row['count'])} discs"
            style.points(axis, row["time"], value, error, kind=kind, label=text)
            axis.plot(row["time"], row[f"{name}_modes"], color=style.COLOURS[kind], lw=1.2)
        axis.plot([], [], color=style.GREY, lw=1.2, label="modes of the container")
        axis.set_xlabel(r"collisions per particle $\nu t$")
        axis.set_ylabel(f"{label}, discs")
        axis.legend(loc="lower right")
    style.letters(*axes)
    return figure


def _figure(ds: xr.Dataset, name: str) -> Figure:
    present = [dimension for dimension in (3, 2) if (ds["dimension"] == dimension).any()]
    figure, axes = style.new(*[(2.4,)] * 2 * len(present))
    for n, dimension in enumerate(present):
        row = ds.isel(point=np.flatnonzero(ds["dimension"] == dimension)).sortby("packing_fraction")
        _density(axes[2 * n], row, dimension)
        _running(axes[2 * n + 1], row, dimension)
        for axis in axes[2 * n : 2 * n + 2]:
            axis.set_ylabel(f"{name}, {PARTICLES[dimension]}")
    style.letters(*axes)
    return figure


def _density(axis: Axes, row: xr.Dataset, dimension: int) -> None:
    """Both forms against the packing fraction."""
    eta = row["packing_fraction"].values
    shift = 0.004
    style.measured(axis, eta - shift, estimates(row, "value"), 0, label="Green-Kubo")
    style.measured(axis, eta + shift, estimates(row, "growth"), 1, hollow=True, label="Helfand")
    if "bulk" in row:
        style.measured(axis, eta, estimates(row, "bulk"), 2, label="bulk, Green-Kubo")
    axis.axhline(1.0, color=style.GREY, lw=0.8, label="Enskog")
    axis.set_xlim(0.0, 1.1 * eta.max())
    axis.set_xlabel(r"packing fraction $\phi$")
    axis.legend(loc="upper left")


def _running(axis: Axes, row: xr.Dataset, dimension: int) -> None:
    """The integral of the correlation until each time."""
    for kind, n in enumerate(range(0, row.sizes["point"], max(1, row.sizes["point"] // 4))):
        one = row.isel(point=n)
        value, error = estimates(one, "running")
        label = rf"$\phi={float(one['packing_fraction']):.3g}$"
        style.points(axis, one["time"], value, error, kind=kind, label=label)
    axis.axhline(1.0, color=style.GREY, lw=0.8)
    axis.set_xlim(0.0)
    axis.set_xlabel(r"collisions per particle $\nu t$")
    axis.legend(loc="lower right", ncols=2)
