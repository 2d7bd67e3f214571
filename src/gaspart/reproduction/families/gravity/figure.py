"""Figures of gases under gravity: profiles against height, and the heat capacity."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.analysis.estimate import Estimate
from gaspart.rendering import style
from gaspart.reproduction.families.gravity.claims import IDEAL
from gaspart.reproduction.table import Row, Table
from gaspart.theory.gravity import ideal_heat_capacity, ideal_profile
from gaspart.theory.state import compressibility_factor

KNOWN = 0.1
"""Largest relative error of a bin of height that is drawn; other bins contain hardly any particles."""


def barometric(ds: xr.Dataset) -> Figure:
    """Draw density and temperature against height, equation of state, and the source's column.

    The equation of state follows from the weight.
    """
    of_source = _select_columns(ds, "later", "source")
    figure, axes = style.new((2.4, 1.1, 1.1), (1.7, 1.0), *([(1.5, 1.1)] if of_source else []))
    top, ratio, warm, state, off = axes[:5]
    for kind, row in enumerate(_select_columns(ds, "dilute", "dense")):
        expected = _expected_density(row, 0)
        _density(top, row, kind, f"{row.column}, {'hydrostatics' if kind else 'ideal gas'}", row.column)
        density = row.density[0]
        seen = _enough_particles(density) & row.used
        _percent(ratio, row.height[seen], (density / expected)[seen], kind)
        _temperature(warm, row, kind)
    [dense] = _select_columns(ds, "dense")
    eta = dense.packing_fraction.value[dense.used]
    line = np.linspace(0.0, 1.05 * eta.max(), 200)
    state.plot(line, compressibility_factor(line, 2), color=style.DATA, label="virial series to $B_{10}$")
    label = "weight above / $\\rho kT$"
    style.points(state, eta, dense.compressibility[dense.used], kind=1, hollow=True, label=label)
    _percent(off, eta, dense.pressure_ratio[dense.used], 1)
    top.set_yscale("log")
    style.label_axes(top, y=r"density $\rho/\bar\rho$", ylim=(0.04, 12.0))
    top.legend(loc="upper right", ncol=2, columnspacing=0.8)
    style.label_axes(ratio, y=r"$\rho/\rho_\mathrm{th} - 1$ (%)")
    style.label_axes(warm, "height $z$ (length)", r"$T(z)/T - 1$ (%)")
    style.label_axes(state, y=r"$Z = P/\rho kT$", legend="upper left")
    style.label_axes(off, r"packing fraction $\eta$", r"$Z/Z_\mathrm{ref} - 1$ (%)")
    if of_source:
        _source_columns(axes[5], axes[6], of_source)
    style.letters(top, ratio, warm, state, *axes[5:6])
    return figure


def _source_columns(top: Axes, bottom: Axes, columns: list[Row]) -> None:
    """Draw density and temperature of the source's column, in the source's sample and later."""
    for kind, row in enumerate(columns, start=2):
        name = {"later": "later", "source": "source's sample"}[row.column]
        _density(top, row, kind, None if kind > 2 else "hydrostatics", name)
        _temperature(bottom, row, kind)
    top.set_ylim(0.0)
    style.label_axes(top, y=r"density $\rho/\bar\rho$", legend="upper right")
    label = "height $z$ (length) in the source's column"
    style.label_axes(bottom, label, r"$T(z)/T - 1$ (%)", ylim=(-6.0, 12.0))


def separation(ds: xr.Dataset) -> Figure:
    """Draw densities of heavy and light discs, their ratio, and the source's mixture.

    The densities are of a dilute and a dense gas.
    """
    of_source = _select_columns(ds, "source")
    figure, axes = style.new((2.2,), (2.2,), (2.0, 1.0), *[(1.6,) for _ in of_source])
    names = ("light", "heavy")
    columns = _select_columns(ds, "dilute", "dense")
    for n, (axis, row) in enumerate(zip(axes[:2], columns, strict=True)):
        for kind, name in enumerate(names):
            _density(axis, row, kind, None, name)
            if n:
                ideal = _ideal(row, kind) / row.mean_density
                axis.plot(row.height, ideal, color=style.COLOURS[kind], ls=":", label=f"{name} if ideal")
        axis.set_yscale("log")
        style.label_axes(axis, "height $z$ (length)", r"density $\rho_i/\bar\rho$", ylim=(0.01, 20.0))
        axis.legend(loc="upper right", ncol=2, columnspacing=0.8)
    _exchange(axes[2], axes[3], columns)
    for axis, row in zip(axes[4:], of_source, strict=True):
        _shares(axis, row)
    titled = (*axes[:3], *axes[4:])
    for axis, title in zip(titled, ("(a) dilute", "(b) dense", "(c)", "(d)"), strict=False):
        style.letter(axis, title)
    return figure


def _exchange(top: Axes, bottom: Axes, columns: list[Row]) -> None:
    """Draw the density ratio against height, with the exact slope, and residuals."""
    style.band(bottom, -3.0, 3.0)
    style.level(bottom, 0.0)
    for kind, row in enumerate(columns, start=2):
        error = row.log_ratio.error
        seen = np.isfinite(error) & (error < 0.3)
        height, ratio, expected = row.height[seen], row.log_ratio[seen], row.log_ratio_expected[seen]
        style.points(top, height, ratio, kind=kind, hollow=True, label=row.column)
        top.plot(height, expected, color=style.COLOURS[kind], zorder=4)
        style.points(bottom, height, (ratio.value - expected) / ratio.error, kind=kind, markersize=2.5)
    style.label_axes(top, y=r"$\ln(\rho_\mathrm{heavy}/\rho_\mathrm{light})$", legend="upper right")
    style.label_axes(
        bottom, "height $z$ (length)", r"residual ($\sigma$)", ylim=(-4.5, 4.5), yticks=[-3, 0, 3]
    )


def _shares(axis: Axes, row: Row) -> None:
    """Draw fractions of light discs in the source's mixture.

    The fractions are from the source's run, from ours, and from equilibrium theory.
    """
    reported = np.array(row.source_shares)
    edges = np.linspace(0.0, row.top, len(reported) + 1)
    axis.stairs(reported, edges, baseline=None, color=style.GREY, label="source's run")
    style.points(axis, 0.5 * (edges[1:] + edges[:-1]), row.share, kind=1, label="our run")
    light, heavy = row.hydrostatic
    axis.plot(row.height, light / (light + heavy), color=style.REFERENCE, label="equilibrium at the same $T$")
    label = "height $z$ (length) in the source's mixture"
    style.label_axes(axis, label, "fraction of light discs", "upper left", ylim=(0.0, 1.0))


def _select_columns(ds: xr.Dataset, *names: str) -> list[Row]:
    """Return the columns with these names that exist, in this order."""
    columns = {row.column: row for row in Table(ds, "point")}
    return [columns[name] for name in names if name in columns]


def _density(axis: Axes, row: Row, kind: int, theory: str | None, label: str) -> None:
    """Draw density divided by its mean against height, with theory.

    If there are several species, the species of index `kind` is drawn.
    """
    species = kind if len(row.density) > 1 else 0
    density, mean = row.density[species], row.mean_density
    seen = _enough_particles(density)
    style.points(axis, row.height[seen], density[seen] / mean, kind=kind, hollow=True, label=label)
    axis.plot(
        row.height, _expected_density(row, species) / mean, color=style.COLOURS[kind], label=theory, zorder=4
    )


def _enough_particles(density: Estimate) -> np.ndarray:
    """Return True for the bins (B,) with enough particles."""
    return np.asarray(density.error < KNOWN * density.value)


def _temperature(axis: Axes, row: Row, kind: int) -> None:
    """Draw the temperature by height, relative to the entire column, in bins with enough particles."""
    seen = _enough_particles(row.density[0])
    _percent(axis, row.height[seen], row.temperature_ratio[seen], kind)


def heat_capacity(ds: xr.Dataset) -> Figure:
    """Draw heat capacity against x, from energies and from fluctuations, and its deviation."""
    figure, (top, bottom) = style.new((2.6, 1.2))
    pairs, runs = Table(ds, "pair"), Table(ds.stack(each=("pair", "run")), "each")
    end = 1.15 * max(pairs.x.max(), runs.run_x.max())
    x = np.linspace(0.0, end, 300)
    top.plot(x, ideal_heat_capacity(x, 2), color=style.DATA, label="canonical, ideal gas")
    style.level(top, 1.0, ls="--")
    style.level(top, 2.0, ls="--")
    style.level(bottom, 0.0)
    series = (
        (pairs.x, pairs.slope, pairs.slope_expected, "from $dE/dT$"),
        (runs.run_x, runs.fluctuation, runs.fluctuation_expected, "from fluctuations"),
    )
    for kind, (at, capacity, expected, label) in enumerate(series):
        look: dict = {"kind": kind, "hollow": bool(kind)}
        style.points(top, at, capacity, **look, label=label)
        style.points(bottom, at, 100.0 * (capacity / expected - 1.0), **look)
    style.label_axes(top, y=r"heat capacity $C_V/Nk$", legend="lower right", ylim=(0.9, 2.1))
    height, deviation = r"height of the box $x = mgH/kT$", "deviation from\nexact (%)"
    style.label_axes(bottom, height, deviation, xlim=(-0.03 * end, end), ylim=(-4.5, 4.5))
    style.letters(top, bottom)
    return figure


def _expected_density(row: Row, kind: int) -> np.ndarray:
    """Return the expected density (B,): ideal gas in a dilute column, else hydrostatics."""
    dilute = row.packing_fraction.value.max() < IDEAL
    return _ideal(row, kind) if dilute else np.asarray(row.hydrostatic[kind])


def _ideal(row: Row, kind: int) -> np.ndarray:
    """Compute the density (B,) of an ideal gas with the column's particle number and temperature."""
    weight = row.mass[kind] * row.strength / row.temperature.value
    number = row.density.value[kind].mean() * row.top
    return np.asarray(number * ideal_profile(row.height, row.top, weight))


def _percent(axis: Axes, x: np.ndarray, ratio: Estimate, kind: int) -> None:
    """Draw the deviation of a ratio from 1 in per cent, with a line at zero."""
    style.level(axis, 0.0)
    style.points(axis, x, 100.0 * (ratio - 1.0), kind=kind, hollow=True, markersize=2.5)
    axis.set_ylim(-4.5, 4.5)
