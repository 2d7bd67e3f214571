"""Figures of gases under gravity: profiles against height, and the heat capacity."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart.rendering import style
from gaspart.theory.gravity import ideal_heat_capacity, ideal_profile
from gaspart.theory.state import compressibility_factor

KNOWN = 0.1
"""Relative errors up to which a bin of height is drawn: bins with larger ones hold hardly any particles."""


def barometric(ds: xr.Dataset) -> Figure:
    """Density and temperature against height, and the equation of state from the weight of the column."""
    figure, axes = style.new((2.4, 1.1, 1.1), (2.6, 1.2))
    top, ratio, warm, state, off = axes
    for kind in range(ds.sizes["point"]):
        row = ds.isel(point=kind)
        name = str(row["experiment"].values).rpartition("_")[2]
        height = row["height"].values
        density, error = (row[key].isel(species=0).values for key in ("density", "density_error"))
        mean = float(row["mean_density"])
        seen = error < KNOWN * density
        expected = _expected(row, 0)
        label = f"{name}, {'hydrostatics' if name == 'dense' else 'ideal gas'}"
        style.points(
            top, height[seen], density[seen] / mean, error[seen] / mean, kind=kind, hollow=True, label=name
        )
        top.plot(height, expected / mean, color=style.COLOURS[kind], label=label, zorder=4)
        for axis, value, bar in (
            (ratio, density / expected, error / expected),
            (warm, row["temperature_ratio"].values, row["temperature_ratio_error"].values),
        ):
            shown = seen & row["used"].values if axis is ratio else seen
            _percent(axis, height[shown], value[shown], bar[shown], kind)
    dense = ds.isel(point=-1)
    used = dense["used"].values
    eta = dense["packing_fraction"].values[used]
    line = np.linspace(0.0, 1.05 * eta.max(), 200)
    state.plot(line, compressibility_factor(line, 2), color=style.DATA, label="virial series to $B_{10}$")
    factor, bar = (dense[key].values[used] for key in ("compressibility", "compressibility_error"))
    label = "weight above / $\\rho kT$"
    style.points(state, eta, factor, bar, kind=1, hollow=True, label=label)
    _percent(off, eta, dense["pressure_ratio"].values[used], dense["pressure_ratio_error"].values[used], 1)
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
    style.letters(top, ratio, warm, state)
    return figure


def separation(ds: xr.Dataset) -> Figure:
    """Heavy and light discs: densities, dilute and dense, and the ratio of the two."""
    figure, axes = style.new((2.2,), (2.2,), (2.4, 1.2))
    names = ("light", "heavy")
    for n, axis in enumerate(axes[:2]):
        row = ds.isel(point=n)
        mean = float(row["mean_density"])
        height = row["height"].values
        for kind, name in enumerate(names):
            density, error = (row[key].isel(species=kind).values for key in ("density", "density_error"))
            seen = error < KNOWN * density
            where = (axis, height[seen], density[seen] / mean, error[seen] / mean)
            style.points(*where, kind=kind, hollow=True, label=name)
            axis.plot(height, _expected(row, kind) / mean, color=style.COLOURS[kind], zorder=4)
            if n:
                ideal = _ideal(row, kind) / mean
                axis.plot(height, ideal, color=style.COLOURS[kind], ls=":", label=f"{name} if ideal")
        axis.set_yscale("log")
        axis.set_ylim(0.01, 20.0)
        axis.set_ylabel(r"density $\rho_i/\bar\rho$")
        axis.set_xlabel("height $z$ (length)")
        axis.legend(loc="upper right", ncol=2, columnspacing=0.8)
    style.band(axes[3], -3.0, 3.0)
    style.level(axes[3], 0.0)
    for n, name in enumerate(("dilute", "dense")):
        row = ds.isel(point=n)
        error = row["log_ratio_error"].values
        seen = np.isfinite(error) & (error < 0.3)
        height, value, expected = (
            row[key].values[seen] for key in ("height", "log_ratio", "log_ratio_expected")
        )
        style.points(axes[2], height, value, error[seen], kind=2 + n, hollow=True, label=name)
        axes[2].plot(height, expected, color=style.COLOURS[2 + n], zorder=4)
        style.points(axes[3], height, (value - expected) / error[seen], kind=2 + n, markersize=2.5)
    axes[2].set_ylabel(r"$\ln(\rho_\mathrm{heavy}/\rho_\mathrm{light})$")
    axes[2].legend(loc="upper right")
    axes[3].set_ylabel(r"residual ($\sigma$)")
    axes[3].set_ylim(-4.5, 4.5)
    axes[3].set_yticks([-3, 0, 3])
    axes[3].set_xlabel("height $z$ (length)")
    for axis, title in zip(axes, ("(a) dilute", "(b) dense", "(c)"), strict=False):
        style.letter(axis, title)
    return figure


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


def _percent(axis: Axes, x: np.ndarray, ratio: np.ndarray, error: np.ndarray, kind: int) -> None:
    """A ratio's distance from 1 in per cent, with its zero line."""
    style.level(axis, 0.0)
    style.points(axis, x, 100.0 * (ratio - 1.0), 100.0 * error, kind=kind, hollow=True, markersize=2.5)
    axis.set_ylim(-4.5, 4.5)
