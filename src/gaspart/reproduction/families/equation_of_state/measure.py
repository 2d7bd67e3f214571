r"""Measurements of the equation of state, several radii, and published values.

The first part measures the equation of state and its virial coefficients, from periodic event-driven runs.

The second part measures cost and Z at several radii. Either the packing fraction or the number of particles
is constant.

The following counts are predicted, for N particles in a periodic container of side L, with n boxes of width w
= L/n per side:

- crossings of the boundaries between boxes, per particle and time. Kinetic theory predicts exactly
  :math:`d\, \langle |v_x| \rangle (n-1)/L = d \sqrt{2 k_B T / (\pi m)}\,(n-1)/(n w)`. The factor
  n - 1 occurs because the periodic face, one of the n boundaries of an axis, is counted separately.
- pair tests of the time-stepped engine, per particle and step. Each pair in neighbouring boxes is tested
  once. The number is half the number of other particles in the 3^d boxes around a particle. Let f be the
  fraction of the volume in these boxes, and S = S(0) the structure factor at zero wave number,
  :math:`1/S = d(\eta Z)/d\eta`. The prediction is :math:`\tfrac12 [f N + (S - 1) - f S]`. The integral
  :math:`\rho \int (g - 1) = S - 1` represents the hole around a particle. The term -f S compensates for it,
  because the number of particles is fixed. The prediction holds if the range of correlations is below w.
- counts per collision. They depend only on the packing fraction and the boxes per particle, because a larger
  radius is a change of the unit of length. There are small corrections of order 1/N, and of order 1/n at the
  periodic faces.

The third part compares our values for spheres and discs with published values of other programs.

Units are the diameter, the mass and k_B T. Values are for the infinite system if the effect of finite size is
known accurately enough. Otherwise both are for the same particle number in the same container.
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
    """Measure Z against packing fraction for one dimension, and fit B2, B3, B4.

    Reference values are added. The setting is `fits`, a list of mappings with the keys `free`, the highest
    free coefficient, `up_to`, the largest packing fraction in the fit, and `held` (see `fit_coefficients`).
    The first of them is claimed.

    Variables over `packing_fraction` (ascending):

    Z : compressibility factor with its error, for the infinite system; -finite_size, of order 1/N, is added
    poisson_error : (Z-1)/sqrt(collisions)
    reference : reference value of Z, with its error
    collision_rate : collision rate with its error, divided by Enskog's rate for N particles
    replica_chi_square, replica_degrees_of_freedom : chi-square of replicas about their mean
    correlation : autocorrelation time in samples
    flat : 1 if all block errors reached a plateau
    collisions, count : number of measured collisions, and of particles

    The variable `coefficient`, over `fit` and `order`, is the fitted coefficient with its error, in powers of
    the packing fraction; NaN for coefficients that were not free. It also has held_error. Over `order` is
    `exact` with its error. Over `fit` are free, up_to, held, fit_chi_square and fit_degrees_of_freedom.
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
    """Apply `fit_coefficients` with each choice that has enough points."""
    gases, dimension = Table(dataset, "packing_fraction"), dataset.attrs["dimension"]
    used = [gases[gases.packing_fraction <= choice["up_to"] * (1.0 + 1e-9)] for choice in choices]
    pairs = [
        (choice, part)
        for choice, part in zip(choices, used, strict=True)
        if len(part) >= choice["free"]  # one point more than the number of free coefficients B2 ... B_free
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
    """Fit (Z-1)/eta = b_2 + b_3 eta + ... with weights; b_2 ... b_free are free.

    If `held` is True, the higher coefficients up to B10 have their literature values, and the remaining terms
    are `theory.linear_tail`. Otherwise the higher coefficients are zero: the truncated series shows the
    effect of these terms.

    Returns the Fit (values b_2 ... b_free), and held_error (free - 1,). The latter are standard errors due to
    the uncertainty of the held coefficients. The errors of the fit do not include them.
    """
    powers, y = tuple(range(free - 1)), (z - 1.0) / eta
    if not held:
        return fit_polynomial(eta, y, powers=powers), np.zeros(len(powers))
    coefficients, uncertainties = theory.virial_coefficients(dimension)
    tail = theory.linear_tail(eta, dimension) / eta
    higher = {order - 2: coefficients[order - 1] for order in range(free + 1, theory.HIGHEST_ORDER + 1)}
    fit = fit_polynomial(eta, y - tail, powers=powers, fixed=higher)
    # The values are linear in the held terms. A separate fit gives the effect of each held term's
    # uncertainty.
    terms = [uncertainties[power + 1] * eta**power for power in higher]
    terms.append(linear_tail_uncertainty(eta, dimension) / eta)
    moved = [fit_polynomial(eta, term, y.error, powers=powers).values for term in terms]
    return fit, np.sqrt(np.sum(np.square(moved), axis=0))


def radius_grid(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure Z and counted operations of periodic points, of both engines.

    If the points of an experiment have equal packing fractions, they are the series "packing fraction", else
    "count".

    Variables over `point`, NaN if they do not apply:

    series, engine : series, and "event" or "step"
    radius, count, packing_fraction, boxes_per_side : properties of the gas and of the partition
    Z, Z_error, finite_size : of event-driven points, corrected to the infinite system
    reference : of event-driven points, reference value of Z with its error
    crossings : of event-driven points, crossings per particle and time divided by kinetic theory, with error
    pair_tests, box_visits, crossings_counted : of event-driven points, counts per collision
    crossings_expected : of event-driven points, crossings per collision by kinetic theory and Enskog's rate
    pair_tests, box_visits, pair_tests_expected : of time-stepped points, counts per particle and step
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
    """Compute the crossings per particle and time, divided by kinetic theory."""
    between = scene.dimension * (per_side - 1) / scene.container.lengths[0] * math.sqrt(2.0 / math.pi)
    between *= scene.count
    ratios = [
        series.counters["crossings"] / (series.interval * between * series.speed) for series in replicas
    ]
    return average([correlated_mean(ratio).estimate for ratio in ratios])


def crossings_per_collision(packing_fraction: float, width: float, per_side: int, dimension: int) -> float:
    """Compute the number of crossed boundaries between boxes for each collision.

    The width w of a box is in diameters. The number is 2 d sqrt(2 / pi) (n - 1) / (n w nu). Here nu is
    Enskog's collision rate of a particle with k_B T = m = sigma = 1.
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
"""Containers of our points, with their names in `theory.literature`."""
SAME = 1e-8
"""Largest difference between two packing fractions that count as equal, to nine digits."""
STRETCH = 0.3, 1.0
"""Times between which the published slopes of Einstein's expressions were measured; here, the mean of the
integrals."""
FLUXES = {"viscosity": "shear", "conductivity": "heat"}


def literature(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure each quantity for which there are published values.

    The settings are `judged`, experiments whose values have claims here. Claims on other values belong to
    their figures. Variables over `value` are quantity (see `theory.literature`), packing_fraction, count and
    judged; `ours` and `theirs` with their errors; and the source of `theirs`. Both values of Z are for the
    infinite system, to first order in 1/N. `theirs` is the mean of all runs at the packing fraction, weighted
    by their errors. Other quantities are for `count` particles. D is for particles with zero total momentum.
    Viscosity and conductivity are means of the integral over `STRETCH`.
    """
    values = [(point, row) for point in points for row in _values(point)]
    rows = [row | {"judged": int(point.experiment in settings["judged"])} for point, row in values]
    return table("value", rows, dict, units={}, of=[point for point, _ in values])


def _values(point: Point) -> Iterator[dict[str, Any]]:
    """Yield the values of a point that have published counterparts."""
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
    """Return the published values at this packing fraction in such a container."""
    rows = theory.literature(quantity, gas.dimension)
    same = np.abs(rows.packing_fraction - gas.packing_fraction) < SAME
    return rows[same & (rows.container == CONTAINERS[gas.dimension])]


def _of_infinite_system(point: Point, gas: Gas) -> Iterator[dict[str, Any]]:
    """Yield Z of a fluid or a crystal of spheres.

    Our Z is canonical (see `analysis.series.compressibility`). The published Z is for fixed energy and
    momentum, which does not shift Z of a crystal to first order. The next order of our Z in V / V_c - 1 is
    unknown, and is part of its error.
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
    """Compute the quantities of a point for a finite particle number, by name."""
    if gas.dimension == 2:
        return {"pressure": gas.packing_fraction * 4.0 / np.pi * pressure(point).z}
    if point.settings.get("stress"):
        return {quantity: _coefficient(point, flux) for quantity, flux in FLUXES.items()}
    return {"diffusion": (1.0 - 1.0 / gas.count) * spheres(point)["diffusion"]}


def _coefficient(point: Point, flux: str) -> Estimate:
    """Measure a transport coefficient by the mean of the Green-Kubo integral in `STRETCH`."""
    samples: list[float] = []
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            run = Run(point.scene, trajectory["time"].values, trajectory)
            lags = trajectory["lag"].values
            inside = mask_between(lags + 0.5 * (lags[1] - lags[0]), *STRETCH)
            samples += list(green_kubo(run, flux)[:, inside].mean(axis=1))
    return mean_of(samples)
