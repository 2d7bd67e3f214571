"""Figures of the equation of state, several radii, and published values."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.rendering import style
from gaspart.reproduction.families.equation_of_state.claims import EQUILIBRIUM
from gaspart.reproduction.table import Table

SERIES = (2, 3, 4, 6, 10)
"""Orders of the drawn partial sums of the virial series."""
REQUIRED = {2: 1e-3, 3: 1e-2, 4: 1e-1}
"""Required relative accuracy of each coefficient; it scales the lowest panel."""
Lines = dict[str, tuple[np.ndarray, dict]]
"""Curves by name: Z on the grid of packing fractions, and the style of the line."""


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
    percent : half height of the panel of residuals, in per cent.
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
    """Return the curves of equations of state; Z is NaN beyond a divergence."""
    limit = 0.999 / 2.0 ** (dimension - 1)
    waals = np.where(grid < limit, theory.van_der_waals(np.minimum(grid, limit), dimension), np.nan)
    lines = {"van der Waals": (waals, {"color": style.COLOURS[3], "linestyle": (0, (5, 1.5, 1, 1.5))})}
    for k, (name, equation) in enumerate(equations.items()):
        lines[name] = (equation(grid), {"color": style.COLOURS[1 + k], "linestyle": ("--", ":")[k]})
    return lines


def _shade(order: int) -> str:
    """Return the grey level of a partial sum; more terms are darker."""
    return str(0.70 - 0.50 * SERIES.index(order) / (len(SERIES) - 1))


def _state(axis: Axes, gases: Table, grid: np.ndarray, lines: Lines, sums: dict, ceiling: float) -> None:
    for name, (curve, look) in lines.items():
        axis.plot(grid, curve, label=name, **look)
    labelled = 0.0
    for order, curve in sums.items():
        axis.plot(grid, curve, color=_shade(order), linewidth=0.8, zorder=1)
        if curve[-1] - labelled >= 0.06 * ceiling:  # otherwise the labels of neighbours would overlap
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
    """Draw the deviation of each fitted coefficient from the exact value, by fit.

    The unit is the required accuracy.
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
    # Fits of the truncated series deviate strongly. The scale is linear within the required accuracy, and
    # logarithmic beyond.
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


RADIUS_SERIES = ("packing fraction", "count")
RADIUS = "radius (container: side 16)"


def radius_grid(dataset: xr.Dataset) -> Figure:
    """Draw Z, its residuals, and counted operations, against the radius."""
    figure, (upper, middle, lower) = style.new((2.2, 1.2), (2.8,))
    table = Table(dataset, "point").sorted_by("radius")
    event, step = (table[table.engine == name] for name in ("event", "step"))
    style.band(middle, -3.0, 3.0)
    style.level(middle, 0.0)
    widest = 0.0
    for kind, name in enumerate(RADIUS_SERIES):
        own = event[event.series == name]
        _draw_z_of_radii(upper, own, kind, name)
        deviation = own.Z - own.reference
        sigmas = deviation.value / deviation.error
        widest = max(widest, *np.abs(sigmas))
        style.points(middle, own.radius, sigmas, np.ones(sigmas.size), kind=kind)
        _event_costs(lower, own, kind)
        _step_costs(lower, step[step.series == name], kind)
    style.label_axes(upper, y="compressibility factor $Z$", legend="upper left")
    half = max(4.0, widest + 1.5)
    style.label_axes(middle, RADIUS, "$(Z-Z_\\mathrm{ref})/\\sigma$", ylim=(-half, half))
    style.label_axes(lower, RADIUS, "counted work", yscale="log", ylim=(0.2, 6e2))
    _labels(lower, event, step)
    style.letters(upper, middle, lower)
    return figure


def _draw_z_of_radii(axis: Axes, own: Table, kind: int, name: str) -> None:
    radius, eta = own.radius, own.packing_fraction
    if name == "count":
        label = f"$N={own.count[0]:.0f}$, $\\eta$ = {eta.min():.2g} – {eta.max():.2g}"
    else:
        label = f"$\\eta={eta[0]:g}$, $N$ = {own.count.min():.0f} – {own.count.max():.0f}"
    style.points(axis, radius, own.Z, kind=kind, label=label)
    fine = np.linspace(radius[0], radius[-1], 200)
    # At constant particle number and container, the packing fraction is proportional to the radius cubed.
    between = eta[0] * (fine / radius[0]) ** 3 if name == "count" else np.full(fine.size, eta[0])
    axis.plot(fine, theory.compressibility_factor(between, 3), color=style.COLOURS[kind])


def _event_costs(axis: Axes, own: Table, kind: int) -> None:
    """Draw counts as circles or squares, crossings as hollow symbols, with kinetic theory."""
    style.points(axis, own.radius, own.pair_tests, kind=kind)
    style.points(axis, own.radius, own.crossings_counted, kind=kind, hollow=True)
    axis.plot(own.radius, own.crossings_expected, color=style.COLOURS[kind])


def _step_costs(axis: Axes, own: Table, kind: int) -> None:
    style.points(axis, own.radius, own.pair_tests, kind=kind, marker="x")
    axis.plot(own.radius, own.pair_tests_expected, color=style.COLOURS[kind], linestyle="--")


def _labels(axis: Axes, event: Table, step: Table) -> None:
    """Write the name of the counted quantity above each group of points."""
    highest = 1.2 * event.pair_tests.max()
    texts = {
        "event-driven: pair tests per collision": highest,
        "time-stepped: pair tests per particle and step": min(1.25 * step.pair_tests.max(), 0.4 * highest),
        "event-driven: boundaries crossed per collision": 0.23,
    }
    for text, height in texts.items():
        axis.text(0.97, height, text, transform=axis.get_yaxis_transform(), ha="right", va="bottom")


LABELS = {
    "Z": "$Z$, fluid of spheres",
    "Z_crystal": "$Z$, crystal of spheres",
    "pressure": "$P$, 870 discs",
    "diffusion": "$D$ of spheres",
    "viscosity": "viscosity of spheres",
    "conductivity": "heat conductivity of spheres",
}


def literature(dataset: xr.Dataset) -> Figure:
    """Draw ratios to published values minus 1, for pressures and transport coefficients."""
    figure, (static, transport) = style.new((2.4,), (2.4,))
    values = Table(dataset, "value")
    for axis, is_static in ((static, True), (transport, False)):
        _ratios(axis, values[[(quantity in EQUILIBRIUM) == is_static for quantity in values.quantity]])
    style.letters(static, transport)
    return figure


def _ratios(axis: Axes, values: Table) -> None:
    """Draw our values as points with errors, and published values as wide pale bars."""
    style.level(axis, 0.0)
    for kind, (name, label) in enumerate(LABELS.items()):
        part = values[values.quantity == name]
        if not part:
            continue
        eta, theirs = part.packing_fraction, part.theirs.value
        error = 100.0 * part.theirs.error / theirs
        axis.errorbar(
            eta,
            0.0 * eta,
            error,
            linestyle="none",
            color=style.COLOURS[kind],
            elinewidth=4.0,
            capsize=0.0,
            alpha=0.35,
        )
        style.points(axis, eta, 100.0 * (part.ours / theirs - 1.0), kind=kind, label=label)
    style.label_axes(axis, r"packing fraction $\eta$", "ours / published $-1$  (%)", legend="best")
