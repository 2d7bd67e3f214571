"""Homogeneous Boltzmann equation of hard spheres and discs, by direct simulation.

This program computes results without a closed form: the relaxation of a gas whose particles all start with
one speed, by which the tables `data/relaxation_2d.csv` and `_3d.csv` are checked; the fourth cumulant of a
gas that cools; `data/rough_cooling.csv` and `data/rough_start.csv`, the temperatures of rough discs that
cool, and from a start without spins. There are no positions: partners are drawn at random, which is molecular
chaos (Nanbu 1980, Babovsky 1986). `tagged` has a particle of another size and mass in such a gas.
"""

from dataclasses import dataclass

import numpy as np

from gaspart.theory._arguments import checked_dimension
from gaspart.theory.granular import rough_ratio

_SHARE = 0.01
"""Time step times the root-mean-square speed: 0.4 % of the particles collide in a step, so that what would
have been a particle's second collision in it, which is lost, is 0.2 % of all."""


@dataclass(frozen=True)
class Homogeneous:
    """Course of a homogeneous gas, after each of S - 1 steps and at the start.

    Parameters
    ----------
    collisions : ndarray, shape (S,), [1]
        Collisions of a particle since the start.
    kurtosis : ndarray, shape (S,), [1]
        <v^4>/<v^2>^2.
    never_hit : ndarray, shape (S,), [1]
        Fraction of the particles that have not collided.
    energy : ndarray, shape (S,), [1]
        Mean square of the speed divided by its initial value.
    """

    collisions: np.ndarray
    kurtosis: np.ndarray
    never_hit: np.ndarray
    energy: np.ndarray


def homogeneous_gas(
    count: int, dimension: int, collisions: float, restitution: float = 1.0, seed: int = 0
) -> Homogeneous:
    """Simulate a gas of particles of speed 1 with isotropic directions.

    Parameters
    ----------
    count : int
        Number of particles.
    dimension : {2, 3}
        Discs or spheres.
    collisions : float
        Collisions of a particle at the end.
    restitution : float, default 1.0, [1]
        Coefficient of normal restitution.
    seed : int, default 0
        Seed of the random numbers.

    Returns
    -------
    Homogeneous
        Collisions, kurtosis, fraction never hit, and energy after each step.

    Raises
    ------
    SceneError
        If the dimension is neither 2 nor 3.

    Notes
    -----
    In each step all particles are paired at random, and a pair with the relative velocity g collides along a
    random normal n with a probability proportional to max(g.n, 0): the rate of hard particles, in any
    dimension. Statistical errors decrease as 1 / sqrt(count).
    """
    rng, d = np.random.default_rng(seed), checked_dimension(dimension)
    velocity = directions(rng, count, d)
    hit = np.zeros(count, dtype=bool)
    made, rows = 0.0, [(0.0, 1.0, 1.0, 1.0)]
    while made < collisions:
        i, j, normal, approach = _meetings(rng, velocity)
        change = 0.5 * (1.0 + restitution) * approach[:, None] * normal
        velocity[i] -= change
        velocity[j] += change
        hit[i] = hit[j] = True
        made += 2.0 * len(i) / count
        square = dot(velocity, velocity)
        rows.append((made, (square**2).mean() / square.mean() ** 2, 1.0 - hit.mean(), square.mean()))
    return Homogeneous(*np.array(rows).T)


def relaxing_speeds(count: int, times: np.ndarray, hits: float, seed: int = 0) -> np.ndarray:
    """Simulate the speeds of a gas of spheres that all have speed 1 at time 0.

    Parameters
    ----------
    count : int
        Number of spheres.
    times : ndarray, shape (T,), [time]
        Rising times.
    hits : float, [1/length]
        n pi d^2, the number density times the cross-section of two spheres: a particle collides with
        particles at rest relative to each other at this rate per unit of its speed.
    seed : int, default 0
        Seed of the random numbers.

    Returns
    -------
    ndarray, shape (T, count), [length/time]
        Speeds at these times.
    """
    rng = np.random.default_rng(seed)
    velocity = directions(rng, count, 3)
    now, rows = 0.0, []
    for time in times:
        while now < time:
            i, j, normal, approach = _meetings(rng, velocity)
            velocity[i] -= approach[:, None] * normal
            velocity[j] += approach[:, None] * normal
            # A step pairs all, and the mean of max(g.n, 0) over the normals is g / 4.
            now += _step(velocity) / (4.0 * hits)
        rows.append(lengths(velocity))
    return np.array(rows)


def rough_discs(
    count: int, collisions: float, inertia: float, tangential: float, normal: float = 1.0, seed: int = 0
) -> np.ndarray:
    """Simulate the ratio of the temperatures of rough discs that cool.

    Parameters
    ----------
    count : int
        Number of discs.
    collisions : float
        Collisions of a particle at the end.
    inertia : float, [1]
        Reduced moment of inertia q = I / (m R^2).
    tangential : float, [1]
        Coefficient of tangential restitution.
    normal : float, default 1.0, [1]
        Coefficient of normal restitution.
    seed : int, default 0
        Seed of the random numbers.

    Returns
    -------
    ndarray, shape (S,), [1]
        T_rot / T_tr after each step.

    Raises
    ------
    ValueError
        If the discs are smooth, or a coefficient is out of range.

    Notes
    -----
    Velocities and spins start Maxwellian, at the ratio of `granular.rough_ratio`. They do not stay so: they
    become correlated.
    """
    rng = np.random.default_rng(seed)
    velocity, spin = rng.standard_normal((count, 2)), rng.standard_normal(count)  # spin: R omega
    spin *= np.sqrt(rough_ratio(inertia, tangential, normal) / inertia)
    made, ratios = 0.0, []
    while made < collisions:
        made += _rough_step(rng, velocity, spin, inertia, tangential, normal)
        ratios.append(2.0 * inertia * (spin**2).mean() / dot(velocity, velocity).mean())
    return np.array(ratios)


def rough_start(
    count: int, collisions: float, inertia: float, seed: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Simulate perfectly rough discs whose velocities are Maxwellian and whose spins are 0 at first.

    Parameters
    ----------
    count : int
        Number of discs.
    collisions : float
        Collisions of a particle at the end.
    inertia : float, [1]
        Reduced moment of inertia q = I / (m R^2).
    seed : int, default 0
        Seed of the random numbers.

    Returns
    -------
    collisions : ndarray, shape (S,), [1]
        Collisions of a disc after each step.
    difference : ndarray, shape (S,), [1]
        T_tr - T_rot divided by the initial temperature.
    """
    rng = np.random.default_rng(seed)
    velocity, spin = rng.standard_normal((count, 2)), np.zeros(count)
    start = 0.5 * dot(velocity, velocity).mean()
    made, rows = 0.0, [(0.0, 1.0)]
    while made < collisions:
        made += _rough_step(rng, velocity, spin, inertia, 1.0, 1.0)
        difference = 0.5 * dot(velocity, velocity).mean() - inertia * (spin**2).mean()
        rows.append((made, difference / start))
    where, differences = np.array(rows).T
    return where, differences


def _rough_step(
    rng: np.random.Generator,
    velocity: np.ndarray,
    spin: np.ndarray,
    inertia: float,
    tangential: float,
    normal: float,
) -> float:
    """Advance rough discs by a step: change velocities and spins, return the collisions of a disc."""
    share = inertia * (1.0 + tangential) / (2.0 * inertia + 2.0)
    i, j, along, approach = _meetings(rng, velocity)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    slip = dot(velocity[i] - velocity[j], across) + spin[i] + spin[j]
    change = 0.5 * (1.0 + normal) * approach[:, None] * along + share * slip[:, None] * across
    velocity[i] -= change
    velocity[j] += change
    spin[i] -= share / inertia * slip
    spin[j] -= share / inertia * slip
    return 2.0 * len(i) / len(velocity)


def _meetings(
    rng: np.random.Generator, velocity: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the collisions of a step.

    These are particles i and j (M,), unit normals (M, d), speeds of approach (M,).
    """
    step = _step(velocity)
    first, second = rng.permutation(len(velocity))[: len(velocity) // 2 * 2].reshape(2, -1)
    normal = directions(rng, len(first), velocity.shape[1])
    approach = dot(velocity[first] - velocity[second], normal)
    meets = rng.random(len(first)) < step * approach
    return first[meets], second[meets], normal[meets], approach[meets]


def _step(velocity: np.ndarray) -> float:
    """Return the probability of a collision per speed of approach in a step."""
    return _SHARE / float(np.sqrt(dot(velocity, velocity).mean()))


def directions(rng: np.random.Generator, count: int, dimension: int) -> np.ndarray:
    """Return random unit vectors, shape (count, dimension).

    Parameters
    ----------
    rng : numpy.random.Generator
        Generator of random numbers.
    count : int
        Number of vectors.
    dimension : int
        Number of components.

    Returns
    -------
    ndarray, shape (count, dimension), [1]
        Vectors.
    """
    vectors = rng.standard_normal((count, dimension))
    vectors /= lengths(vectors)[:, None]
    return vectors


def lengths(vectors: np.ndarray) -> np.ndarray:
    """Compute the lengths of vectors.

    Parameters
    ----------
    vectors : ndarray, shape (count, dimension)
        Vectors.

    Returns
    -------
    ndarray, shape (count,)
        Lengths.
    """
    return np.sqrt(dot(vectors, vectors))


def dot(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Compute the scalar products of pairs of vectors.

    Parameters
    ----------
    first : ndarray, shape (count, dimension)
        First vectors.
    second : ndarray, shape (count, dimension)
        Second vectors.

    Returns
    -------
    ndarray, shape (count,)
        Scalar products.

    Notes
    -----
    Column by column, which is several times faster than numpy's sum over so short an axis, and rounds alike.
    """
    products = first[:, 0] * second[:, 0]
    for axis in range(1, first.shape[1]):
        products += first[:, axis] * second[:, axis]
    return products
