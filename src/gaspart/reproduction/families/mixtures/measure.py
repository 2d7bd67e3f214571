"""Z, contact values and collision rates of mixtures and polydisperse gases.

A point is a periodic gas, either polydisperse or of two sizes. For two sizes, collisions are counted by pairs
of species.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.pairs import contact_scales, estimates_of, rate_scales
from gaspart.analysis.run import Run
from gaspart.analysis.series import compressibility
from gaspart.analysis.statistics import average, correlated_mean
from gaspart.errors import SceneError
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import table
from gaspart.scene.gas import Mixture
from gaspart.scene.sizes import DISTRIBUTIONS
from gaspart.theory.speeds import mean_speed_factor
from gaspart.trajectory.pairs import pairs_of

_PAIRS = {"large-large": (0, 0), "large-small": (0, 1), "small-small": (1, 1)}


def mixture_state(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure Z, contact values and collision rates, with values by theory.

    The dimension is point.

    dimension, packing_fraction, count : properties of the gas
    size_ratio, small_fraction : of gases of two sizes, else NaN
    polydispersity, distribution : of polydisperse gases, else NaN or ""
    Z : compressibility factor of the infinite gas, with `_error` and `_freedom`
    correction : subtracted correction of first order in 1/N, for equal particles of this packing fraction
    reference_error : uncertainty of the equation of state of equal particles
    boublik, linear, santos : Z by these theories (see `gaspart.theory.mixtures`); NaN without a value
    starling : Z by the linear theory with Carnahan and Starling's equation of equal spheres
    virial : of two sizes, sum of |dr . dp| over its prediction, minus 1, with `_error` and `_freedom`
    contact, rate : contact value and collision rate, with `_error`, and by theory, such as contact_boublik

    The dimension of contact and rate is pair ("large-large", "large-small", "small-small"). The prediction
    for `virial` uses the numbers of collisions of each pair, and Maxwellian velocities. The rate counts
    collisions of a particle of the first kind with all particles of the second kind. Its unit is sqrt(k_B T /
    m) divided by the larger diameter.
    """
    units = {"rate": "sqrt(k_B T / m) / diameter"}
    return table("point", points, _row, inner=("pair",), units=units).assign_coords(pair=list(_PAIRS))


def _row(point: Point) -> dict[str, Any]:
    scene, settings = point.scene, point.settings
    gas = scene.mixture
    if gas is None:
        raise SceneError("species", len(scene.kinds), "must be smooth and elastic particles alone")
    eta, d = gas.packing_fraction, gas.dimension
    correction = float(theory.finite_size_correction(eta, d, scene.count, "canonical"))
    two = "size_ratio" in settings
    replicas = [_of_two_sizes(run) if two else _of_any(run) for run in runs(point)]
    means = {name: average([replica[name] for replica in replicas]) for name in replicas[0]}
    if two:
        means["rate"] /= _unit_of_rate(gas)
    return {
        "dimension": d,
        "packing_fraction": eta,
        "count": scene.count,
        "size_ratio": settings.get("size_ratio", math.nan),
        "small_fraction": settings.get("small_fraction", math.nan),
        "polydispersity": settings.get("polydispersity", math.nan),
        "distribution": "" if two else settings.get("radius_distribution", DISTRIBUTIONS[0]),
        **means,
        "Z": means["Z"] - correction,
        "correction": correction,
        "reference_error": float(theory.compressibility_uncertainty(eta, d)),
        **theories(gas),
    }


def _of_any(run: Run) -> dict[str, Estimate]:
    return {"Z": correlated_mean(compressibility(run)).estimate}


def _of_two_sizes(run: Run) -> dict[str, Estimate]:
    """Measure Z, and quantities from collisions of each pair of species.

    Rates are per time.
    """
    return {
        **_of_any(run),
        "virial": _virial(run),
        "contact": Estimate.stack(estimates_of(run, contact_scales(run))),
        "rate": Estimate.stack(estimates_of(run, rate_scales(run))),
    }


def theories(gas: Mixture) -> dict[str, Any]:
    """Compute Z by each theory; for two sizes also contact value and rate of each pair."""
    predictions: dict[str, Any] = {}
    eta, d, diameters, _ = gas.sizes
    for name, dimensions in theory.MIXTURE_THEORIES.items():
        if d not in dimensions:
            continue
        predictions[name] = theory.mixture_compressibility_factor(*gas.sizes, theory=name)
        if len(diameters) == 2:
            contact = theory.mixture_contact_values(*gas.sizes, theory=name)
            rate = theory.mixture_collision_rates(
                *gas.sizes, theory=name, temperature=gas.temperature, masses=gas.masses
            ) / _unit_of_rate(gas)
            predictions[f"contact_{name}"] = [contact[pair] for pair in _PAIRS.values()]
            predictions[f"rate_{name}"] = [rate[pair] for pair in _PAIRS.values()]
    if d == 3:
        pure = (float(theory.carnahan_starling(eta)) - 1.0) / (4.0 * eta)
        predictions["starling"] = theory.mixture_compressibility_factor(
            *gas.sizes, theory="linear", pure=pure
        )
    return predictions


def _unit_of_rate(gas: Mixture) -> float:
    """Compute sqrt(k_B T / m) divided by the larger diameter."""
    return math.sqrt(gas.temperature / gas.masses[0]) / gas.diameters[0]


def _virial(run: Run) -> Estimate:
    """Compute |dr . dp| of collisions, divided by sigma sqrt(2 pi mu k_B T), minus 1.

    The denominator is the mean for colliding particles with reduced mass mu.
    """
    weights = []
    for i, j in pairs_of(run.scene):
        first, second = run.scene.species[i], run.scene.species[j]
        reduced = first.mass * second.mass / (first.mass + second.mass)
        impulse = math.sqrt(2.0 * math.pi * reduced * run.temperature) / mean_speed_factor(run.freedom)
        weights.append((first.radius + second.radius) * impulse)
    predicted = run.increments("pair_collisions") @ np.array(weights)
    return correlated_mean(run.increments("virial_sum") / predicted - 1.0).estimate
