r"""Measurements of the equation of state, several radii, and values of others.

The equation of state and its virial coefficients, from periodic event-driven runs.

Cost and Z at several radii, for one packing fraction and one number of particles.

Predicted counts (periodic container of side L, n boxes of width w = L/n a side, N particles):

- crossings of the boundaries between boxes, per particle and time, from kinetic theory (exact):
  :math:`d\, \langle |v_x| \rangle (n-1)/L = d \sqrt{2 k_B T / (\pi m)}\,(n-1)/(n w)`, since the periodic face
  of the container, one of the n boundaries of an axis, is counted apart;
- the time-stepped engine's pair tests per particle and step, each pair in neighbouring boxes once: half
  of the other particles in the 3^d boxes around a particle, which hold the fraction f of the volume:
  :math:`\tfrac12 [f N + (S - 1) - f S]`, S = S(0) the structure factor at zero wave number,
  :math:`1/S = d(\eta Z)/d\eta`: :math:`\rho \int (g - 1) = S - 1` is the hole that a particle makes around
  itself, and -f S what the others make up for because their number is fixed. Holds if correlations end
  within w;
- per collision, everything depends on the packing fraction and the boxes per particle alone: a larger
  radius in the same container is the same gas magnified. There remain terms of order 1/N, and of order
  1/n at the periodic faces.

Our values of spheres and discs, with values measured by programs of others.

They are in units of the diameter, the mass and k_B T, and of the infinite system where the law of finite
numbers is known to the accuracy of both, else of as many particles in the same container.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.motion import mask_between
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import (
    Fit,
    average,
    combine_estimates,
    correlated_mean,
    fit_polynomial,
    mean_of,
)
from gaspart.analysis.transport import green_kubo
from gaspart.reproduction.families.motion.measure import spheres
from gaspart.reproduction.families.shared.runs import Series, combine, pressure, runs, series_of, totals
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table
from gaspart.scene.gas import Gas, plain_gas
from gaspart.scene.scene import Scene
from gaspart.theory.virial import linear_tail_uncertainty
from gaspart.trajectory.reading import open_trajectory

ONE = {"units": "1"}


def equation_of_state(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure Z against packing fraction of one dimension, and fit B2, B3, B4.

    The reference is added.

    The setting is `fits`, a list of mappings {free: highest coefficient left free, up_to: largest packing
    fraction used, held: bool} (see `fit_coefficients`), the first of them being the one that is claimed.

    Returns over `packing_fraction` (ascending): Z with its error, corrected to the infinite system by adding
    -finite_size, which is of first order in 1/N; poisson_error, (Z-1)/sqrt(collisions); reference with its
    error; collision_rate with its error, over Enskog's for N particles; replica_chi_square, of replicas about
    their mean, and replica_degrees_of_freedom; correlation, the autocorrelation time in samples; flat, 1 if
    all block errors reached a plateau; collisions, the measured ones; count. Over `fit` and `order`:
    coefficient with its error (in powers of the packing fraction; NaN where it was not free), and held_error;
    over `order`: exact with its error; over `fit`: free, up_to, held, fit_chi_square, fit_degrees_of_freedom.
    """
    points = sorted(points, key=lambda point: point.scene.packing_fraction)
    gases = table("packing_fraction", points, _gas, units={}).set_coords("packing_fraction")
    gases = gases.assign_attrs(dimension=points[0].scene.dimension)
    return gases.merge(fit_table(gases, settings["fits"]), join="outer", compat="no_conflicts")


virial_discs = virial_spheres = equation_of_state


def _gas(point: Point) -> dict:
    run, gas = pressure(point), plain_gas(point.scene)
    state = gas.packing_fraction, gas.dimension
    shift = float(theory.finite_size_correction(*state, gas.count, ensemble="canonical"))
    enskog = theory.collision_rate(*state) * theory.collision_rate_finite_size_factor(*state, gas.count)
    z, collisions = run.z - shift, run.counters["collisions"]
    return {
        "packing_fraction": gas.packing_fraction,
        "Z": z,
        "finite_size": shift,
        "poisson_error": (z.value - 1.0) / math.sqrt(collisions),
        "reference": (
            float(theory.compressibility_factor(*state)),
            float(theory.compressibility_uncertainty(*state)),
        ),
        "collision_rate": run.collision_rate / float(enskog),
        "replica_chi_square": run.chi_square,
        "replica_degrees_of_freedom": run.degrees_of_freedom,
        "correlation": run.correlation,
        "flat": int(run.flat),
        "collisions": collisions,
        "count": gas.count,
    }


def fit_table(dataset: xr.Dataset, choices: list[dict]) -> xr.Dataset:
    """Apply `fit_coefficients` with every choice; leave out choices with too few points."""
    gases, dimension = Table(dataset, "packing_fraction"), dataset.attrs["dimension"]
    used = [gases[gases.packing_fraction <= choice["up_to"] * (1.0 + 1e-9)] for choice in choices]
    pairs = [
        (choice, part)
        for choice, part in zip(choices, used, strict=True)
        if len(part) >= choice["free"]  # one point more than the free coefficients B2 ... B_free
    ]
    highest = max((choice["free"] for choice, _ in pairs), default=4)
    exact, exact_error = theory.virial_coefficients(dimension, highest)
    fits = table("fit", pairs, _fit, dimension, inner=("order",), units={}) if pairs else _no_fits(highest)
    fits = fits.assign(exact=("order", exact[1:], ONE), exact_error=("order", exact_error[1:], ONE))
    return fits.assign_coords(order=np.arange(2, highest + 1))


def _fit(pair: tuple[dict, Table], dimension: int) -> dict:
    choice, part = pair
    z, eta = part.Z, part.packing_fraction
    fit, held_error = fit_coefficients(eta, z, dimension, choice["free"], choice["held"])
    return {
        "coefficient": fit.estimates,
        "held_error": held_error,
        "fit_chi_square": fit.chi_square,
        "fit_degrees_of_freedom": fit.degrees_of_freedom,
        "free": choice["free"],
        "up_to": choice["up_to"],
        "held": int(choice["held"]),
    }


def _no_fits(highest: int) -> xr.Dataset:
    """Return the columns that are drawn, without a row."""
    names = ("coefficient", "coefficient_error", "held_error")
    return xr.Dataset({name: (("fit", "order"), np.zeros((0, highest - 1))) for name in names})


def fit_coefficients(
    eta: np.ndarray, z: Estimate, dimension: int, free: int, held: bool
) -> tuple[Fit, np.ndarray]:
    """Fit (Z-1)/eta = b_2 + b_3 eta + ... by weights, with b_2 ... b_free free.

    If `held`, the higher coefficients, to B10, are held at their literature values and the terms beyond at
    `theory.linear_tail`; otherwise they are taken as zero (the series is cut), which shows what they matter.

    Returns the Fit (values b_2 ... b_free) and held_error (free - 1,): the standard errors that the
    uncertainty of what is held brings with it, which the fit's own errors do not contain.
    """
    powers, y = tuple(range(free - 1)), (z - 1.0) / eta
    if not held:
        return fit_polynomial(eta, y, powers=powers), np.zeros(len(powers))
    coefficients, uncertainties = theory.virial_coefficients(dimension)
    tail = theory.linear_tail(eta, dimension) / eta
    higher = {order - 2: coefficients[order - 1] for order in range(free + 1, theory.HIGHEST_ORDER + 1)}
    fit = fit_polynomial(eta, y - tail, powers=powers, fixed=higher)
    # The values are linear in what is held, so each held term's uncertainty moves them by its own fit.
    terms = [uncertainties[power + 1] * eta**power for power in higher]
    terms.append(linear_tail_uncertainty(eta, dimension) / eta)
    moved = [fit_polynomial(eta, term, y.error, powers=powers).values for term in terms]
    return fit, np.sqrt(np.sum(np.square(moved), axis=0))


def radius_grid(points: list[Point], settings: dict) -> xr.Dataset:
    """Return Z and the counted work of periodic points, of both engines.

    An experiment whose points have one packing fraction is the series "packing fraction", else "count".

    Returns over `point`: series, engine ("event" or "step"), radius, count, packing_fraction, boxes_per_side.
    Event-driven points: Z, Z_error (corrected to the infinite system), finite_size, reference and its error;
    crossings, per particle and time over the kinetic theory's, and its error; pair_tests, box_visits and
    crossings_counted, per collision; crossings_expected, the same from kinetic theory and Enskog's rate.
    Time-stepped points: pair_tests and box_visits per particle and step, pair_tests_expected. NaN elsewhere.
    """
    experiments = {point.experiment for point in points}
    fixed = {
        name: len({round(p.scene.packing_fraction, 9) for p in points if p.experiment == name}) == 1
        for name in experiments
    }
    series = ["packing fraction" if fixed[point.experiment] else "count" for point in points]
    return table("point", points, _row).assign(
        series=("point", series),
        engine=("point", [point.settings.get("engine", "event") for point in points]),
    )


def _row(point: Point) -> dict[str, Any]:
    scene, engine = point.scene, point.engine
    per_side = getattr(engine, "boxes_per_side", None)
    assert isinstance(per_side, tuple), "every point of this figure gives its boxes"
    eta, dimension = scene.packing_fraction, scene.dimension
    row: dict[str, Any] = {
        "radius": scene.largest_radius,
        "count": scene.count,
        "packing_fraction": eta,
        "boxes_per_side": per_side[0],
    }
    replicas = [series_of(run) for run in runs(point)]
    counted = totals(replicas)
    if point.settings.get("engine") == "step":
        searches = counted["steps"] * scene.count
        return row | {
            "pair_tests": counted["pair_tests"] / searches,
            "box_visits": counted["box_visits"] / searches,
            "pair_tests_expected": expected_pair_tests(scene.count, per_side[0], eta, dimension),
        }
    z = combine(replicas).z
    shift = float(theory.finite_size_correction(eta, dimension, scene.count, ensemble="canonical"))
    width = scene.container.lengths[0] / per_side[0] / (2.0 * scene.largest_radius)
    return row | {
        "Z": z - shift,
        "crossings": _crossings(replicas, scene, per_side[0]),
        "finite_size": shift,
        "reference": (
            float(theory.compressibility_factor(eta, dimension)),
            float(theory.compressibility_uncertainty(eta, dimension)),
        ),
        "collisions": counted["collisions"],
        "pair_tests": counted["pair_tests"] / counted["collisions"],
        "box_visits": counted["box_visits"] / counted["collisions"],
        "crossings_counted": counted["crossings"] / counted["collisions"],
        "crossings_expected": crossings_per_collision(eta, width, per_side[0], dimension),
    }


def _crossings(replicas: list[Series], scene: Scene, per_side: int) -> Estimate:
    """Compute crossings per particle and time over the kinetic theory's."""
    between = scene.dimension * (per_side - 1) / scene.container.lengths[0] * math.sqrt(2.0 / math.pi)
    between *= scene.count
    ratios = [
        series.counters["crossings"] / (series.interval * between * series.speed) for series in replicas
    ]
    return average([correlated_mean(ratio).estimate for ratio in ratios])


def crossings_per_collision(packing_fraction: float, width: float, per_side: int, dimension: int) -> float:
    """Compute the crossed boundaries between boxes for each collision.

    The width of a box is in diameters. It is 2 d sqrt(2 / pi) (n - 1) / (n w nu), nu Enskog's rate of one
    particle with k_B T = m = sigma = 1.
    """
    rate = float(theory.collision_rate(packing_fraction, dimension))
    return 2.0 * dimension * math.sqrt(2.0 / math.pi) * (per_side - 1) / (per_side * width * rate)


def expected_pair_tests(count: int, per_side: int, packing_fraction: float, dimension: int) -> float:
    """Compute the pair tests per particle and step of the time-stepped engine.

    The container is periodic (see the module).
    """
    share = (3.0 / per_side) ** dimension if per_side > 3 else 1.0
    compressibility = float(theory.reduced_compressibility(packing_fraction, dimension))
    return 0.5 * (share * count + (compressibility - 1.0) - share * compressibility)


CONTAINERS = {2: "29 x 30", 3: "cube"}
"""Containers of our points, as `theory.literature` names them."""
SAME = 1e-8
"""Largest difference of two packing fractions that are the same in nine digits."""
STRETCH = 0.3, 1.0
"""Times between which others have taken the slope of Einstein's expressions, the mean of the integrals."""
FLUXES = {"viscosity": "shear", "conductivity": "heat"}


def literature(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure each value that others have measured too.

    The settings are `judged`, experiments whose values have claims of their own; other values are judged by
    their figures. Over `value` are quantity (see `theory.literature`), packing_fraction, count, judged; ours
    and theirs with their errors; source of theirs. Z of both holds for the infinite system, to first order in
    1/N; theirs is the mean of all runs at the packing fraction, weighted by their errors. Of the other
    quantities both hold for `count` particles; D holds for particles whose total momentum is zero, and
    viscosity and conductivity are means of the integral over `STRETCH`.
    """
    values = [(point, row) for point in points for row in _values(point)]
    rows = [row | {"judged": int(point.experiment in settings["judged"])} for point, row in values]
    return table("value", rows, dict, units={}, of=[point for point, _ in values])


def _values(point: Point) -> Iterator[dict[str, Any]]:
    """Yield the values of a point that others have measured, if any."""
    gas = plain_gas(point.scene)
    if gas.dimension == 3 and not {"displacements", "stress"} & set(point.settings):
        yield from _of_infinite_system(point, gas)
        return
    for quantity, ours in _of_as_many(point, gas).items():
        published = _literature_values(gas, quantity)
        for row in published[published.count == gas.count]:
            yield _literature_row(
                gas, quantity, ours, Estimate(float(row.value), float(row.error)), str(row.source)
            )


def _literature_row(gas: Gas, quantity: str, ours: Estimate, theirs: Estimate, source: str) -> dict[str, Any]:
    return {
        "quantity": quantity,
        "dimension": gas.dimension,
        "packing_fraction": gas.packing_fraction,
        "count": gas.count,
        "ours": ours,
        "theirs": theirs,
        "source": source,
    }


def _literature_values(gas: Gas, quantity: str) -> np.recarray:
    """Return the values of others at this packing fraction in such a container."""
    rows = theory.literature(quantity, gas.dimension)
    same = np.abs(rows.packing_fraction - gas.packing_fraction) < SAME
    return rows[same & (rows.container == CONTAINERS[gas.dimension])]


def _of_infinite_system(point: Point, gas: Gas) -> Iterator[dict[str, Any]]:
    """Yield Z of a fluid or a crystal of spheres.

    Our Z is canonical (see `analysis.series.compressibility`), the other Z is at a fixed energy and momentum,
    by which a crystal is not shifted to first order; the next order in V / V_c - 1 of ours is not known, and
    part of its error.
    """
    eta = gas.packing_fraction
    fluid = eta <= theory.HIGHEST_PACKING_FRACTION[3]
    quantity = "Z" if fluid else "Z_crystal"
    published = _literature_values(gas, quantity)
    if not len(published):
        return
    z = pressure(point).z
    if fluid:
        shift = Estimate(float(theory.finite_size_correction(eta, 3, gas.count, ensemble="canonical")))
        shifts = np.array([theory.finite_size_correction(eta, 3, int(count)) for count in published["count"]])
    else:
        first = float(theory.crystal_finite_size_correction(z.value, gas.count))
        shift = Estimate(first, abs(first) * (theory.CLOSE_PACKING[3] / eta - 1.0))
        shifts = np.zeros(len(published))
    theirs = combine_estimates(Estimate(published.value - shifts, published.error))
    yield _literature_row(gas, quantity, z - shift, theirs, str(published.source[0]))


def _of_as_many(point: Point, gas: Gas) -> dict[str, Estimate]:
    """Compute the quantities of a point of finite numbers, by name."""
    if gas.dimension == 2:
        return {"pressure": gas.packing_fraction * 4.0 / np.pi * pressure(point).z}
    if point.settings.get("stress"):
        return {quantity: _coefficient(point, flux) for quantity, flux in FLUXES.items()}
    return {"diffusion": (1.0 - 1.0 / gas.count) * spheres(point)["diffusion"]}


def _coefficient(point: Point, flux: str) -> Estimate:
    """Measure a transport coefficient by the mean of Green and Kubo's integral in `STRETCH`."""
    samples: list[float] = []
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            run = Run(point.scene, trajectory["time"].values, trajectory)
            lags = trajectory["lag"].values
            inside = mask_between(lags + 0.5 * (lags[1] - lags[0]), *STRETCH)
            samples += list(green_kubo(run, flux)[:, inside].mean(axis=1))
    return mean_of(samples)
