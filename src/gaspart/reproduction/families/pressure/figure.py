"""Figures of pressure on walls, gases behind a piston, and estimators."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import mean_of, means_of
from gaspart.rendering import style
from gaspart.reproduction.families.pressure.claims import isothermal_variance
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Row, Table

Z = r"$P/(n k_\mathrm{B}T)$"


def wall_pressure(dataset: xr.Dataset) -> Figure:
    """Draw P/(n k T) against T and packing fraction, raw and corrected, and residuals."""
    figure, panels = style.new((2.0,), (2.4, 1.7))
    for draw, panel in zip((_temperatures, _densities, _residuals), panels, strict=True):
        draw(panel, Table(dataset, "point"))
    style.letters(*panels)
    return figure


def _temperatures(axis: Axes, table: Table) -> None:
    """Draw P / (n k T) against T, at the densities that have several temperatures.

    Lines are theory and the ideal gas.
    """
    series = [(n, part) for n, part in table.by(table.density.round(9)) if np.ptp(part.temperature) > 1.0]
    for kind, (n, part) in enumerate(series):
        part = part.sorted_by("temperature")
        line = np.array([0.0, 1.1 * part.temperature.max()])
        axis.plot(line, np.full(2, part.expected.value[0] / n), color=style.COLOURS[kind], zorder=1)
        label = rf"$\eta={part.packing_fraction[0]:.2g}$"
        style.points(axis, part.temperature, part.pressure / n, kind=kind, label=label)
    if series:
        axis.plot(line, np.ones(2), color=style.GREY, linestyle=":", label="ideal gas")
        axis.set_xlim(0.0, line[1])
    axis.set_ylim(bottom=0.8)
    style.label_axes(axis, r"temperature $T$", Z, "lower right" if series else "")


def _densities(axis: Axes, table: Table) -> None:
    """Draw P / (n k T) from the force on the full wall area, and corrected.

    The correction is to the infinite fluid. Raw values are hollow, corrected values filled.
    """
    for kind, (dimension, part) in enumerate(table.by("dimension")):
        eta, name = part.packing_fraction, PARTICLES[dimension]
        curve = np.linspace(1e-3, 1.05 * eta.max(), 200)
        z = theory.compressibility_factor(curve, dimension)
        axis.plot(curve, z, color=style.COLOURS[kind], zorder=1, label=f"{name}, bulk")
        raw = part.whole_pressure / part.density
        style.points(axis, eta, raw, kind=kind, hollow=True, label=f"{name}, uncorrected")
        corrected = part.pressure / part.expected.value * part.bulk_pressure / part.density
        style.points(axis, eta, corrected, kind=kind, label=f"{name}, corrected")
    style.level(axis, 1.0)
    style.label_axes(axis, y=Z, legend="lower right")


def _residuals(axis: Axes, table: Table) -> None:
    """Draw 100 (P / theory - 1) of every container, with both uncertainties."""
    style.level(axis, 0.0)
    for kind, (dimension, part) in enumerate(table.by("dimension")):
        for closed, containers in part.by(part.axes == dimension):
            # Shifted slightly: many containers have the same packing fraction.
            eta = containers.packing_fraction + 0.003 * closed
            label = f"{PARTICLES[dimension]}, {'closed' if closed else 'slit'}"
            style.points(axis, eta, _excess(containers), kind=kind, hollow=closed, label=label)
    excess = _excess(table)
    widest = 1.2 * float(np.max(np.abs(excess.value) + excess.error))
    axis.set(ylim=(-widest, 1.6 * widest), xlim=(0.0, 0.43))
    labels = r"packing fraction $\eta$ of the container", r"$P/P_\mathrm{theory}-1$  (%)"
    style.label_axes(axis, *labels, legend="upper left", columns=2)


def _excess(table: Table) -> Estimate:
    both = table.pressure + Estimate(0.0, table.expected.error)
    return 100.0 * (both / table.expected.value - 1.0)


_DOUBLED = 2.0
"""Volume after free expansion divided by the initial volume."""
_EXPONENTS = {2: "2", 3: "5/3"}


def piston(ds: xr.Dataset) -> Figure:
    """Draw temperature along adiabats, factors at constant pressure, and volume variances."""
    figure, (upper, middle, lower) = style.new((2.6,), (1.9, 1.9))
    paths, states, gases = (Table.from_prefixed(ds, kind) for kind in ("path", "state", "expansion"))
    for path in paths:
        _draw_path(upper, path)
    for gas in gases[:1]:
        style.points(upper, _DOUBLED, mean_of(gas.speed**2), kind=4, label="free expansion")
    labels = r"volume $V/V_0$", r"temperature $T/T_0$"
    style.label_axes(upper, *labels, legend="best", xscale="log", yscale="log")
    style.level(lower, 1.0)
    for dimension, part in states.by("dimension"):
        _draw_states(middle, lower, part, dimension)
    style.label_axes(middle, y=r"$P/nk_{\mathrm{B}}T$ / reference", legend="best")
    labels = r"packing fraction $\eta$", r"variance of $V$ / theory"
    style.label_axes(lower, *labels, legend="best", xlim=(0.0, None))
    style.letters(upper, middle, lower)
    return figure


def _draw_path(axis: Axes, path: Row) -> None:
    dimension, first, kind = path.dimension, path.packing_fraction, path.dimension - 2
    volume, temperature = path.volume.mean(axis=0), Estimate(*means_of(path.temperature))
    style.points(axis, volume, temperature, kind=kind, label=PARTICLES[dimension])
    fine = np.geomspace(volume.min(), _DOUBLED, 60)
    expected = theory.adiabatic_temperature(first / fine, first, dimension)
    label = rf"adiabat, $\gamma={_EXPONENTS[dimension]}$"
    axis.plot(fine, expected, color=style.COLOURS[kind], zorder=1, label=label)


def _draw_states(middle: Axes, lower: Axes, states: Table, dimension: int) -> None:
    eta, name = np.array([state.density.mean() for state in states]), PARTICLES[dimension]
    factor = [
        mean_of(state.factor / theory.compressibility_factor(state.density, dimension)) for state in states
    ]
    variance = Estimate.stack([mean_of(state.fluctuation) for state in states])
    variance = variance * theory.speed_of_sound(eta, dimension) ** 2
    for axis, ratio in ((middle, Estimate.stack(factor)), (lower, variance)):
        style.points(axis, eta, ratio, kind=dimension - 2, label=name)
    fine, colour = np.linspace(0.0, eta.max(), 60), style.COLOURS[dimension - 2]
    finite = theory.constant_enthalpy_factor(fine, dimension, states.count[0])
    middle.plot(fine, finite, color=colour, zorder=1, label=f"{name}, finite $N$")
    isothermal = isothermal_variance(fine, dimension) * theory.speed_of_sound(fine, dimension) ** 2
    lower.plot(fine, isothermal, color=colour, linestyle="--", label=f"{name}, constant $T$")


def estimators(dataset: xr.Dataset) -> Figure:
    """Draw the relative run length that other estimators need, against packing fraction.

    These estimators are counts in all bins, counts at walls, and impulses of walls alone.
    """
    figure, axes = style.new((2.0, 2.0), (2.0,))
    everywhere, at_walls, pressure = axes
    cases = Table(dataset, "case")
    for kind, (width, rows) in enumerate(cases.by("width")):
        rows = rows.sorted_by("packing_fraction")
        name = f"bins of {width:g} diameters"
        for axis, ratio in ((everywhere, rows.mixture), (at_walls, rows.at_walls)):
            style.points(axis, rows.packing_fraction, ratio, kind=kind, label=name)
    once = cases[cases.width == cases.width.min()].sorted_by("packing_fraction")
    style.points(pressure, once.packing_fraction, once.pressure, kind=0, label="both walls")
    for axis, where in zip(axes, ("all bins", "bins at the walls", "pressure"), strict=True):
        style.level(axis, 1.0)
        axis.set_yscale("log")
        style.label_axes(axis, "packing fraction", f"variance ratio, {where}", legend="upper right")
    style.letters(*axes)
    return figure
