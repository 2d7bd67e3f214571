"""Equation of state: the compressibility factor, its residuals, and the virial coefficients fitted to it."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.rendering import style
from gaspart.reproduction.table import Table

SERIES = (2, 3, 4, 6, 10)
"""Partial sums are drawn up to these coefficients."""
REQUIRED = {2: 1e-3, 3: 1e-2, 4: 1e-1}
"""Scale of the lowest panel: the required relative accuracy of each coefficient."""
Lines = dict[str, tuple[np.ndarray, dict]]
"""Z on the grid of packing fractions, and the style of the line, by name."""


def virial_discs(dataset: xr.Dataset) -> Figure:
    """Draw Z of discs, with Henderson's equation, van der Waals's and the partial sums."""
    return _draw(dataset, "$B_{10}$ and tail", {"Henderson": theory.henderson}, ceiling=7.0, percent=0.6)


def virial_spheres(dataset: xr.Dataset) -> Figure:
    """Draw Z of spheres, with three equations of state and the partial sums.

    The equations are Carnahan and Starling's, Kolafa's and van der Waals's.
    """
    curves = {"Carnahan–Starling": theory.carnahan_starling, "Kolafa 1986": theory.kolafa_1986}
    return _draw(dataset, "Kolafa–Labík–Malijevský", curves, ceiling=11.0, percent=0.5)


def _draw(dataset: xr.Dataset, name: str, equations: dict, ceiling: float, percent: float) -> Figure:
    """Draw Z, residuals and coefficients in three panels.

    name : name of the reference.
    ceiling : top of Z's axis.
    percent : residuals' half height.
    """
    gases = Table(dataset, "packing_fraction")
    grid = np.linspace(1e-3, 1.04 * gases.packing_fraction.max(), 300)
    figure, (upper, middle, lower) = style.new((2.6, 1.7), (2.2,))
    reference = theory.compressibility_factor(grid, gases.dimension)
    lines = _equations(grid, gases.dimension, equations)
    sums = {order: theory.partial_sum(grid, order, gases.dimension) for order in SERIES}
    upper.plot(grid, reference, color=style.REFERENCE, label=name, zorder=2)
    _state(upper, gases, grid, lines, sums, ceiling)
    _residuals(middle, gases, grid, reference, lines, sums, percent)
    upper.set_xlim(0.0, grid[-1])
    _coefficients(lower, Table(dataset, "fit"))
    style.letters(upper, middle, lower)
    return figure


def _equations(grid: np.ndarray, dimension: int, equations: dict) -> Lines:
    """Return the curves of equations; Z is NaN beyond an equation's divergence."""
    limit = 0.999 / 2.0 ** (dimension - 1)
    waals = np.where(grid < limit, theory.van_der_waals(np.minimum(grid, limit), dimension), np.nan)
    lines = {"van der Waals": (waals, {"color": style.COLOURS[3], "linestyle": (0, (5, 1.5, 1, 1.5))})}
    for k, (name, equation) in enumerate(equations.items()):
        lines[name] = (equation(grid), {"color": style.COLOURS[1 + k], "linestyle": ("--", ":")[k]})
    return lines


def _shade(order: int) -> str:
    """Return the grey of a partial sum: the more terms, the darker."""
    return str(0.70 - 0.50 * SERIES.index(order) / (len(SERIES) - 1))


def _state(axis: Axes, gases: Table, grid: np.ndarray, lines: Lines, sums: dict, ceiling: float) -> None:
    for name, (curve, look) in lines.items():
        axis.plot(grid, curve, label=name, **look)
    labelled = 0.0
    for order, curve in sums.items():
        axis.plot(grid, curve, color=_shade(order), linewidth=0.8, zorder=1)
        if curve[-1] - labelled >= 0.06 * ceiling:  # or the labels of neighbours would overlap
            labelled = curve[-1]
            _name(axis, order, (grid[-1], curve[-1]), (2, 0), va="center", annotation_clip=True)
    style.points(axis, gases.packing_fraction, gases.Z.value, color=style.DATA, label="measured")
    style.label_axes(axis, y="compressibility factor $Z$", legend="upper left", ylim=(0.8, ceiling))


def _name(axis: Axes, order: int, position: tuple, apart: tuple[int, int], **options: object) -> None:
    look: dict = {"textcoords": "offset points", "color": _shade(order), **options}
    axis.annotate(f"$B_{{{order}}}$", position, xytext=apart, **look)


def _residuals(
    axis: Axes,
    gases: Table,
    grid: np.ndarray,
    reference: np.ndarray,
    lines: Lines,
    sums: dict,
    percent: float,
) -> None:
    """Draw 100 (Z / Z_reference - 1), with one standard error."""
    style.level(axis, 0.0)
    for order, curve in sums.items():
        excess = 100.0 * (curve / reference - 1.0)
        axis.plot(grid, excess, color=_shade(order), linewidth=0.8, zorder=1)
        below = np.flatnonzero(excess < -percent)
        if below.size:
            _name(axis, order, (grid[below[0]], -percent), (2, 2), va="bottom", ha="left")
    for curve, look in lines.values():
        axis.plot(grid, 100.0 * (curve / reference - 1.0), **look)
    ratio = (gases.Z + Estimate(0.0, gases.reference.error)) / gases.reference.value
    style.points(axis, gases.packing_fraction, 100.0 * (ratio - 1.0), color=style.DATA)
    labels = "packing fraction $\\eta$", "$Z/Z_\\mathrm{ref}-1$  (%)"
    style.label_axes(axis, *labels, ylim=(-percent, percent))


def _coefficients(axis: Axes, fits: Table) -> None:
    """Draw each fitted coefficient's deviation from the exact one, by fit.

    The unit is the accuracy required.
    """
    style.band(axis, -1.0, 1.0)
    style.level(axis, 0.0)
    positions = np.arange(len(fits))
    for k, (order, required) in enumerate(REQUIRED.items()):
        of_order = Table(fits.dataset.sel(order=order), "fit")
        fitted, exact = of_order.coefficient + Estimate(0.0, of_order.held_error), of_order.exact.value
        label = f"$B_{order}$ / {100 * required:g} %"
        scaled = (fitted - exact) / (required * exact)
        style.points(axis, positions + 0.22 * (k - 1), scaled, kind=k, label=label)
    # Fits that cut the series deviate widely: linear within the accuracy required, logarithmic beyond.
    axis.set_yscale("symlog", linthresh=1.0, linscale=1.0)
    axis.set(ylim=(-30.0, 30.0), xlim=(-0.6, max(positions.size, 1) - 0.4))
    axis.set_yticks([-10, -1, 0, 1, 10], ["$-10$", "$-1$", "0", "1", "10"])
    axis.minorticks_off()
    names = [f"$B_2$–$B_{fit.free}$\n$\\leq${fit.up_to:g}\n{'held' if fit.held else 'zero'}" for fit in fits]
    axis.set_xticks(positions, names)
    axis.tick_params(axis="x", length=0)
    style.label_axes(
        axis, "free coefficients, largest $\\eta$, higher coefficients", "deviation / required accuracy"
    )
    axis.legend(ncols=3, loc="upper center", columnspacing=1.0, handletextpad=0.1)
