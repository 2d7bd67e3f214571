"""Collision rates and contact values of each pair of species."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.observable import LEAST_INTERVALS, Observable, observable
from gaspart.analysis.run import Run, Source, measured, require_collisions, require_elastic, require_periodic
from gaspart.analysis.statistics import correlated_mean
from gaspart.errors import SceneError
from gaspart.scene.gas import Mixture
from gaspart.theory.geometry import unit_sphere_surface
from gaspart.theory.speeds import mean_speed_factor
from gaspart.trajectory.pairs import pair_names, pairs_of

_SOURCE = "contact values of Santos, Yuste and Lopez de Haro 2002, an approximation"


def pair_collision_rates(source: Source, start: float | None = None) -> Observable:
    """Collisions per time of one particle of the first species of each pair with all of the second, (pair,).

    source: a trajectory of a run with `pairs`, by its path or open, or a simulation, which is run again;
    start: the time from which frames count (by default a quarter of the run). Theory: exact but for the
    contact values, which are those of an infinite mixture; a particle of N_i has N_i - 1 partners of its own
    species, and the mean speed is that of a finite number at fixed energy. Raises SceneError for single
    particles, too few frames, and a run without `pairs`.
    """
    with measured(source, start, pairs=True) as run:
        found = estimates_of(run, rate_scales(run))
        about: dict[str, Any] = {"units": "1 / time", "long_name": "collisions of a particle per time"}
        return _of_pairs("pair_collision_rate", run, found, about, _finite_rates)


def _finite_rates(run: Run, mixture: Mixture) -> np.ndarray:
    """(S, S) theory's collision rates of a finite number of particles."""
    settings: dict[str, Any] = {"temperature": run.temperature, "masses": mixture.masses}
    rates = np.asarray(theory.mixture_collision_rates(*mixture.sizes, **settings))
    partners = 1.0 - np.diag(1.0 / np.array(mixture.counts, dtype=float))
    return rates * partners * mean_speed_factor(run.freedom)


def contact_values(source: Source, start: float | None = None) -> Observable:
    """The pair distribution at contact of each pair of species, g_ij (pair,), dimensionless, from its
    collision rate: a number N_ij of collisions in the time t is

        n_ij S sigma_ij^(d-1) g_ij sqrt(k_B T / (2 pi mu_ij)) t / V,

    n_ij = N_i N_j or N_i (N_i - 1) / 2 pairs of particles, S = 2 pi (2D) or 4 pi (3D), mu_ij the reduced
    mass; exact in equilibrium (Chapman and Cowling 1970), with the mean speed of a finite number of particles
    at fixed energy. Arguments as in `pair_collision_rates`.

    Raises SceneError as that, for a scene with walls or contacts that lose energy, and for a polydisperse
    species.
    """
    with measured(source, start, pairs=True) as run:
        found = estimates_of(run, contact_scales(run))
        about: dict[str, Any] = {"units": "1", "long_name": "pair distribution at contact"}
        return _of_pairs("contact_value", run, found, about, _contact_values)


def _contact_values(run: Run, mixture: Mixture) -> np.ndarray:
    """(S, S) theory's contact values, of an infinite mixture."""
    return np.asarray(theory.mixture_contact_values(*mixture.sizes))


def rate_scales(run: Run) -> np.ndarray:
    """(pairs,) collisions per time of a pair of species over that of a particle of the first one."""
    counts = [kind.count for kind in run.scene.species]
    pairs = pairs_of(run.scene)
    return np.array([counts[i] / (2.0 if i == j else 1.0) for i, j in pairs])


def contact_scales(run: Run) -> np.ndarray:
    """(pairs,) collisions per time over the contact value. Raises SceneError; see `contact_values`."""
    require_periodic(run)
    require_elastic(run)
    scene, d = run.scene, run.dimension
    for n, kind in enumerate(scene.species):
        if not kind.alike:
            rule = "a contact value is that of two sizes; measure pair_collision_rates"
            raise SceneError(f"species[{n}].polydispersity", kind.polydispersity, rule)
        if kind.fixed:
            raise SceneError(
                f"species[{n}].fixed", True, "contact values follow from the rates of free flight"
            )
    scales = []
    for i, j in pairs_of(scene):
        one, other = scene.species[i], scene.species[j]
        number = one.count * other.count if i != j else one.count * (one.count - 1) / 2.0
        speed = math.sqrt(run.temperature * (1.0 / one.mass + 1.0 / other.mass) / (2.0 * math.pi))
        between = (one.radius + other.radius) ** (d - 1)
        scales.append(number * unit_sphere_surface(d) * between * speed / scene.container.volume)
    return np.array(scales) * mean_speed_factor(run.freedom)


def estimates_of(run: Run, scales: np.ndarray) -> list[Estimate]:
    """The collisions of each pair per time, over its scale. Raises SceneError for too few frames, a run
    without counts, and one without collisions."""
    if "pair_collisions" not in run.data:
        raise SceneError("pairs", False, "the run must count collisions by pairs: run with --pairs")
    if len(run.time) <= LEAST_INTERVALS:
        raise SceneError("frames", len(run.time), f"an error needs {LEAST_INTERVALS + 1} or more")
    require_collisions(run)
    rates = run.increments("pair_collisions") / np.diff(run.time)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):  # of a single particle with its like: no pair
        series = (rates / scales).T
    nothing = Estimate(math.nan, math.nan)
    return [
        correlated_mean(one, LEAST_INTERVALS).estimate if np.ptp(one) > 0.0 else nothing for one in series
    ]


def _of_pairs(
    name: str,
    run: Run,
    found: list[Estimate],
    about: dict[str, Any],
    predicted: Callable[[Run, Mixture], np.ndarray],
) -> Observable:
    along = {"pair": (np.array(pair_names(run.scene)), {"long_name": "numbers of two species, from 0"})}
    values, errors = np.array([[one.value, one.error] for one in found]).T
    mixture = run.mixture
    if mixture is not None and len(mixture.counts) == len(run.scene.species):
        expected = predicted(run, mixture)
        about |= {"theory": ([expected[pair] for pair in pairs_of(run.scene)], np.nan), "source": _SOURCE}
    return observable(name, along, values, errors, **about)


def theory_of_z(mixture: Mixture) -> dict[str, Any]:
    """What `compressibility_factor` compares a mixture with."""
    value = theory.mixture_compressibility_factor(*mixture.sizes)
    eta, d, count = mixture.packing_fraction, mixture.dimension, sum(mixture.counts)
    value += float(theory.finite_size_correction(eta, d, count, "canonical"))
    source = "Santos, Yuste and Lopez de Haro 2002, an approximation, corrected for the number of particles"
    return {"theory": (value, np.nan), "source": source}
