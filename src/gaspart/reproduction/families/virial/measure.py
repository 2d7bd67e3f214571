"""The equation of state and its virial coefficients, from periodic event-driven runs."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import Fit, fit_polynomial
from gaspart.reproduction.families.shared.pressure import pressure
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table, table
from gaspart.scene.gas import plain_gas
from gaspart.theory.virial import linear_tail_uncertainty

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
