"""The equation of state and its virial coefficients, from periodic event-driven runs."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.statistics import Fit, fit_polynomial
from gaspart.reproduction.families.shared.claims import freedoms
from gaspart.reproduction.families.shared.pressure import pressure
from gaspart.reproduction.points.point import Point
from gaspart.theory.virial import linear_tail_uncertainty


def virial_discs(points: list[Point], settings: dict) -> xr.Dataset:
    """Z of discs at each packing fraction, virial coefficients fitted to it. See `equation_of_state`."""
    return equation_of_state(points, settings)


def virial_spheres(points: list[Point], settings: dict) -> xr.Dataset:
    """Z of spheres at each packing fraction, virial coefficients fitted to it. See `equation_of_state`."""
    return equation_of_state(points, settings)


def equation_of_state(points: list[Point], settings: dict) -> xr.Dataset:
    """Z against packing fraction of one dimension, with the reference, and fits of B2, B3, B4.

    settings: `fits`, a list of mappings {free: highest coefficient left free, up_to: largest packing fraction
    used, held: bool} (see `fit_coefficients`), the first of them being the one that is claimed.

    Returns over `packing_fraction` (ascending): Z and Z_error, corrected to the infinite system by adding
    -finite_size; finite_size; poisson_error, (Z-1)/sqrt(collisions); reference, reference_error;
    collision_rate with its error, over Enskog's for N particles; replica_chi_square and
    replica_degrees_of_freedom; correlation (in samples); flat; collisions, count. Over `fit` and `order`:
    coefficient and coefficient_error (in powers of the packing fraction; NaN where it was not free), exact;
    over `fit`: free, up_to, held, chi_square, degrees_of_freedom, held_error (`order`, `fit`).
    """
    points = sorted(points, key=lambda point: point.scene.packing_fraction)
    dimension = points[0].settings["dimension"]
    eta = np.array([point.scene.packing_fraction for point in points])
    count = np.array([point.extents[0] for point in points])
    runs = [pressure(point) for point in points]
    shift = np.array([
        float(theory.finite_size_correction(x, dimension, n, ensemble="canonical"))
        for x, n in zip(eta, count, strict=True)
    ])  # fmt: skip
    expected_rate = np.array([
        float(theory.collision_rate(x, dimension) * theory.collision_rate_finite_size_factor(x, dimension, n))
        for x, n in zip(eta, count, strict=True)
    ])  # fmt: skip
    z = np.array([run.z.value for run in runs]) - shift
    rates = [run.collision_rate for run in runs]
    collisions = np.array([run.counters["collisions"] for run in runs])
    columns = {
        "Z": (z, "compressibility factor of the infinite system"),
        "Z_error": ([run.z.error for run in runs], "standard error of Z, with its correlation in time"),
        "Z_freedom": ([run.z.freedom for run in runs], "degrees of freedom of the error"),
        "finite_size": (shift, "correction that was subtracted, first order in 1/N"),
        "poisson_error": ((z - 1.0) / np.sqrt(collisions), "(Z-1)/sqrt(number of collisions)"),
        "reference": (theory.compressibility_factor(eta, dimension), "Z of the reference equation"),
        "reference_error": (theory.compressibility_uncertainty(eta, dimension), "its uncertainty"),
        "collision_rate": ([run.value for run in rates] / expected_rate, "over Enskog's"),
        "collision_rate_error": ([run.error for run in rates] / expected_rate, "of the ratio"),
        "collision_rate_freedom": ([run.freedom for run in rates], "degrees of freedom of the error"),
        "replica_chi_square": ([run.chi_square for run in runs], "of replicas about their mean"),
        "replica_degrees_of_freedom": ([run.degrees_of_freedom for run in runs], "replicas - 1"),
        "correlation": ([run.correlation for run in runs], "autocorrelation time in samples"),
        "flat": ([int(run.flat) for run in runs], "1 if all block errors reached a plateau"),
        "collisions": (collisions, "number of collisions measured"),
        "count": (count, "number of particles"),
    }
    dataset = xr.Dataset(
        {
            name: ("packing_fraction", np.asarray(values), {"units": "1", "long_name": text})
            for name, (values, text) in columns.items()
        },
        coords={"packing_fraction": ("packing_fraction", eta, {"units": "1"})},
        attrs={"dimension": dimension},
    )
    return dataset.merge(fit_table(dataset, settings["fits"]))


def fit_table(dataset: xr.Dataset, choices: list[dict]) -> xr.Dataset:
    """`fit_coefficients` by every choice, side by side; choices with too few points are left out."""
    dimension = dataset.attrs["dimension"]
    eta, z, error = (dataset[name].values for name in ("packing_fraction", "Z", "Z_error"))
    few = freedoms(dataset, "Z")
    fits = []
    for choice in choices:
        inside = eta <= choice["up_to"] * (1.0 + 1e-9)
        if inside.sum() < choice["free"]:  # one point more than the free coefficients B2 ... B_free
            continue
        part = eta[inside], z[inside], error[inside]
        found = fit_coefficients(*part, dimension, choice["free"], choice["held"], few[inside])
        fits.append((choice, found))
    highest = max((choice["free"] for choice, _ in fits), default=4)
    orders = np.arange(2, highest + 1)
    table = {
        name: np.full((len(fits), orders.size), np.nan)
        for name in ("coefficient", "error", "freedom", "held_error")
    }
    for row, (_, (fit, held_error)) in enumerate(fits):
        table["coefficient"][row, : fit.values.size] = fit.values
        table["error"][row, : fit.values.size] = fit.errors
        table["freedom"][row, : fit.values.size] = fit.freedoms
        table["held_error"][row, : fit.values.size] = held_error
    exact, exact_error = theory.virial_coefficients(dimension, highest)
    return xr.Dataset(
        {
            "coefficient": (("fit", "order"), table["coefficient"], {"units": "1"}),
            "coefficient_error": (("fit", "order"), table["error"], {"units": "1"}),
            "coefficient_freedom": (("fit", "order"), table["freedom"], {"units": "1"}),
            "held_error": (("fit", "order"), table["held_error"], {"units": "1"}),
            "exact": ("order", exact[1:], {"units": "1"}),
            "exact_error": ("order", exact_error[1:], {"units": "1"}),
            "fit_chi_square": ("fit", np.array([fit.chi_square for _, (fit, _) in fits])),
            "fit_degrees_of_freedom": ("fit", np.array([fit.degrees_of_freedom for _, (fit, _) in fits])),
            "free": ("fit", np.array([choice["free"] for choice, _ in fits], dtype=int)),
            "up_to": ("fit", np.array([choice["up_to"] for choice, _ in fits], dtype=float)),
            "held": ("fit", np.array([int(choice["held"]) for choice, _ in fits], dtype=int)),
        },
        coords={"order": orders},
    )


def fit_coefficients(
    eta: np.ndarray,
    z: np.ndarray,
    error: np.ndarray,
    dimension: int,
    free: int,
    held: bool,
    few: np.ndarray | float = math.inf,
) -> tuple[Fit, np.ndarray]:
    """Weighted fit of (Z-1)/eta = b_2 + b_3 eta + ... with b_2 ... b_free free.

    held: the higher coefficients, to B10, are held at their literature values and the terms beyond at
    `theory.linear_tail`; otherwise they are taken as zero (the series is cut), which shows what they matter.
    few: degrees of freedom of the errors.

    Returns the Fit (values b_2 ... b_free) and held_error (free - 1,): the standard errors that the
    uncertainty of what is held brings with it, which the fit's own errors do not contain.
    """
    powers = tuple(range(free - 1))
    y, y_error = (z - 1.0) / eta, error / eta
    if not held:
        return fit_polynomial(eta, y, y_error, powers=powers, freedoms=few), np.zeros(len(powers))
    coefficients, uncertainties = theory.virial_coefficients(dimension)
    tail = theory.linear_tail(eta, dimension) / eta
    higher = {order - 2: coefficients[order - 1] for order in range(free + 1, theory.HIGHEST_ORDER + 1)}
    fit = fit_polynomial(eta, y - tail, y_error, powers=powers, fixed=higher, freedoms=few)
    # The values are linear in what is held, so each held term's uncertainty moves them by its own fit.
    terms = [uncertainties[power + 1] * eta**power for power in higher]
    terms.append(linear_tail_uncertainty(eta, dimension) / eta)
    moved = [fit_polynomial(eta, term, y_error, powers=powers).values for term in terms]
    return fit, np.sqrt(np.sum(np.square(moved), axis=0))
