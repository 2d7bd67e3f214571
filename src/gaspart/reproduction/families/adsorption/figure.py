"""Figure of adsorption: wide wells, a layer of hard particles, and a sticky wall."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.adsorption.claims import KINDS
from gaspart.reproduction.table import Table
from gaspart.theory.adsorption import (
    flux_density,
    langmuir_coverage,
    scaled_particle_activity,
    well_ratio,
)


def adsorption(dataset: xr.Dataset) -> Figure:
    """Draw ratio and prefactor of ideal gases, isotherms, and speeds of desorbed particles."""
    figure, axes = style.new((2.2, 1.1), (1.7,), (2.0,), (1.4,), (1.9,))
    walls = Table(dataset, "point")
    ideal, layer, sticky = (walls[walls.kind == kind] for kind in KINDS)
    _ratios(axes[0], axes[1], ideal)
    _lengths(axes[2], ideal)
    _isotherm(axes[3], layer)
    _sticky_coverage(axes[4], sticky)
    _leaving(axes[5], ideal, sticky)
    titles = "(a) wells", "(b) wells", "(c) thin well", "(d) sticky wall", "(e) well and sticky wall"
    for axis, title in zip((axes[0], *axes[2:]), titles, strict=True):
        style.letter(axis, title)
    return figure


def _ratios(top: Axes, bottom: Axes, wells: Table) -> None:
    """Draw the ratio of adsorbed to free particles against 1 / kT, and its relative deviation."""
    style.level(bottom, 0.0)
    inverse = np.linspace(0.0, 1.05 / wells.temperature.min(), 50)
    for kind, (depth, width, well) in enumerate(wells.by("depth", "width")):
        label = f"$\\epsilon$ = {depth:g}, $w$ = {width:g}"
        inverse_temperature, outside = 1.0 / well.temperature, well.outside[0]
        style.points(top, inverse_temperature, well.ratio, kind=kind, hollow=True, label=label)
        top.plot(inverse, well_ratio(depth * inverse, width, outside), color=style.COLOURS[kind], lw=0.8)
        deviation = well.log_ratio - np.log(well_ratio(depth * inverse_temperature, width, outside))
        style.points(
            bottom, inverse_temperature + 0.02 * (kind - 1), 100.0 * deviation, kind=kind, hollow=True
        )
    top.set_yscale("log")
    style.label_axes(top, y=r"$N_\mathrm{ads}/N_\mathrm{gas}$", legend="upper left")
    labels = r"inverse temperature $1/kT$", "deviation from\nexact (%)"
    style.label_axes(bottom, *labels, xlim=(inverse[0], inverse[-1]))


def _lengths(axis: Axes, wells: Table) -> None:
    """Draw the length in Langmuir's formula, divided by the width of the well, against temperature."""
    temperatures = np.geomspace(0.8 * wells.temperature.min(), 1.25 * wells.temperature.max(), 50)
    axis.plot(temperatures, temperatures**-0.5, color=style.DATA, ls=":", label="thermal wavelength")
    axis.axhline(1.0, color=style.REFERENCE, label="width of the well")
    for kind, (_, width, well) in enumerate(wells.by("depth", "width")):
        style.points(axis, well.temperature, well.length / width, kind=kind, hollow=True)
    axis.set_xscale("log")
    axis.set_xticks([0.5, 1.0, 2.0], ["0.5", "1", "2"])
    axis.minorticks_off()
    style.label_axes(axis, r"temperature $kT$", r"length $\lambda/w$", "upper right")


def _isotherm(axis: Axes, layers: Table) -> None:
    """Draw the coverage of a layer against the activity of the gas."""
    eta = np.linspace(1e-3, 0.52, 300)
    axis.plot(scaled_particle_activity(eta), eta, color=style.REFERENCE, label="hard discs (SPT)")
    activity = np.geomspace(0.01, 100.0, 200)
    axis.plot(activity, activity, color=style.GREY, ls=":", label="Henry (ideal gas)")
    axis.plot(activity, langmuir_coverage(activity), color=style.GREY, ls="--", label="Langmuir (sites)")
    spheres = layers.activity, layers.coverage
    style.points(axis, *spheres, color=style.DATA, hollow=True, zorder=4, label="spheres")
    axis.set_xscale("log")
    pressure = r"$(P/kT)\, w\, e^{\epsilon/kT}\, \pi\sigma^2/4$"
    style.label_axes(axis, pressure, r"coverage $\eta$", "lower right", xlim=(0.02, 60.0), ylim=(0.0, 0.6))


def _sticky_coverage(axis: Axes, walls: Table) -> None:
    """Draw the coverage of a sticky wall against the density of the gas."""
    density, middle = walls.gas_density.value, len(walls) // 2
    style.points(axis, density, walls.coverage, kind=1, label="sticky wall")
    line = np.geomspace(0.8 * density.min(), 1.25 * density.max(), 50)
    henry = walls.coverage.value[middle] * line / density[middle]
    axis.plot(line, henry, color=style.GREY, ls="--", label="Henry (equilibrium)")
    axis.set(xscale="log", yscale="log")
    axis.set_xticks([0.01, 0.02, 0.05], ["0.01", "0.02", "0.05"])
    axis.minorticks_off()
    labels = r"density of the gas $\rho\sigma^3$", r"coverage $\eta$"
    style.label_axes(axis, *labels, legend="lower right", xlim=(line[0], line[-1]))


def _leaving(axis: Axes, wells: Table, walls: Table) -> None:
    """Draw the normal speeds of particles that leave a well or a sticky wall."""
    line = np.linspace(0.0, walls.speed[-1], 200)
    axis.plot(line, flux_density(line), color=style.REFERENCE, label=r"$v\,e^{-v^2/2}$")
    dense = walls[np.argmax(walls.gas_density.value)]
    for row, kind, label in ((wells[0], 0, "well"), (dense, 1, "sticky wall")):
        style.points(axis, walls.speed, row.flux, kind=kind, hollow=not kind, label=label)
    axis.axvline(dense.slow_speed, color=style.GREY, ls=":")
    labels = r"normal speed $v\sqrt{m/kT}$", "probability density"
    style.label_axes(axis, *labels, legend="upper right", ylim=(0.0, None))
