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
    """Measure the collision rate of a particle of one species with all particles of another one.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory of a run with `pairs`, by its path or open, or a simulation, which is run again.
    start : float, [time], optional
        Frames before this time are discarded. Default: a quarter of the run.

    Returns
    -------
    Observable
        Collisions per time of one particle of the first species of each pair with all of the second, (pair,),
        in [1/time].

    Raises
    ------
    SceneError
        For single particles, too few frames, and a run without `pairs`.

    Notes
    -----
    Theory: exact except for the contact values, which are those of an infinite mixture. A particle of N_i has
    N_i - 1 partners of its own species, and the mean speed is that of a finite number at fixed energy.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> gases = [gp.Species(20, radius, temperature=1.0) for radius in (0.3, 0.5)]
    >>> scene = gp.Scene(box, gases)
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> gp.analysis.pair_collision_rates(simulation).sizes["pair"]
    3
    """
    with open_run(source, start, pairs=True) as run:
        require_defined("pair_rates", run.scene)
        return _of_pairs("pair_rates", "pair_collision_rate", run, estimates_of(run, rate_scales(run)))


def contact_values(source: Source, start: float | None = None) -> Observable:
    """Measure the pair distribution at contact, g_ij, of each pair of species from its collision rate.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory of a run with `pairs`, by its path or open, or a simulation, which is run again.
    start : float, [time], optional
        Frames before this time are discarded. Default: a quarter of the run.

    Returns
    -------
    Observable
        The contact values (pair,), dimensionless.

    Raises
    ------
    SceneError
        As `pair_collision_rates`, for a scene with walls or contacts that lose energy, and for a polydisperse
        species.

    Notes
    -----
    A number N_ij of collisions in the time t is

        n_ij S sigma_ij^(d-1) g_ij sqrt(k_B T / (2 pi mu_ij)) t / V,

    with n_ij = N_i N_j or N_i (N_i - 1) / 2 pairs of particles, S = 2 pi (2D) or 4 pi (3D), and mu_ij the
    reduced mass. This is exact in equilibrium [1]_, with the mean speed of a finite number of particles at
    fixed energy.

    References
    ----------
    .. [1] S. Chapman and T. G. Cowling (1970).

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> gases = [gp.Species(20, radius, temperature=1.0) for radius in (0.3, 0.5)]
    >>> scene = gp.Scene(box, gases)
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> gp.analysis.contact_values(simulation).sizes["pair"]
    3
    """
    with open_run(source, start, pairs=True) as run:
        found = estimates_of(run, contact_scales(run))
        return _of_pairs("contact_values", "contact_value", run, found)


def rate_scales(run: Run) -> np.ndarray:
    """Compute the collision rate of a pair of species divided by that of a particle of the first.

    Parameters
    ----------
    run : Run
        The run.

    Returns
    -------
    ndarray, shape (pairs,)
        The ratios.
    """
    counts = [kind.count for kind in run.scene.species]
    pairs = pairs_of(run.scene)
    return np.array([counts[i] / (2.0 if i == j else 1.0) for i, j in pairs])


def contact_scales(run: Run) -> np.ndarray:
    """Compute the collisions per time of each pair divided by its contact value.

    Parameters
    ----------
    run : Run
        The run.

    Returns
    -------
    ndarray, shape (pairs,)
        The ratios.

    Raises
    ------
    SceneError
        As `contact_values`.
    """
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
    """Estimate the collisions of each pair per time, divided by its scale.

    Parameters
    ----------
    run : Run
        The run.
    scales : ndarray, shape (pairs,)
        The scales.

    Returns
    -------
    list of Estimate
        The estimates.

    Raises
    ------
    SceneError
        If there are too few frames, or the run has no counts or no collisions.
    """
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
