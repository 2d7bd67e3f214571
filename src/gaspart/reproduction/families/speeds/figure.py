"""Figures of the speeds: relaxation from equal speeds, and Maxwell's distribution."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates
from gaspart.reproduction.families.speeds.claims import ENGINE_TITLES

KOLMOGOROV_BAND = 1.36
"""sqrt(n) times the Kolmogorov distance of n samples of the right distribution is below this in 95 %."""


def speed_relaxation(ds: xr.Dataset) -> Figure:
    """Histograms at the source's three times; kurtosis and fraction never hit against collisions."""
    figure, axes = style.new((2.8,), (1.9, 1.0), (1.9, 1.0))
    _histograms(axes[0], ds)
    relaxation = theory.relaxation(ds.attrs["dimension"])
    longest = float(ds["collisions"].max())
    s = np.linspace(0.0, 1.04 * longest, 300)

    axes[1].plot(s, relaxation.kurtosis(s), color=style.DATA, label="kinetic theory", zorder=2)
    early = s[s < 1.6]
    slope = theory.initial_kurtosis_slope(ds.attrs["dimension"])
    axes[1].plot(early, 1.0 + slope * early, color=style.GREY, ls=":", label="initial slope 8/35")
    style.level(axes[1], theory.kurtosis(ds.attrs["dimension"]), ls="--", label="Maxwell: 5/3")
    axes[1].set_ylabel(r"kurtosis $\langle v^4\rangle/\langle v^2\rangle^2$")
    axes[3].semilogy(s, relaxation.never_hit(s), color=style.DATA, zorder=2)
    axes[3].set_ylabel("fraction never hit")

    for top, bottom, name, curve in (
        (axes[1], axes[2], "kurtosis", relaxation.kurtosis),
        (axes[3], axes[4], "never_hit", relaxation.never_hit),
    ):
        _compare(top, bottom, ds, name, curve)
        for axis in (top, bottom):
            axis.set_xlim(0.0, 1.04 * longest)
        bottom.set_ylabel(r"residual ($\sigma$)")
        bottom.set_yticks([-3, 0, 3])
        bottom.set_xlabel(r"collisions per particle $s = 2N_\mathrm{coll}/N$")
    axes[1].set_ylim(0.97, 1.76)
    axes[1].legend(loc="lower right")
    axes[3].legend(loc="lower left")
    style.letters(axes[0], axes[1], axes[3])
    return figure


def _histograms(axis: Axes, ds: xr.Dataset) -> None:
    """Densities at the three times: outlines of the time-stepped engine, points of the event-driven."""
    edges = np.append(ds["lower"].values, ds["upper"].values[-1])
    middle = 0.5 * (edges[1:] + edges[:-1])
    for kind, frame in enumerate(ds["shown"].values):
        row = ds.isel(frame=int(frame), snapshot=kind)
        colour = style.COLOURS[kind]
        s = float(row["collisions"].mean())
        label = f"$t={float(row['time']):g}$, $s={s:.1f}$"
        for engine in ds["engine"].values:
            density, error = estimates(row.sel(engine=engine), "density")
            seen = density > 0.0
            if str(engine) == "step":
                axis.stairs(np.where(seen, density, np.nan), edges, color=colour, lw=0.8, label=label)
            else:
                style.points(axis, middle[seen], density[seen], error[seen], kind=kind, markersize=2)
    u = np.linspace(1e-3, edges[-1], 300)
    dimension = ds.attrs["dimension"]
    axis.plot(
        u, theory.maxwell_pdf(u, dimension, 1.0 / dimension), color=style.DATA, label="Maxwell", zorder=4
    )
    peak = float(ds["density"].max())
    axis.annotate("never hit", (0.97, 0.8 * peak), (0.05, 9.0), arrowprops={"arrowstyle": "-", "lw": 0.6})
    axis.set_yscale("log")
    axis.set_ylim(2e-3, 20.0)
    axis.set_xlim(0.0, edges[-1])
    axis.set_xlabel(r"speed $v/\sqrt{\langle v^2\rangle}$")
    axis.set_ylabel("probability density")
    axis.legend(loc="upper right")


def _compare(
    top: Axes, bottom: Axes, ds: xr.Dataset, name: str, curve: Callable[[np.ndarray], ArrayLike]
) -> None:
    """Both engines' points on the curve, and their residuals in standard errors of each."""
    style.band(bottom, -3.0, 3.0)
    style.level(bottom, 0.0)
    for kind, engine in enumerate(ds["engine"].values):
        row = ds.sel(engine=engine).isel(frame=slice(1, None))
        s, (values, errors) = row["collisions"].values, estimates(row, name)
        label = ENGINE_TITLES[str(engine)] if name == "never_hit" else None
        style.points(top, s, values, errors, kind=kind, hollow=kind > 0, label=label)
        style.points(bottom, s, (values - curve(s)) / errors, kind=kind, hollow=kind > 0)
    bottom.set_ylim(-4.5, 4.5)


def speed_distribution_spheres(ds: xr.Dataset) -> Figure:
    """Density, residual, tails and the difference of the cumulative distribution in 3D."""
    return _distribution(ds)


def speed_distribution_discs(ds: xr.Dataset) -> Figure:
    """Density, residual, tails and the difference of the cumulative distribution in 2D."""
    return _distribution(ds)


def _distribution(ds: xr.Dataset) -> Figure:
    dimension = ds.attrs["dimension"]
    figure, (density, residual, tail, difference) = style.new((2.3, 1.1), (2.3, 1.1))
    end = float(ds["upper"][-1])
    u = np.linspace(0.0, end, 401)[1:]
    for axis, label in ((density, "Maxwell"), (tail, None)):
        curve = theory.maxwell_pdf(u, dimension, 1.0 / dimension)
        axis.plot(u, curve, color=style.DATA, label=label, zorder=4)
    style.band(residual, -3.0, 3.0)
    style.level(residual, 0.0)
    style.band(difference, -KOLMOGOROV_BAND, KOLMOGOROV_BAND)
    style.level(difference, 0.0)
    middle = 0.5 * (ds["lower"].values + ds["upper"].values)
    width = ds["upper"].values[0] - ds["lower"].values[0]
    for kind in range(ds.sizes["point"]):
        row = ds.isel(point=kind)
        label = rf"$\eta={float(row['packing_fraction']):.2g}$, {ENGINE_TITLES[str(row['engine'].values)]}"
        values, errors = estimates(row, "density")
        style.points(density, middle, values, errors, kind=kind, hollow=True, label=label)
        # Different packing fractions are drawn side by side within their bin.
        beside = middle + width * 0.25 * (kind - 0.5 * (ds.sizes["point"] - 1))
        seen = values > 0.0
        style.points(tail, beside[seen], values[seen], errors[seen], kind=kind, hollow=True)
        style.points(residual, beside, row["residual"].values, kind=kind, markersize=2.5)
        scaled = float(row["samples"]) ** 0.5 * row["difference"]
        difference.plot(ds["speed"], scaled, color=style.COLOURS[kind])
    density.set_ylabel("probability density")
    residual.set_ylabel(r"residual ($\sigma$)")
    tail.set_ylabel("probability density")
    difference.set_ylabel(r"$\sqrt{n}\times$ difference")
    for axis in (residual, difference):
        axis.set_xlabel(r"speed $v/\sqrt{\langle v^2\rangle}$")
        axis.set_xlim(0.0, end)
    residual.set_ylim(-4.5, 4.5)
    residual.set_yticks([-3, 0, 3])
    tail.set_yscale("log")
    smallest = float(ds["density"].where(ds["density"] > 0.0).min())
    tail.set_ylim(0.2 * smallest, 3.0 * float(ds["density"].max()))
    difference.set_ylim(-2.0, 2.0)
    difference.set_yticks([-1, 0, 1])
    density.set_ylim(0.0, 1.5 * float(ds["density"].max()))
    density.legend(loc="upper right")
    style.letters(density, tail, difference)
    return figure
