"""Collision rates and contact values of each pair of species."""

from __future__ import annotations

import math

import numpy as np

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.expected.described import described
from gaspart.analysis.observable import LEAST_INTERVALS, Observable, observable
from gaspart.analysis.observables import KEPT, require_defined
from gaspart.analysis.run import Run, Source, open_run, require_collisions
from gaspart.analysis.statistics import correlated_mean
from gaspart.errors import SceneError
from gaspart.theory.geometry import unit_sphere_surface
from gaspart.theory.speeds import mean_speed_factor
from gaspart.trajectory.pairs import pair_names, pairs_of


def pair_collision_rates(source: Source, start: float | None = None) -> Observable:
    """Collisions per time of one particle of the first species of each pair with all of the second, (pair,).

    source: a trajectory of a run with `pairs`, by its path or open, or a simulation, which is run again;
    start: the time from which frames count (by default a quarter of the run). Theory: exact but for the
    contact values, which are those of an infinite mixture; a particle of N_i has N_i - 1 partners of its own
    species, and the mean speed is that of a finite number at fixed energy. Raises SceneError for single
    particles, too few frames, and a run without `pairs`.
    """
    with open_run(source, start, pairs=True) as run:
        require_defined("pair_rates", run.scene)
        return _of_pairs("pair_rates", "pair_collision_rate", run, estimates_of(run, rate_scales(run)))


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
    with open_run(source, start, pairs=True) as run:
        found = estimates_of(run, contact_scales(run))
        return _of_pairs("contact_values", "contact_value", run, found)


def rate_scales(run: Run) -> np.ndarray:
    """(pairs,) collisions per time of a pair of species over that of a particle of the first one."""
    counts = [kind.count for kind in run.scene.species]
    pairs = pairs_of(run.scene)
    return np.array([counts[i] / (2.0 if i == j else 1.0) for i, j in pairs])


def contact_scales(run: Run) -> np.ndarray:
    """(pairs,) collisions per time over the contact value. Raises SceneError; see `contact_values`."""
    require_defined("contact_values", run.scene)
    scene, d = run.scene, run.dimension
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
        raise SceneError(*KEPT["pairs"])
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


def _of_pairs(observed: str, name: str, run: Run, found: list[Estimate]) -> Observable:
    """The result of an observable of pairs, `observed`, whose variable has a name."""
    along = {"pair": (np.array(pair_names(run.scene)), {"long_name": "numbers of two species, from 0"})}
    values, errors = np.array([[one.value, one.error] for one in found]).T
    return observable(name, along, values, errors, **described(observed, run))
