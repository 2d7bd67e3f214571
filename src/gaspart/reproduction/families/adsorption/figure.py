"""Figure of adsorbing walls: wells, a hard layer, and the source's sticky wall."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates
from gaspart.theory.adsorption import (
    flux_density,
    langmuir_coverage,
    scaled_particle_activity,
    well_ratio,
)


def adsorption(ds: xr.Dataset) -> Figure:
    """Ratio and prefactor of ideal gases, isotherms of a layer and of a sticky wall, speeds of desorption."""
    figure, axes = style.new((2.2, 1.1), (1.7,), (2.0,), (1.4,), (1.9,))
    ideal, layer, sticky = (
        ds.isel(point=np.flatnonzero(ds["kind"] == kind)) for kind in ("ideal", "layer", "sticky")
    )
    _ratios(axes[0], axes[1], ideal)
    _lengths(axes[2], ideal)
    _isotherm(axes[3], layer)
    _sticky_coverage(axes[4], sticky)
    _leaving(axes[5], ideal, sticky)
    for axis, title in zip(
        (axes[0], *axes[2:]),
        ("(a) wells", "(b) wells", "(c) a hard layer", "(d) sticky wall", "(e) well, sticky wall"),
        strict=True,
    ):
        style.letter(axis, title)
    return figure


def _ratios(top: Axes, bottom: Axes, ds: xr.Dataset) -> None:
    """Adsorbed over free particles against 1 / kT, and the deviation from the exact ratio."""
    style.level(bottom, 0.0)
    inverse = np.linspace(0.0, 1.05 / float(ds["temperature"].min()), 50)
    for kind, row in enumerate(_groups(ds, "depth", "width")):
        depth, width, outside = (float(row[name][0]) for name in ("depth", "width", "outside"))
        label = f"$\\epsilon$ = {depth:g}, $w$ = {width:g}"
        where = 1.0 / row["temperature"].values
        style.measured(top, where, estimates(row, "ratio"), kind=kind, hollow=True, label=label)
        top.plot(inverse, well_ratio(depth * inverse, width, outside), color=style.COLOURS[kind], lw=0.8)
        deviation = row["log_ratio"].values - np.log(well_ratio(depth * where, width, outside))
        spread = 0.02 * (kind - 1)
        style.points(
            bottom,
            where + spread,
            100.0 * deviation,
            100.0 * row["log_ratio_error"].values,
            kind=kind,
            hollow=True,
        )
    top.set_yscale("log")
    top.set_ylabel(r"$N_\mathrm{ads}/N_\mathrm{gas}$")
    top.legend(loc="upper left")
    bottom.set_xlim(inverse[0], inverse[-1])
    bottom.set_ylabel("deviation from\nexact (%)")
    bottom.set_xlabel(r"inverse temperature $1/kT$")


def _lengths(axis: Axes, ds: xr.Dataset) -> None:
    """The length in Langmuir's formula, in widths of the well, against temperature."""
    temperatures = np.geomspace(0.8 * ds["temperature"].min(), 1.25 * ds["temperature"].max(), 50)
    axis.plot(temperatures, temperatures**-0.5, color=style.DATA, ls=":", label="a thermal wavelength")
    axis.axhline(1.0, color=style.REFERENCE, label="the width of the well")
    for kind, row in enumerate(_groups(ds, "depth", "width")):
        scale = float(row["width"][0])
        value, error = estimates(row, "length") / scale
        style.points(axis, row["temperature"].values, value, error, kind=kind, hollow=True)
    axis.set_xscale("log")
    axis.set_xticks([0.5, 1.0, 2.0], ["0.5", "1", "2"])
    axis.minorticks_off()
    axis.set_ylabel(r"length $\lambda/w$")
    axis.set_xlabel(r"temperature $kT$")
    axis.legend(loc="upper right")


def _isotherm(axis: Axes, ds: xr.Dataset) -> None:
    """Coverage of a layer against the activity of the gas."""
    eta = np.linspace(1e-3, 0.52, 300)
    axis.plot(scaled_particle_activity(eta), eta, color=style.REFERENCE, label="hard discs (SPT)")
    activity = np.geomspace(0.01, 100.0, 200)
    axis.plot(activity, activity, color=style.GREY, ls=":", label="ideal: Henry")
    axis.plot(activity, langmuir_coverage(activity), color=style.GREY, ls="--", label="sites: Langmuir")
    axis.errorbar(
        ds["activity"].values,
        ds["coverage"].values,
        xerr=ds["activity_error"].values,
        yerr=ds["coverage_error"].values,
        color=style.DATA,
        marker="o",
        markerfacecolor="white",
        linestyle="none",
        elinewidth=0.8,
        zorder=4,
        label="spheres",
    )
    axis.set_xscale("log")
    axis.set_xlim(0.02, 60.0)
    axis.set_ylim(0.0, 0.6)
    axis.set_ylabel(r"coverage $\eta$")
    axis.set_xlabel(r"$(P/kT)\, w\, e^{\epsilon/kT}\, \pi\sigma^2/4$")
    axis.legend(loc="lower right")


def _sticky_coverage(axis: Axes, ds: xr.Dataset) -> None:
    """Coverage of a sticky wall against the density of the gas."""
    density, coverage = ds["gas_density"].values, ds["coverage"].values
    style.points(axis, density, coverage, ds["coverage_error"].values, kind=1, label="sticky wall")
    line = np.geomspace(0.8 * density.min(), 1.25 * density.max(), 50)
    middle = len(density) // 2
    henry = coverage[middle] * line / density[middle]
    axis.plot(line, henry, color=style.GREY, ls="--", label="in equilibrium: Henry")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlim(line[0], line[-1])
    axis.set_xticks([0.01, 0.02, 0.05], ["0.01", "0.02", "0.05"])
    axis.minorticks_off()
    axis.set_ylabel(r"coverage $\eta$")
    axis.set_xlabel(r"density of the gas $\rho\sigma^3$")
    axis.legend(loc="lower right")


def _leaving(axis: Axes, wells: xr.Dataset, ds: xr.Dataset) -> None:
    """Normal speeds of the particles that leave a well, and of those that leave a sticky wall."""
    speed = ds["speed"].values
    line = np.linspace(0.0, speed[-1], 200)
    axis.plot(line, flux_density(line), color=style.REFERENCE, label=r"$v\,e^{-v^2/2}$")
    dense = ds.isel(point=int(ds["gas_density"].values.argmax()))
    well = wells.isel(point=0)
    for row, kind, label in ((well, 0, "well"), (dense, 1, "sticky wall")):
        value, error = estimates(row, "flux")
        style.points(axis, speed, value, error, kind=kind, hollow=not kind, label=label)
    axis.axvline(float(dense["slow_speed"]), color=style.GREY, ls=":")
    axis.set_ylim(bottom=0.0)
    axis.set_ylabel("share leaving")
    axis.set_xlabel(r"normal speed $v\sqrt{m/kT}$")
    axis.legend(loc="upper right")


def _groups(ds: xr.Dataset, *names: str) -> list[xr.Dataset]:
    """The points in groups of equal settings."""
    settings = list(zip(*(ds[name].values.tolist() for name in names), strict=True))
    return [
        ds.isel(point=[n for n, own in enumerate(settings) if own == setting])
        for setting in sorted(set(settings))
    ]
