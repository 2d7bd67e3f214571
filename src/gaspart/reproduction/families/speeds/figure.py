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
from gaspart.reproduction.families.speeds.claims import ENGINE_TITLES
from gaspart.reproduction.table import Table

KOLMOGOROV_BAND = 1.36
"""Value that sqrt(n) times the Kolmogorov distance exceeds with probability 5 %, for n samples of the true
distribution."""
SPEED, SIGMA = r"speed $v/\sqrt{\langle v^2\rangle}$", r"residual ($\sigma$)"


def speed_relaxation(dataset: xr.Dataset) -> Figure:
    """Draw speed histograms, kurtosis, and fraction of particles never hit.

    Histograms are at the source's three times. Kurtosis and fraction are drawn against collisions.
    """
    figure, axes = style.new((2.8,), (1.9, 1.0), (1.9, 1.0))
    histograms, kurtosis, kurtosis_residual, unhit, unhit_residual = axes
    engines = Table(dataset, "engine")
    _histograms(histograms, engines)
    relaxation = theory.relaxation(engines.dimension)
    longest = 1.04 * engines.collisions.value.max()
    s = np.linspace(0.0, longest, 300)
    kurtosis.plot(s, relaxation.kurtosis(s), color=style.DATA, label="kinetic theory", zorder=2)
    early = s[s < 1.6]
    initial = 1.0 + theory.initial_kurtosis_slope(engines.dimension) * early
    kurtosis.plot(early, initial, color=style.GREY, ls=":", label="initial slope 8/35")
    style.level(kurtosis, theory.kurtosis(engines.dimension), ls="--", label="Maxwell: 5/3")
    unhit.semilogy(s, relaxation.never_hit(s), color=style.DATA, zorder=2)
    _compare(kurtosis, kurtosis_residual, engines, "kurtosis", relaxation.kurtosis)
    _compare(unhit, unhit_residual, engines, "never_hit", relaxation.never_hit)
    for axis in axes[1:]:
        axis.set_xlim(0.0, longest)
    y = r"kurtosis $\langle v^4\rangle/\langle v^2\rangle^2$"
    style.label_axes(kurtosis, y=y, legend="lower right", ylim=(0.97, 1.76))
    style.label_axes(unhit, y="fraction never hit", legend="lower left")
    style.letters(histograms, kurtosis, unhit)
    return figure


def _histograms(axis: Axes, engines: Table) -> None:
    """Draw densities at three times: lines for the time-stepped engine, points for event-driven."""
    edges = np.append(engines.lower, engines.upper[-1])
    middle = 0.5 * (edges[1:] + edges[:-1])
    for kind, frame in enumerate(engines.shown):
        s = engines.collisions.value[:, frame].mean()
        label = f"$t={engines.time[frame]:g}$, $s={s:.1f}$"
        for gas in engines:
            density = gas.density[kind]
            seen = density.value > 0.0
            if gas.engine == "step":
                outline = np.where(seen, density.value, np.nan)
                axis.stairs(outline, edges, color=style.COLOURS[kind], lw=0.8, label=label)
            else:
                style.points(axis, middle[seen], density[seen], kind=kind, markersize=2)
    u, d = np.linspace(1e-3, edges[-1], 300), engines.dimension
    axis.plot(u, theory.maxwell_pdf(u, d, 1.0 / d), color=style.DATA, label="Maxwell", zorder=4)
    peak = engines.density.value.max()
    axis.annotate("never hit", (0.97, 0.8 * peak), (0.05, 9.0), arrowprops={"arrowstyle": "-", "lw": 0.6})
    axis.set(yscale="log", ylim=(2e-3, 20.0), xlim=(0.0, edges[-1]))
    style.label_axes(axis, SPEED, "probability density", legend="upper right")


def _compare(
    top: Axes, bottom: Axes, engines: Table, name: str, curve: Callable[[np.ndarray], ArrayLike]
) -> None:
    """Draw both engines' points on the theoretical curve, and their residuals in standard errors."""
    style.band(bottom, -3.0, 3.0)
    style.level(bottom, 0.0)
    for kind, gas in enumerate(engines):
        s, values = gas.collisions.value[1:], getattr(gas, name)[1:]
        label = ENGINE_TITLES[gas.engine] if name == "never_hit" else None
        style.points(top, s, values, kind=kind, hollow=kind > 0, label=label)
        style.points(bottom, s, (values.value - curve(s)) / values.error, kind=kind, hollow=kind > 0)
    x = r"collisions per particle $s = 2N_\mathrm{coll}/N$"
    style.label_axes(bottom, x, SIGMA, ylim=(-4.5, 4.5), yticks=[-3, 0, 3])


def speed_distribution_spheres(dataset: xr.Dataset) -> Figure:
    """Draw the density, residual, tails and difference of the cumulative distribution in 3D."""
    return _distribution(Table(dataset, "point"))


def speed_distribution_discs(dataset: xr.Dataset) -> Figure:
    """Draw the density, residual, tails and difference of the cumulative distribution in 2D."""
    return _distribution(Table(dataset, "point"))


def _in_words(value: float) -> str:
    """Return a number with two digits for a formula, 10^{-5} instead of 1e-05."""
    digits, _, power = f"{value:.2g}".partition("e")
    factor = "" if digits == "1" else rf"{digits}\cdot "
    return rf"{factor}10^{{{int(power)}}}" if power else digits


def _distribution(gases: Table) -> Figure:
    figure, (density, residual, tail, difference) = style.new((2.3, 1.1), (2.3, 1.1))
    end, dimension = gases.upper[-1], gases.dimension
    u = np.linspace(0.0, end, 401)[1:]
    for axis, label in ((density, "Maxwell"), (tail, None)):
        curve = theory.maxwell_pdf(u, dimension, 1.0 / dimension)
        axis.plot(u, curve, color=style.DATA, label=label, zorder=4)
    style.band(residual, -3.0, 3.0)
    style.level(residual, 0.0)
    style.band(difference, -KOLMOGOROV_BAND, KOLMOGOROV_BAND)
    style.level(difference, 0.0)
    middle, width = 0.5 * (gases.lower + gases.upper), gases.upper[0] - gases.lower[0]
    for kind, gas in enumerate(gases):
        label = f"$\\eta={_in_words(gas.packing_fraction)}$, {ENGINE_TITLES[gas.engine]}"
        style.points(density, middle, gas.density, kind=kind, hollow=True, label=label)
        # Points of different packing fractions are drawn side by side in their bin.
        beside = middle + width * 0.25 * (kind - 0.5 * (len(gases) - 1))
        seen = gas.density.value > 0.0
        style.points(tail, beside[seen], gas.density[seen], kind=kind, hollow=True)
        style.points(residual, beside, gas.residual, kind=kind, markersize=2.5)
        difference.plot(gas.speed, gas.samples**0.5 * gas.difference, color=style.COLOURS[kind])
    values = gases.density.value
    for axis in (residual, difference):
        axis.set(xlim=(0.0, end))
    top = (0.0, 1.5 * values.max())
    style.label_axes(density, y="probability density", legend="upper right", ylim=top)
    style.label_axes(residual, SPEED, SIGMA, ylim=(-4.5, 4.5), yticks=[-3, 0, 3])
    decades = (0.2 * values[values > 0.0].min(), 3.0 * values.max())
    style.label_axes(tail, y="probability density", yscale="log", ylim=decades)
    style.label_axes(difference, SPEED, r"$\sqrt{n}\times$ difference", ylim=(-2.0, 2.0), yticks=[-1, 0, 1])
    style.letters(density, tail, difference)
    return figure
