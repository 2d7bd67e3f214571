"""Pressure on walls: against temperature, against density, and its deviation from theory."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.rendering import style
from gaspart.reproduction.families.shared import PARTICLES
from gaspart.reproduction.table import Table

Z = r"$P/(n k_\mathrm{B}T)$"


def wall_pressure(dataset: xr.Dataset) -> Figure:
    """Draw P/(n k T) against T and packing fraction, raw and corrected, and residuals."""
    figure, panels = style.new((2.0,), (2.4, 1.7))
    for draw, panel in zip((_temperatures, _densities, _residuals), panels, strict=True):
        draw(panel, Table(dataset, "point"))
    style.letters(*panels)
    return figure


def _temperatures(axis: Axes, table: Table) -> None:
    """Draw P / (n k T) against T where one density has several temperatures.

    Lines are theory, ideal gas.
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
    """Draw P / (n k T) by the force over the whole wall, and corrected.

    The correction is to the infinite fluid; the former is hollow, the latter filled.
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
