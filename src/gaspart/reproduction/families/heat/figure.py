"""Figures of heat conduction between a hot and a cold wall."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates
from gaspart.theory.heat import conducting_slab

FREE_MOLECULAR = 100.0
"""Knudsen number above which points are drawn at a separate place, as infinity."""
NOISY = 0.03
"""Relative error from which on a density profile is not drawn."""


def heat_conduction_gas(ds: xr.Dataset) -> Figure:
    """Flux against density, and over that of free flight; the approach to the steady state; profiles of
    temperature and of density."""
    figure, axes = style.new((2.5,), (2.3,), (1.8,), (2.7, 1.3, 2.6))
    flux, share, start, warm, off, dense = axes
    _fluxes(flux, ds.isel(point=np.flatnonzero(ds["knudsen"] < FREE_MOLECULAR)))
    _shares(share, ds)
    spheres = ds.isel(point=np.flatnonzero((ds["knudsen"] < FREE_MOLECULAR) & ~ds["normal"].astype(bool)))
    order = np.argsort(spheres["knudsen"].values)
    for kind, n in enumerate(dict.fromkeys((order[0], order[len(order) // 2], order[-1]))):
        _profiles(warm, off, dense, spheres.isel(point=n), kind)
    _approach(start, spheres.isel(point=order[0]))
    style.level(off, 0.0)
    for wall in ("hot", "cold"):
        warm.axhline(float(ds[wall][0]), color=style.GREY, lw=0.6, ls=":")
    warm.set_ylabel("temperature $T$")
    warm.legend(loc="upper right")
    off.set_ylabel(r"$T/T_\mathrm{th}-1$ (%)")
    off.set_ylim(-2.5, 2.5)
    dense.set_ylabel(r"density $n/\bar n$")
    dense.set_xlabel("position between the walls $x/L$")
    style.letters(flux, share, start, warm, dense)
    return figure


def _fluxes(axis: Axes, ds: xr.Dataset) -> None:
    """Flux against density, with both limits."""
    row = ds.isel(point=0)
    number = np.geomspace(5e-4, 0.08, 100)
    hot, cold, length, fourier = (float(row[key]) for key in ("hot", "cold", "length", "fourier"))
    free = number / float(row["number"]) * float(row["full"])
    axis.plot(number, 1e3 * free, color=style.GREY, label="free flight")
    axis.axhline(1e3 * fourier, color=style.GREY, ls="--", lw=1.0, label=r"Fourier, $\lambda_0$")
    axis.plot(number, 1e3 / (1.0 / free + 1.0 / fourier), color=style.GREY, ls=":", label="guide")
    fluid = ds["number"].values[np.isfinite(ds["slab_flux"].values)]
    if fluid.size:
        line = np.geomspace(fluid.min(), fluid.max(), 5)
        theory = [1e3 * _conducted(length, n, hot, cold) for n in line.tolist()]
        axis.plot(line, theory, color=style.DATA, label="with jumps", zorder=4)
    for kind, name in enumerate(("all components", "normal only")):
        own = ds.isel(point=np.flatnonzero(ds["normal"] == kind))
        flux = 1e3 * estimates(own, "flux")
        style.measured(axis, own["number"], flux, kind=kind, hollow=bool(kind), label=name)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_ylim(0.2, 12.0)
    axis.tick_params(axis="x", which="minor", labelbottom=False)
    axis.set_xlabel(r"number density $n\sigma^3$")
    axis.set_ylabel(r"heat flux $q$ ($10^{-3}$ reduced units)")
    axis.legend(loc="lower right", ncol=2, columnspacing=0.8)


@cache
def _conducted(length: float, number: float, hot: float, cold: float) -> float:
    """Flux of `conducting_slab`, which takes a second."""
    return conducting_slab(length, number, hot, cold).flux


def _shares(axis: Axes, ds: xr.Dataset) -> None:
    """Flux over that of free flight against the Knudsen number; the thinnest gases at infinity."""
    end = 20.0
    for level in (1.0, 2.0 / 3.0, 0.5):
        style.level(axis, level)
    for kind, (normal, dimension, name) in enumerate(
        ((0, 3, "all, spheres"), (1, 3, "normal, spheres"), (0, 2, "all, discs"), (1, 2, "normal, discs"))
    ):
        own = ds.isel(point=np.flatnonzero((ds["normal"] == normal) & (ds["dimension"] == dimension)))
        if not own.sizes["point"]:
            continue
        knudsen = np.where(own["knudsen"] < FREE_MOLECULAR, own["knudsen"], end * 1.15 ** (dimension - 2.5))
        flux = estimates(own, "flux") / own["full"].values
        style.measured(axis, knudsen, flux, kind=kind, hollow=bool(normal), label=name)
    axis.set_xscale("log")
    axis.set_xlim(0.02, 40.0)
    axis.set_xticks([0.1, 1.0, end], ["0.1", "1", r"$\infty$"])
    axis.set_yticks([0.0, 0.5, 2.0 / 3.0, 1.0], ["0", "1/2", "2/3", "1"])
    axis.set_ylim(0.0, 1.6)
    axis.set_xlabel(r"Knudsen number $l/L$")
    axis.set_ylabel("flux / that of free flight")
    axis.legend(loc="upper right", ncol=2, columnspacing=0.8)


def _approach(axis: Axes, row: xr.Dataset) -> None:
    """The difference of temperature between the halves of one gas, from the start on."""
    label = rf"$l/L = {float(row['knudsen']):.2g}$"
    difference = estimates(row, "approach")
    style.measured(axis, row["approach_time"], difference, kind=0, hollow=True, markersize=2.5, label=label)
    axis.plot(
        row["approach_time"], row["expected_approach"], color=style.DATA, zorder=4, label="heat equation"
    )
    axis.set_xlabel("time $t$ (reduced units)")
    axis.set_ylabel(r"$T_\mathrm{hot\,half}-T_\mathrm{cold\,half}$")
    axis.legend(loc="lower right")


def _profiles(warm: Axes, off: Axes, dense: Axes, row: xr.Dataset, kind: int) -> None:
    """One gas's temperature, its deviation from theory, and its density."""
    position = row["position"].values / float(row["length"])
    number = float(row["number"])
    temperature, error = estimates(row, "temperature")
    label = rf"$l/L = {float(row['knudsen']):.2g}$"
    small: dict[str, Any] = {"kind": kind, "hollow": True, "markersize": 2.5}
    style.points(warm, position, temperature, error, label=label, **small)
    density = estimates(row, "density") / number
    if np.median(density[1]) < NOISY:
        style.measured(dense, position, density, **small)
    if not np.isfinite(row["slab_flux"]):
        return
    theory = row["slab_temperature"].values
    warm.plot(position, theory, color=style.DATA, zorder=4, label="Fourier with jumps")
    dense.plot(position, row["slab_density"].values / number, color=style.DATA, zorder=4)
    used = row["used"].values
    ratio = 100.0 * (temperature / theory - 1.0)
    style.points(off, position[used], ratio[used], 100.0 * (error / theory)[used], **small)


def heat_conduction_metal(ds: xr.Dataset) -> Figure:
    """Temperatures of electrons and modes between two walls, among scatterers at random places; energy
    against temperature."""
    figure, (top, bottom, off) = style.new((3.0,), (2.2, 1.2))
    for n in np.flatnonzero((ds["hot"] != ds["cold"]) & ~ds["regular"].astype(bool)):
        row = ds.isel(point=n)
        for kind, (name, label) in enumerate((("electrons", "electrons"), ("modes", "modes"))):
            style.measured(top, row["position"], estimates(row, name), kind, hollow=bool(kind), label=label)
        for wall in ("hot", "cold"):
            top.axhline(float(row[wall]), color=style.GREY, lw=0.6, ls=":")
    top.set_xlabel("position between the walls $x/L$")
    top.set_ylabel(r"$T$ of electrons, $\langle E\rangle$ of modes")
    top.legend(loc="upper right")
    still = ds.isel(point=np.flatnonzero(ds["hot"] == ds["cold"]))
    warm, capacity = still["hot"].values, float(ds["expected"][0])
    line = np.array([0.0, 1.1 * warm.max()])
    bottom.plot(line, line, color=style.REFERENCE, label=r"$(N_e d/2 + N_s)\,kT$")
    level, error = estimates(still, "energy_ratio")
    style.points(bottom, warm, level * warm, error * warm, kind=1, label="electrons and modes")
    electrons = float(ds["electrons_part"][0])
    bottom.plot(line, electrons * line, color=style.GREY, ls="--", label="frozen modes")
    bottom.set_ylabel(rf"energy / {capacity:g}")
    bottom.legend(loc="upper left")
    style.level(off, 0.0)
    style.points(off, warm, 100.0 * (level - 1.0), 100.0 * error, kind=1)
    modes = (100.0 * (still["mode_ratio"] - 1.0), 100.0 * still["mode_ratio_error"])
    style.points(off, 1.02 * warm, *modes, kind=0, hollow=True)
    off.set_ylim(-3.5, 3.5)
    off.set_ylabel("deviation (%)")
    off.set_xlabel("temperature of both walls $kT$")
    style.letters(top, bottom)
    return figure
