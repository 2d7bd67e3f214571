"""Pressure on walls: against temperature, against density, and its deviation from theory."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style
from gaspart.reproduction.families.shared.claims import PARTICLES
from gaspart.reproduction.families.shared.rows import estimates


def wall_pressure(ds: xr.Dataset) -> Figure:
    """Three panels: P/(n k T) against T; the same against packing fraction, raw and corrected; residuals."""
    figure, (upper, middle, lower) = style.new((2.0,), (2.4, 1.7))
    _temperatures(upper, ds)
    _densities(middle, ds)
    _residuals(lower, ds)
    style.letters(upper, middle, lower)
    return figure


def _temperatures(axis: Axes, ds: xr.Dataset) -> None:
    """P / (n k T) against T where one density has several temperatures; lines: theory, ideal gas."""
    density = ds["density"].values.round(9)
    series = [n for n in sorted(set(density)) if np.ptp(ds["temperature"].values[density == n]) > 1.0]
    for kind, n in enumerate(series):
        part = ds.isel(point=density == n).sortby("temperature")
        line = np.array([0.0, 1.1 * float(part["temperature"].max())])
        z = np.full(2, float(part["expected"][0]) / n)
        axis.plot(line, z, color=style.COLOURS[kind], zorder=1)
        style.measured(
            axis,
            part["temperature"],
            estimates(part, "pressure") / n,
            kind=kind,
            label=rf"$\eta={float(part['packing_fraction'][0]):.2g}$",
        )
    if series:
        axis.plot(line, np.ones(2), color=style.GREY, linestyle=":", label="ideal gas")
        axis.set_xlim(0.0, float(line[1]))
        axis.legend(loc="lower right")
    axis.set_ylim(bottom=0.8)
    axis.set_xlabel(r"temperature $T$")
    axis.set_ylabel(r"$P/(n k_\mathrm{B}T)$")


def _densities(axis: Axes, ds: xr.Dataset) -> None:
    """P / (n k T): the force over the whole wall (hollow), and corrected to the infinite fluid (filled)."""
    for kind, dimension in enumerate(sorted(set(ds["dimension"].values))):
        part = ds.isel(point=(ds["dimension"] == dimension).values)
        eta = part["packing_fraction"].values
        curve = np.linspace(1e-3, 1.05 * eta.max(), 200)
        name = PARTICLES[int(dimension)]
        z = theory.compressibility_factor(curve, int(dimension))
        axis.plot(curve, z, color=style.COLOURS[kind], zorder=1, label=f"{name}, bulk")
        raw = part["whole_pressure"] / part["density"]
        style.points(axis, eta, raw, kind=kind, hollow=True, label=f"{name}, $F/$wall")
        corrected = part["pressure"] / part["expected"] * part["bulk_pressure"] / part["density"]
        error = part["pressure_error"] / part["expected"] * part["bulk_pressure"] / part["density"]
        style.points(axis, eta, corrected, error, kind=kind, label=f"{name}, corrected")
    style.level(axis, 1.0)
    axis.set_ylabel(r"$P/(n k_\mathrm{B}T)$")
    axis.legend(loc="lower right")


def _residuals(axis: Axes, ds: xr.Dataset) -> None:
    """100 (P / theory - 1) of every container, with both uncertainties."""
    style.level(axis, 0.0)
    error = 100.0 * np.hypot(ds["pressure_error"], ds["expected_error"]) / ds["expected"]
    excess = 100.0 * (ds["pressure"] / ds["expected"] - 1.0)
    for kind, dimension in enumerate(sorted(set(ds["dimension"].values))):
        for slit in (True, False):
            chosen = ((ds["dimension"] == dimension) & ((ds["axes"] < dimension) == slit)).values
            if chosen.any():
                # Shifted slightly: many containers have the same packing fraction.
                eta = ds["packing_fraction"].values[chosen] + 0.003 * (0 if slit else 1)
                label = f"{PARTICLES[int(dimension)]}, {'slit' if slit else 'closed'}"
                style.points(
                    axis, eta, excess[chosen], error[chosen], kind=kind, hollow=not slit, label=label
                )
    widest = 1.2 * float(np.max(np.abs(excess) + error))
    axis.set_ylim(-widest, 1.6 * widest)
    axis.set_xlim(0.0, 0.43)
    axis.set_xlabel(r"packing fraction $\eta$ of the container")
    axis.set_ylabel(r"$P/P_\mathrm{theory}-1$  (%)")
    axis.legend(loc="upper left", ncols=2)
