"""Figures of gases under gravity: profiles against height, and the heat capacity."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.reproduction.families.shared.rows import estimates
from gaspart.theory.gravity import ideal_heat_capacity, ideal_profile
from gaspart.theory.state import compressibility_factor

KNOWN = 0.1
"""Relative errors up to which a bin of height is drawn: bins with larger ones hold hardly any particles."""


def barometric(ds: xr.Dataset) -> Figure:
    """Density and temperature against height, the equation of state from the weight, and the source's
    column."""
    of_source = _named(ds, "later", "source")
    figure, axes = style.new((2.4, 1.1, 1.1), (1.7, 1.0), *([(1.5, 1.1)] if of_source else []))
    top, ratio, warm, state, off = axes[:5]
    for kind, row in enumerate(_named(ds, "dilute", "dense")):
        expected = _expected(row, 0)
        name = _name(row)
        _density(top, row, kind, f"{name}, {'hydrostatics' if kind else 'ideal gas'}", name)
        density = estimates(row.isel(species=0), "density")
        seen = (density[1] < KNOWN * density[0]) & row["used"].values
        _percent(ratio, row["height"].values[seen], (density / expected)[:, seen], kind)
        _temperature(warm, row, kind)
    [dense] = _named(ds, "dense")
    used = dense["used"].values
    eta = dense["packing_fraction"].values[used]
    line = np.linspace(0.0, 1.05 * eta.max(), 200)
    state.plot(line, compressibility_factor(line, 2), color=style.DATA, label="virial series to $B_{10}$")
    factor = estimates(dense, "compressibility")[:, used]
    label = "weight above / $\\rho kT$"
    style.measured(state, eta, factor, kind=1, hollow=True, label=label)
    _percent(off, eta, estimates(dense, "pressure_ratio")[:, used], 1)
    top.set_yscale("log")
    top.set_ylim(0.04, 12.0)
    top.set_ylabel(r"density $\rho/\bar\rho$")
    top.legend(loc="upper right", ncol=2, columnspacing=0.8)
    ratio.set_ylabel(r"$\rho/\rho_\mathrm{th} - 1$ (%)")
    warm.set_ylabel(r"$T(z)/T - 1$ (%)")
    state.set_ylabel(r"$Z = P/\rho kT$")
    state.legend(loc="upper left")
    off.set_ylabel(r"$Z/Z_\mathrm{ref} - 1$ (%)")
    warm.set_xlabel("height $z$ (length)")
    off.set_xlabel(r"packing fraction $\eta$")
    if of_source:
        _source_columns(axes[5], axes[6], of_source)
    style.letters(top, ratio, warm, state, *axes[5:6])
    return figure


def _source_columns(top: Axes, bottom: Axes, columns: list[xr.Dataset]) -> None:
    """Density and temperature of the source's column, in the source's sample and later."""
    for kind, row in enumerate(columns, start=2):
        name = {"later": "later", "source": "source's sample"}[_name(row)]
        _density(top, row, kind, None if kind > 2 else "hydrostatics", name)
        _temperature(bottom, row, kind)
    top.set_ylabel(r"density $\rho/\bar\rho$")
    top.set_ylim(0.0)
    top.legend(loc="upper right")
    bottom.set_ylabel(r"$T(z)/T - 1$ (%)")
    bottom.set_ylim(-6.0, 12.0)
    bottom.set_xlabel("height $z$ (length) in the source's column")


def separation(ds: xr.Dataset) -> Figure:
    """Heavy and light discs: densities, dilute and dense, the ratio of the two, and the source's mixture."""
    of_source = _named(ds, "source")
    figure, axes = style.new((2.2,), (2.2,), (2.0, 1.0), *[(1.6,) for _ in of_source])
    names = ("light", "heavy")
    columns = _named(ds, "dilute", "dense")
    for n, (axis, row) in enumerate(zip(axes[:2], columns, strict=True)):
        for kind, name in enumerate(names):
            _density(axis, row, kind, None, name)
            if n:
                ideal = _ideal(row, kind) / float(row["mean_density"])
                axis.plot(row["height"], ideal, color=style.COLOURS[kind], ls=":", label=f"{name} if ideal")
        axis.set_yscale("log")
        axis.set_ylim(0.01, 20.0)
        axis.set_ylabel(r"density $\rho_i/\bar\rho$")
        axis.set_xlabel("height $z$ (length)")
        axis.legend(loc="upper right", ncol=2, columnspacing=0.8)
    style.band(axes[3], -3.0, 3.0)
    style.level(axes[3], 0.0)
    for n, row in enumerate(columns):
        error = row["log_ratio_error"].values
        seen = np.isfinite(error) & (error < 0.3)
        height, value, expected = (
            row[key].values[seen] for key in ("height", "log_ratio", "log_ratio_expected")
        )
        style.points(axes[2], height, value, error[seen], kind=2 + n, hollow=True, label=_name(row))
        axes[2].plot(height, expected, color=style.COLOURS[2 + n], zorder=4)
        style.points(axes[3], height, (value - expected) / error[seen], kind=2 + n, markersize=2.5)
    axes[2].set_ylabel(r"$\ln(\rho_\mathrm{heavy}/\rho_\mathrm{light})$")
    axes[2].legend(loc="upper right")
    axes[3].set_ylabel(r"residual ($\sigma$)")
    axes[3].set_ylim(-4.5, 4.5)
    axes[3].set_yticks([-3, 0, 3])
    axes[3].set_xlabel("height $z$ (length)")
    for axis, row in zip(axes[4:], of_source, strict=True):
        _shares(axis, row)
    titled = (*axes[:3], *axes[4:])
    for axis, title in zip(titled, ("(a) dilute", "(b) dense", "(c)", "(d)"), strict=False):
        style.letter(axis, title)
    return figure


def _shares(axis: Axes, row: xr.Dataset) -> None:
    """Shares of the light discs in the source's mixture: in its run, in ours, and in equilibrium."""
    reported = np.array(row.attrs["source_shares"])
    edges = np.linspace(0.0, float(row["top"]), len(reported) + 1)
    axis.stairs(reported, edges, baseline=None, color=style.GREY, label="source's run")
    middles = 0.5 * (edges[1:] + edges[:-1])
    style.measured(axis, middles, estimates(row, "share"), kind=1, label="the same, here")
    light, heavy = row["hydrostatic"].values
    axis.plot(row["height"], light / (light + heavy), color=style.REFERENCE, label="equilibrium at its $T$")
    axis.set_ylabel("share of light discs")
    axis.set_xlabel("height $z$ (length) in the source's mixture")
    axis.set_ylim(0.0, 1.0)
    axis.legend(loc="upper left")


def _named(ds: xr.Dataset, *names: str) -> list[xr.Dataset]:
    """The columns of these names, in this order; those that there are."""
    columns = {_name(row): row for row in (ds.isel(point=n) for n in range(ds.sizes["point"]))}
    return [columns[name] for name in names if name in columns]


def _name(row: xr.Dataset) -> str:
    return str(row["column"].values)


def _density(axis: Axes, row: xr.Dataset, kind: int, theory: str | None, label: str) -> None:
    """Density over its mean against height, with theory; of species number `kind` if there are several."""
    species = kind if row.sizes["species"] > 1 else 0
    height, mean = row["height"].values, float(row["mean_density"])
    density, error = estimates(row.isel(species=species), "density")
    seen = error < KNOWN * density
    where = (axis, height[seen], density[seen] / mean, error[seen] / mean)
    style.points(*where, kind=kind, hollow=True, label=label)
    axis.plot(height, _expected(row, species) / mean, color=style.COLOURS[kind], label=theory, zorder=4)


def _temperature(axis: Axes, row: xr.Dataset, kind: int) -> None:
    """The temperature at each height over that of all, where there are particles enough."""
    density, error = estimates(row.isel(species=0), "density")
    seen = error < KNOWN * density
    _percent(axis, row["height"].values[seen], estimates(row, "temperature_ratio")[:, seen], kind)


def heat_capacity(ds: xr.Dataset) -> Figure:
    """Heat capacity against x, from neighbouring energies and from fluctuations, and its deviation."""
    figure, (top, bottom) = style.new((2.6, 1.2))
    end = 1.15 * float(max(ds["x"].max(), ds["run_x"].max()))
    x = np.linspace(0.0, end, 300)
    top.plot(x, ideal_heat_capacity(x, 2), color=style.DATA, label="canonical, ideal gas")
    style.level(top, 1.0, ls="--")
    style.level(top, 2.0, ls="--")
    style.level(bottom, 0.0)
    series = (
        ("slope", "x", "from $dE/dT$"),
        ("fluctuation", "run_x", "from fluctuations"),
    )
    for kind, (name, axis, label) in enumerate(series):
        at, value, error, expected = (
            ds[key].values.ravel() for key in (axis, name, f"{name}_error", f"{name}_expected")
        )
        style.points(top, at, value, error, kind=kind, hollow=bool(kind), label=label)
        style.points(
            bottom,
            at,
            100.0 * (value / expected - 1.0),
            100.0 * error / expected,
            kind=kind,
            hollow=bool(kind),
        )
    top.set_ylabel(r"heat capacity $C_V/Nk$")
    top.set_ylim(0.9, 2.1)
    top.legend(loc="lower right")
    bottom.set_ylabel("deviation from\nexact (%)")
    bottom.set_xlim(-0.03 * end, end)
    bottom.set_ylim(-4.5, 4.5)
    bottom.set_xlabel(r"height of the box $x = mgH/kT$")
    style.letters(top, bottom)
    return figure


def _expected(row: xr.Dataset, kind: int) -> np.ndarray:
    """(B,) density: an ideal gas's where the column is dilute, hydrostatics elsewhere."""
    dilute = float(row["packing_fraction"].max()) < 0.01
    return _ideal(row, kind) if dilute else row["hydrostatic"].isel(species=kind).values


def _ideal(row: xr.Dataset, kind: int) -> np.ndarray:
    """(B,) density of an ideal gas of as many particles at the column's temperature."""
    own = row.isel(species=kind)
    weight = float(own["mass"] * own["strength"] / own["temperature"])
    number = float(own["density"].mean()) * float(own["top"])
    return number * ideal_profile(own["height"].values, float(own["top"]), weight)


def _percent(axis: Axes, x: np.ndarray, ratio: np.ndarray, kind: int) -> None:
    """The distance of a ratio, (2, ...) with its error, from 1 in per cent, with its zero line."""
    style.level(axis, 0.0)
    style.points(axis, x, 100.0 * (ratio[0] - 1.0), 100.0 * ratio[1], kind=kind, hollow=True, markersize=2.5)
    axis.set_ylim(-4.5, 4.5)
