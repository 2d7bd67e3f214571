"""Equation of state: the compressibility factor, its residuals, and the virial coefficients fitted to it."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.rendering import style

SERIES = (2, 3, 4, 6, 10)
"""Partial sums are drawn up to these coefficients."""
REQUIRED = {2: 1e-3, 3: 1e-2, 4: 1e-1}
"""Scale of the lowest panel: the required relative accuracy of each coefficient."""


def virial_discs(dataset: xr.Dataset) -> Figure:
    """Z of discs, with Henderson's equation, van der Waals's and the partial sums."""
    return _draw(dataset, "$B_{10}$ and tail", {"Henderson": theory.henderson}, ceiling=7.0, percent=0.6)


def virial_spheres(dataset: xr.Dataset) -> Figure:
    """Z of spheres, with Carnahan and Starling's, Kolafa's, van der Waals's equation and the partial sums."""
    curves = {"Carnahan–Starling": theory.carnahan_starling, "Kolafa 1986": theory.kolafa_1986}
    return _draw(dataset, "Kolafa–Labík–Malijevský", curves, ceiling=11.0, percent=0.5)


def _draw(dataset: xr.Dataset, name: str, curves: dict, ceiling: float, percent: float) -> Figure:
    """Three panels. name: the reference's; ceiling: top of Z's axis; percent: residuals' half height."""
    dimension = int(dataset.attrs["dimension"])
    eta = dataset["packing_fraction"].values
    grid = np.linspace(1e-3, 1.04 * eta.max(), 300)
    figure, (upper, middle, lower) = style.new((2.6, 1.7), (2.2,))
    lines = _equations(grid, dimension, curves)
    reference = theory.compressibility_factor(grid, dimension)

    upper.plot(grid, reference, color=style.REFERENCE, label=name, zorder=2)
    _state(upper, dataset, grid, lines, dimension, ceiling)
    _residuals(middle, dataset, grid, reference, lines, dimension, percent)
    upper.set_xlim(0.0, grid[-1])
    _coefficients(lower, dataset)
    style.letters(upper, middle, lower)
    return figure


def _equations(grid: np.ndarray, dimension: int, curves: dict) -> dict:
    """Curves by name: Z on the grid (NaN beyond an equation's divergence), and how to draw them."""
    limit = 0.999 / 2.0 ** (dimension - 1)
    waals = np.where(grid < limit, theory.van_der_waals(np.minimum(grid, limit), dimension), np.nan)
    lines = {"van der Waals": (waals, {"color": style.COLOURS[3], "linestyle": (0, (5, 1.5, 1, 1.5))})}
    for k, (name, curve) in enumerate(curves.items()):
        lines[name] = (curve(grid), {"color": style.COLOURS[1 + k], "linestyle": ("--", ":")[k]})
    return lines


def _shade(order: int) -> str:
    """Grey of a partial sum: the more terms, the darker."""
    return str(0.70 - 0.50 * SERIES.index(order) / (len(SERIES) - 1))


def _state(
    axis: Axes,
    dataset: xr.Dataset,
    grid: np.ndarray,
    lines: dict[str, tuple[np.ndarray, dict]],
    dimension: int,
    ceiling: float,
) -> None:
    for name, (curve, look) in lines.items():
        axis.plot(grid, curve, label=name, **look)
    labelled = 0.0
    for order in SERIES:
        curve = theory.partial_sum(grid, order, dimension)
        axis.plot(grid, curve, color=_shade(order), linewidth=0.8, zorder=1)
        if curve[-1] - labelled < 0.06 * ceiling:
            continue  # the labels of neighbours would overlap
        labelled = curve[-1]
        axis.annotate(
            f"$B_{{{order}}}$", (grid[-1], curve[-1]), xytext=(2, 0), textcoords="offset points",
            va="center", color=_shade(order), annotation_clip=True,
        )  # fmt: skip
    style.points(axis, dataset["packing_fraction"], dataset["Z"], color=style.DATA, label="measured")
    axis.set_ylim(0.8, ceiling)
    axis.set_ylabel("compressibility factor $Z$")
    axis.legend(loc="upper left")


def _residuals(
    axis: Axes,
    dataset: xr.Dataset,
    grid: np.ndarray,
    reference: np.ndarray,
    lines: dict[str, tuple[np.ndarray, dict]],
    dimension: int,
    percent: float,
) -> None:
    """100 (Z / Z_reference - 1), with one standard error."""
    style.level(axis, 0.0)
    for order in SERIES:
        excess = 100.0 * (theory.partial_sum(grid, order, dimension) / reference - 1.0)
        axis.plot(grid, excess, color=_shade(order), linewidth=0.8, zorder=1)
        below = np.flatnonzero(excess < -percent)
        if below.size:
            axis.annotate(
                f"$B_{{{order}}}$", (grid[below[0]], -percent), xytext=(2, 2), textcoords="offset points",
                va="bottom", ha="left", color=_shade(order),
            )  # fmt: skip
    for curve, look in lines.values():
        axis.plot(grid, 100.0 * (curve / reference - 1.0), **look)
    measured = dataset["Z"] / dataset["reference"]
    error = 100.0 * np.hypot(dataset["Z_error"], dataset["reference_error"]) / dataset["reference"]
    style.points(axis, dataset["packing_fraction"], 100.0 * (measured - 1.0), error, color=style.DATA)
    axis.set_ylim(-percent, percent)
    axis.set_xlabel("packing fraction $\\eta$")
    axis.set_ylabel("$Z/Z_\\mathrm{ref}-1$  (%)")


def _coefficients(axis: Axes, dataset: xr.Dataset) -> None:
    """Each fitted coefficient's deviation from the exact one, in units of the accuracy required, by fit."""
    style.band(axis, -1.0, 1.0)
    style.level(axis, 0.0)
    fits = np.arange(dataset.sizes["fit"])
    for k, (order, required) in enumerate(REQUIRED.items()):
        at = dataset.sel(order=order)
        scale = required * float(at["exact"])
        error = np.hypot(at["coefficient_error"], at["held_error"]) / scale
        deviation = (at["coefficient"] - at["exact"]) / scale
        label = f"$B_{order}$ / {100 * required:g} %"
        style.points(axis, fits + 0.22 * (k - 1), deviation, error, kind=k, label=label)
    # Fits that cut the series deviate widely: linear within the accuracy required, logarithmic beyond.
    axis.set_yscale("symlog", linthresh=1.0, linscale=1.0)
    axis.set_ylim(-30.0, 30.0)
    axis.set_yticks([-10, -1, 0, 1, 10], ["$-10$", "$-1$", "0", "1", "10"])
    axis.minorticks_off()
    axis.set_xlim(-0.6, max(fits.size, 1) - 0.4)
    axis.set_xticks(fits, [_name(dataset.isel(fit=k)) for k in fits])
    axis.tick_params(axis="x", length=0)
    axis.set_ylabel("deviation / required")
    axis.set_xlabel("free coefficients, largest $\\eta$, higher coefficients")
    axis.legend(ncols=3, loc="upper center", columnspacing=1.0, handletextpad=0.1)


def _name(fit: xr.Dataset) -> str:
    higher = "held" if int(fit["held"]) else "zero"
    return f"$B_2$–$B_{int(fit['free'])}$\n$\\leq${float(fit['up_to']):g}\n{higher}"
