"""Equation of state of discs and of spheres, and their virial coefficients, from periodic event-driven runs.

Units are the diameter, the mass and k_B T. Z is that of the infinite system.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import Fit, combine_estimates, fit_polynomial
from gaspart.keys import count, flag, list_of, positive, record
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts, pressure
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.scene.facts import plain_gas
from gaspart.theory.virial import HIGHEST_ORDER, linear_tail, linear_tail_uncertainty

TITLE, CHAPTER = "Equation of state", "Equation of state and structure"
_FIT = {
    "free": count("highest coefficient left free", minimum=4, maximum=9),
    "up_to": positive("largest packing fraction used"),
    "held": flag("hold the higher coefficients at their literature values"),
}
SETTINGS = {"fits": list_of(record(_FIT), "fits of the virial coefficients; the first one is claimed")}
SERIES = {"virial_discs": (2, 0.65), "virial_spheres": (3, 0.49)}
"""Figures of which the report's page computes series: dimension and largest packing fraction."""
ACCURACY = {2: 1e-3, 3: 1e-2, 4: 1e-1}
"""Required relative accuracy of each virial coefficient. Its standard error must be half of this."""
ONE = {"units": "1"}


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure Z and collision rate at each packing fraction, and fit B2, B3, B4 with each of the fits.
    `poisson_error` is the error of Z for independent collisions, `held_error` the part of a fitted
    coefficient's error that is due to held coefficients.
    """
    points = sorted(points, key=lambda point: point.scene.packing_fraction)
    gases = table("packing_fraction", points, _gas, units={}).set_coords("packing_fraction")
    gases = gases.assign_attrs(dimension=points[0].scene.dimension)
    return gases.merge(fit_table(gases, settings["fits"]), join="outer", compat="no_conflicts")


def _gas(point: Point) -> dict:
    run, gas = pressure(point), plain_gas(point.scene)
    state = gas.packing_fraction, gas.dimension
    shift = float(theory.finite_size_correction(*state, gas.count, ensemble="canonical"))
    enskog = theory.collision_rate(*state) * theory.collision_rate_finite_size_factor(*state, gas.count)
    stated = theory.compressibility_factor(*state), theory.compressibility_uncertainty(*state)
    z, collisions = run.z - shift, run.counters["collisions"]
    return {
        "packing_fraction": gas.packing_fraction,
        "Z": z,
        "finite_size": shift,
        "poisson_error": (z.value - 1.0) / math.sqrt(collisions),
        "reference": (float(stated[0]), float(stated[1])),
        "collision_rate": run.collision_rate / float(enskog),
        "replica_chi_square": run.chi_square,
        "replica_degrees_of_freedom": run.degrees_of_freedom,
        "correlation": run.correlation,
        "flat": int(run.flat),
        "collisions": collisions,
        "count": gas.count,
    }


def fit_table(dataset: xr.Dataset, choices: list[dict]) -> xr.Dataset:
    """Apply `fit_coefficients` with each choice that has a point more than free coefficients B2, B3, ..."""
    gases, dimension = Table(dataset, "packing_fraction"), dataset.attrs["dimension"]
    used = [gases[gases.packing_fraction <= choice["up_to"] * (1.0 + 1e-9)] for choice in choices]
    pairs = [pair for pair in zip(choices, used, strict=True) if len(pair[1]) >= pair[0]["free"]]
    highest = max((choice["free"] for choice, _ in pairs), default=4)
    exact, exact_error = theory.virial_coefficients(dimension, highest)
    if pairs:
        fits = table("fit", pairs, _fit, dimension, inner=("order",), units={})
    else:  # what is drawn, without a row
        none = ("fit", "order"), np.zeros((0, highest - 1))
        fits = xr.Dataset(dict.fromkeys(("coefficient", "coefficient_error", "held_error"), none))
    fits = fits.assign(exact=("order", exact[1:], ONE), exact_error=("order", exact_error[1:], ONE))
    return fits.assign_coords(order=np.arange(2, highest + 1))


def _fit(pair: tuple[dict, Table], dimension: int) -> dict:
    choice, part = pair
    free, held = choice["free"], choice["held"]
    fit, held_error = fit_coefficients(part.packing_fraction, part.Z, dimension, free, held)
    row = {"coefficient": fit.estimates, "held_error": held_error, "fit_chi_square": fit.chi_square}
    return row | {"fit_degrees_of_freedom": fit.degrees_of_freedom} | choice | {"held": int(held)}


def fit_coefficients(
    eta: np.ndarray, z: Estimate, dimension: int, free: int, held: bool
) -> tuple[Fit, np.ndarray]:
    """Fit (Z-1)/eta = b_2 + b_3 eta + ... up to b_free, and compute the errors due to held coefficients. If
    `held` is True, the higher coefficients up to B10 have their literature values, and the remaining terms
    are `virial.linear_tail`; the errors of the fit do not include theirs. Otherwise they are zero: the
    truncated series shows the effect of these terms.
    """
    powers, y = tuple(range(free - 1)), (z - 1.0) / eta
    if not held:
        return fit_polynomial(eta, y, powers=powers), np.zeros(len(powers))
    coefficients, uncertainties = theory.virial_coefficients(dimension)
    tail = linear_tail(eta, dimension) / eta
    higher = {order - 2: coefficients[order - 1] for order in range(free + 1, HIGHEST_ORDER + 1)}
    fit = fit_polynomial(eta, y - tail, powers=powers, fixed=higher)
    # The values are linear in the held terms. A separate fit gives the effect of each uncertainty.
    terms = [uncertainties[power + 1] * eta**power for power in higher]
    terms.append(linear_tail_uncertainty(eta, dimension) / eta)
    moved = [fit_polynomial(eta, term, y.error, powers=powers).values for term in terms]
    return fit, np.sqrt(np.sum(np.square(moved), axis=0))


# Sources, and the origin of their uncertainties.
REFERENCE = {
    2: (
        "virial series to B10 ([Clisby 2006]) and a linear tail",
        "of the virial coefficients ([Clisby 2006]), and the tail's distance from Liu's equation",
    ),
    3: (
        "[Kolafa 2004]",
        "its distance from the equation of etomica, or from the virial series, if less",
    ),
}
EXACT = {
    2: ("area", "exact: [source C], Eq. 48 ([Rowlinson 1964], [Hemmer 1965])"),
    3: ("volume", "exact: [Boltzmann 1899]"),
}
KOLAFA_RANGE = 0.19, 0.41  # the Carnahan-Starling equation is 0.13 to 0.3 % too low, which is resolved


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on Z, B2, B3, B4, the collision rate, error bars, and for spheres on two equations."""
    gases, fits = Table(dataset, "packing_fraction"), Table(dataset, "fit")
    dimension = gases.dimension
    source, origin = REFERENCE[dimension]
    for gas in gases:
        yield Claim(
            f"Z at packing fraction {gas.packing_fraction:.4g}", gas.Z, gas.reference,
            1e-3 * gas.reference.value, source,
            "missed or spurious contacts, wrong impulses, or a fluid that is not in equilibrium",
            allowance_source=origin,
        )  # fmt: skip
    yield Claim.joint(
        "Z at all packing fractions together", (gases.Z - gases.reference).deviation, source,
        "a bias too small for one point is common to many, or the error bars are wrong",
    )  # fmt: skip
    yield from _coefficients(fits[0], dimension) if fits else ()
    # Enskog's collision rate is as accurate as Z - 1: same reference, same uncertainty.
    enskog = Estimate(1.0, gases.reference.error / (gases.reference.value - 1.0))
    yield Claim.joint(
        "collision rate over Enskog's at all packing fractions", (gases.collision_rate - enskog).deviation,
        "Enskog's rate, exact in equilibrium, with the reference's contact value",
        "collisions are missed or counted twice, or velocities at contact are not Maxwellian",
    )  # fmt: skip
    if freedom := int(gases.replica_degrees_of_freedom.sum()):
        yield Claim.chi_square(
            claim="error bars: scatter of replicas over what their blocks predict "
            "(chi-square per degree of freedom)",
            chi_square=float(gases.replica_chi_square.sum()),
            degrees_of_freedom=freedom,
            source="independent replicas of one state have one mean",
            fails_if="blocks are too short, runs are not equilibrated, or seeds are not independent",
        )
    low, high = KOLAFA_RANGE
    chosen = gases[(gases.packing_fraction >= low) & (gases.packing_fraction <= high)]
    if dimension == 3 and chosen:
        yield _distinguish(chosen)


def _coefficients(fit: Row, dimension: int) -> Iterator[Claim]:
    held = f"B{fit.free + 1} to B10 held at literature values" if fit.held else "higher ones zero"
    size, source = EXACT[dimension]
    for row in Table(fit.dataset.sel(order=list(ACCURACY)), "order"):
        yield Claim(
            f"B{row.order} in powers of the particle's {size} "
            f"(B2 to B{fit.free} fitted up to packing fraction {fit.up_to:g}, {held})",
            row.coefficient + Estimate(0.0, row.held_error), row.exact.value,
            0.5 * ACCURACY[row.order] * row.exact.value, source,
            "Z is biased at low density, where every error of Z - 1 is an error of B2",
        )  # fmt: skip


def _distinguish(chosen: Table) -> Claim:
    """Return the claim that the mean of Z / Z_CS - 1 is that of a better equation, not 0."""
    eta, (source, origin) = chosen.packing_fraction, REFERENCE[3]
    measured, stated = (z / theory.carnahan_starling(eta) - 1.0 for z in (chosen.Z, chosen.reference))
    expected = Estimate(measured.weights @ stated.value, measured.weights @ stated.error)
    return Claim(
        f"excess of Z over Carnahan-Starling, mean of packing fractions {eta.min():.2g} to {eta.max():.2g}",
        combine_estimates(measured), expected, expected.value / 5.0, source,
        "Z is too imprecise or biased to distinguish the two equations",
        allowance_source=origin, alternative=0.0,
    )  # fmt: skip


ORDERS = (2, 3, 4, 6, 10)  # of the drawn partial sums
DASHES = "--", ":"
LOOKS: dict[int, dict[str, Any]] = {
    2: {
        "name": "$B_{10}$ and tail",
        "equations": {"Henderson": theory.henderson},
        "ceiling": 7.0,  # of Z
        "percent": 0.6,  # half height of the residuals
    },
    3: {
        "name": "Kolafa–Labík–Malijevský",
        "equations": {"Carnahan–Starling": theory.carnahan_starling, "Kolafa 1986": theory.kolafa_1986},
        "ceiling": 11.0,
        "percent": 0.5,
    },
}
Lines = list[tuple[np.ndarray, dict[str, Any]]]
"""Curves of Z on the grid of packing fractions, with the style of the line."""


def draw(dataset: xr.Dataset) -> Figure:
    """Draw Z and residuals with equations of state and partial sums, and the fitted coefficients."""
    gases = Table(dataset, "packing_fraction")
    grid, look = np.linspace(1e-3, 1.04 * gases.packing_fraction.max(), 300), LOOKS[gases.dimension]
    figure, (upper, middle, lower) = style.new((2.6, 1.7), (2.2,))
    reference = theory.compressibility_factor(grid, gases.dimension)
    lines = _equations(grid, gases.dimension, look["equations"])
    sums = {order: theory.partial_sum(grid, order, gases.dimension) for order in ORDERS}
    upper.plot(grid, reference, color=style.REFERENCE, label=look["name"], zorder=2)
    _state(upper, gases, grid, lines, sums, look["ceiling"])
    lines = [(100.0 * (curve / reference - 1.0), line) for curve, line in lines]
    sums = {order: 100.0 * (curve / reference - 1.0) for order, curve in sums.items()}
    _residuals(middle, gases, grid, lines, sums, look["percent"])
    upper.set_xlim(0.0, grid[-1])
    _draw_coefficients(lower, Table(dataset, "fit"))
    style.letters(upper, middle, lower)
    return figure


def _equations(grid: np.ndarray, dimension: int, equations: dict) -> Lines:
    limit = 0.999 / 2.0 ** (dimension - 1)  # van der Waals's equation diverges
    waals = np.where(grid < limit, theory.van_der_waals(np.minimum(grid, limit), dimension), np.nan)
    look = {"color": style.COLOURS[3], "linestyle": (0, (5, 1.5, 1, 1.5)), "label": "van der Waals"}
    lines: Lines = [(waals, look)]
    for k, (name, equation) in enumerate(equations.items()):
        look = {"color": style.COLOURS[1 + k], "linestyle": DASHES[k], "label": name}
        lines.append((equation(grid), look))
    return lines


def _state(axis: Axes, gases: Table, grid: np.ndarray, lines: Lines, sums: dict, ceiling: float) -> None:
    for curve, look in lines:
        axis.plot(grid, curve, **look)
    labelled = 0.0
    for order, curve in sums.items():
        axis.plot(grid, curve, color=_shade(order), linewidth=0.8, zorder=1)
        if curve[-1] - labelled >= 0.06 * ceiling:  # otherwise the labels of neighbours would overlap
            labelled = curve[-1]
            _name(axis, order, (grid[-1], curve[-1]), (2, 0), va="center", annotation_clip=True)
    style.points(axis, gases.packing_fraction, gases.Z.value, color=style.DATA, label="measured")
    style.label_axes(axis, y="compressibility factor $Z$", legend="upper left", ylim=(0.8, ceiling))


def _shade(order: int) -> str:
    """Return the grey level of a partial sum; more terms are darker."""
    return str(0.70 - 0.50 * ORDERS.index(order) / (len(ORDERS) - 1))


def _name(axis: Axes, order: int, position: tuple, apart: tuple[int, int], **options: object) -> None:
    look: dict = {"textcoords": "offset points", "color": _shade(order), **options}
    axis.annotate(f"$B_{{{order}}}$", position, xytext=apart, **look)


def _residuals(axis: Axes, gases: Table, grid: np.ndarray, lines: Lines, sums: dict, percent: float) -> None:
    style.level(axis, 0.0)
    for order, excess in sums.items():
        axis.plot(grid, excess, color=_shade(order), linewidth=0.8, zorder=1)
        below = np.flatnonzero(excess < -percent)
        if below.size:
            _name(axis, order, (grid[below[0]], -percent), (2, 2), va="bottom", ha="left")
    for excess, look in lines:
        axis.plot(grid, excess, **look)
    ratio = (gases.Z + Estimate(0.0, gases.reference.error)) / gases.reference.value
    style.points(axis, gases.packing_fraction, 100.0 * (ratio - 1.0), color=style.DATA)
    labels = "packing fraction $\\eta$", "$Z/Z_\\mathrm{ref}-1$  (%)"
    style.label_axes(axis, *labels, ylim=(-percent, percent))


def _draw_coefficients(axis: Axes, fits: Table) -> None:
    """Draw the deviation of each coefficient from the exact value over the required accuracy, by fit."""
    style.band(axis, -1.0, 1.0)
    style.level(axis, 0.0)
    positions = np.arange(len(fits))
    for k, (order, required) in enumerate(ACCURACY.items()):
        of_order = Table(fits.dataset.sel(order=order), "fit")
        fitted, exact = of_order.coefficient + Estimate(0.0, of_order.held_error), of_order.exact.value
        label = f"$B_{order}$ / {100 * required:g} %"
        scaled = (fitted - exact) / (required * exact)
        style.points(axis, positions + 0.22 * (k - 1), scaled, kind=k, label=label)
    # Fits of the truncated series deviate strongly: linear within the required accuracy, logarithmic beyond.
    axis.set_yscale("symlog", linthresh=1.0, linscale=1.0)
    axis.set(ylim=(-30.0, 30.0), xlim=(-0.6, max(positions.size, 1) - 0.4))
    axis.set_yticks([-10, -1, 0, 1, 10], ["$-10$", "$-1$", "0", "1", "10"])
    axis.minorticks_off()
    names = [f"$B_2$–$B_{fit.free}$\n$\\leq${fit.up_to:g}\n{'held' if fit.held else 'zero'}" for fit in fits]
    axis.set_xticks(positions, names)
    axis.tick_params(axis="x", length=0)
    labels = "free coefficients, largest $\\eta$, higher coefficients", "deviation / required accuracy"
    style.label_axes(axis, *labels)
    axis.legend(ncols=3, loc="upper center", columnspacing=1.0, handletextpad=0.1)


FIGURES = dict.fromkeys(SERIES, Parts(SETTINGS, measure, claims, draw))
