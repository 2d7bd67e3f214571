"""Figures of heat conduction between a hot and a cold wall."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.table import Row, Table
from gaspart.theory.heat import conducting_slab

FREE_MOLECULAR = 100.0
"""Knudsen number above which points are drawn separately, at infinity."""
NOISY = 0.03
"""Relative error above which a density profile is not drawn."""


def heat_conduction_gas(ds: xr.Dataset) -> Figure:
    """Draw flux against density and Knudsen number, the approach to a steady state, profiles.

    The flux is also drawn relative to free flight. The profiles are of temperature and of density.
    """
    figure, axes = style.new((2.5,), (2.3,), (1.8,), (2.7, 1.3, 2.6))
    flux, share, start, warm, off, dense = axes
    gases = Table(ds, "point")
    crowded = gases[gases.knudsen < FREE_MOLECULAR]
    _fluxes(flux, crowded)
    _shares(share, gases)
    spheres = crowded[~crowded.normal.astype(bool)].sorted_by("knudsen")
    for kind, n in enumerate(dict.fromkeys((0, len(spheres) // 2, len(spheres) - 1))):
        _profiles(warm, off, dense, spheres[n], kind)
    _approach(start, spheres[0])
    style.level(off, 0.0)
    for wall in (gases.hot[0], gases.cold[0]):
        warm.axhline(wall, color=style.GREY, lw=0.6, ls=":")
    style.label_axes(warm, y="temperature $T$", legend="upper right")
    style.label_axes(off, y=r"$T/T_\mathrm{th}-1$ (%)", ylim=(-2.5, 2.5))
    style.label_axes(dense, "position between the walls $x/L$", r"density $n/\bar n$")
    style.letters(flux, share, start, warm, dense)
    return figure


def _fluxes(axis: Axes, gases: Table) -> None:
    """Draw the flux against density, with its two limits."""
    first, number = gases[0], np.geomspace(5e-4, 0.08, 100)
    free, fourier = number / first.number * first.full, first.fourier
    axis.plot(number, 1e3 * free, color=style.GREY, label="free flight")
    axis.axhline(1e3 * fourier, color=style.GREY, ls="--", lw=1.0, label=r"Fourier, $\lambda_0$")
    axis.plot(number, 1e3 / (1.0 / free + 1.0 / fourier), color=style.GREY, ls=":", label="guide")
    fluid = gases.number[np.isfinite(gases.slab_flux)]
    if fluid.size:
        line = np.geomspace(fluid.min(), fluid.max(), 5)
        theory = [1e3 * _conducted_flux(first.length, n, first.hot, first.cold) for n in line.tolist()]
        axis.plot(line, theory, color=style.DATA, label="with jumps", zorder=4)
    for kind, name in enumerate(("all components", "normal only")):
        own = gases[gases.normal == kind]
        style.points(axis, own.number, 1e3 * own.flux, kind=kind, hollow=bool(kind), label=name)
    axis.set(xscale="log", yscale="log", ylim=(0.2, 12.0))
    axis.tick_params(axis="x", which="minor", labelbottom=False)
    labels = r"number density $n\sigma^3$", r"heat flux $q$ ($10^{-3}$ reduced units)"
    style.label_axes(axis, *labels)
    axis.legend(loc="lower right", ncol=2, columnspacing=0.8)


@cache
def _conducted_flux(length: float, number: float, hot: float, cold: float) -> float:
    """Compute the flux of `conducting_slab`; each value takes a second."""
    return conducting_slab(length, number, hot, cold).flux


def _shares(axis: Axes, gases: Table) -> None:
    """Draw flux over free flight, against Knudsen number; the thinnest gases are at infinity."""
    end = 20.0
    for level in (1.0, 2.0 / 3.0, 0.5):
        style.level(axis, level)
    for kind, (normal, dimension, name) in enumerate(
        ((0, 3, "all, spheres"), (1, 3, "normal, spheres"), (0, 2, "all, discs"), (1, 2, "normal, discs"))
    ):
        own = gases[(gases.normal == normal) & (gases.dimension == dimension)]
        if not own:
            continue
        knudsen = np.where(own.knudsen < FREE_MOLECULAR, own.knudsen, end * 1.15 ** (dimension - 2.5))
        style.points(axis, knudsen, own.flux / own.full, kind=kind, hollow=bool(normal), label=name)
    axis.set(xscale="log", xlim=(0.02, 40.0))
    axis.set_xticks([0.1, 1.0, end], ["0.1", "1", r"$\infty$"])
    axis.set_yticks([0.0, 0.5, 2.0 / 3.0, 1.0], ["0", "1/2", "2/3", "1"])
    style.label_axes(axis, r"Knudsen number $l/L$", "flux / free-flight flux", ylim=(0.0, 1.6))
    axis.legend(loc="upper right", ncol=2, columnspacing=0.8)


def _approach(axis: Axes, gas: Row) -> None:
    """Draw the temperature difference between the halves of a gas against time."""
    look: dict[str, Any] = {"hollow": True, "markersize": 2.5, "label": rf"$l/L = {gas.knudsen:.2g}$"}
    style.points(axis, gas.approach_time, gas.approach, **look)
    theory: dict[str, Any] = {"color": style.DATA, "zorder": 4, "label": "heat equation"}
    axis.plot(gas.approach_time, gas.expected_approach, **theory)
    difference = r"$T_\mathrm{hot\,half}-T_\mathrm{cold\,half}$"
    style.label_axes(axis, "time $t$ (reduced units)", difference, "lower right")


def _profiles(warm: Axes, off: Axes, dense: Axes, gas: Row, kind: int) -> None:
    """Draw the temperature of a gas, its deviation from theory, and its density."""
    position = gas.position / gas.length
    small: dict[str, Any] = {"kind": kind, "hollow": True, "markersize": 2.5}
    style.points(warm, position, gas.temperature, label=rf"$l/L = {gas.knudsen:.2g}$", **small)
    density = gas.density / gas.number
    if np.median(density.error) < NOISY:
        style.points(dense, position, density, **small)
    if not np.isfinite(gas.slab_flux):
        return
    theory = gas.slab_temperature
    warm.plot(position, theory, color=style.DATA, zorder=4, label="Fourier with jumps")
    dense.plot(position, gas.slab_density / gas.number, color=style.DATA, zorder=4)
    deviation = 100.0 * (gas.temperature / theory - 1.0)
    style.points(off, position[gas.used], deviation[gas.used], **small)


def heat_conduction_metal(ds: xr.Dataset) -> Figure:
    """Draw temperatures of electrons and modes between two walls, and energy.

    The electrons move between scatterers at random positions. The energy is drawn against temperature.
    """
    figure, (top, bottom, off) = style.new((3.0,), (2.2, 1.2))
    points = Table(ds, "point")
    for metal in points[(points.hot != points.cold) & ~points.regular.astype(bool)]:
        for kind, (energy, label) in enumerate(((metal.electrons, "electrons"), (metal.modes, "modes"))):
            style.points(top, metal.position, energy, kind=kind, hollow=bool(kind), label=label)
        for wall in (metal.hot, metal.cold):
            top.axhline(wall, color=style.GREY, lw=0.6, ls=":")
    labels = "position between the walls $x/L$", r"$T$ of electrons, $\langle E\rangle$ of modes"
    style.label_axes(top, *labels, legend="upper right")
    still = points[points.hot == points.cold]
    warm, electrons = still.hot, points.electrons_part[0]
    line = np.array([0.0, 1.1 * warm.max()])
    bottom.plot(line, line, color=style.REFERENCE, label=r"$(N_e d/2 + N_s)\,kT$")
    style.points(bottom, warm, still.energy_ratio * warm, kind=1, label="electrons and modes")
    bottom.plot(line, electrons * line, color=style.GREY, ls="--", label="frozen modes")
    style.label_axes(bottom, y=rf"energy / {points.expected[0]:g}", legend="upper left")
    style.level(off, 0.0)
    style.points(off, warm, 100.0 * (still.energy_ratio - 1.0), kind=1)
    style.points(off, 1.02 * warm, 100.0 * (still.mode_ratio - 1.0), kind=0, hollow=True)
    style.label_axes(off, "temperature of both walls $kT$", "deviation (%)", ylim=(-3.5, 3.5))
    style.letters(top, bottom)
    return figure
