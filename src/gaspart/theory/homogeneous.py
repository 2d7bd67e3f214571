"""The homogeneous Boltzmann equation of hard spheres and discs, by direct simulation.

This program computes what has no closed form: the relaxation of a gas whose particles all start with one
speed, by which the tables `data/relaxation_2d.csv` and `_3d.csv` are checked; the fourth cumulant of a gas
that cools; `data/rough_cooling.csv` and `data/rough_start.csv`, the temperatures of rough discs that cool,
and from a start without spins. There are no positions: partners are drawn at random, which is molecular chaos
(Nanbu 1980, Babovsky 1986). `tagged` has a particle of another size and mass in such a gas.
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
    """After each step (S,): collisions of a particle, kurtosis <v^4>/<v^2>^2, part never hit, and the mean
    square of the speed over that of the start."""

    collisions: np.ndarray
    kurtosis: np.ndarray
    never_hit: np.ndarray
    energy: np.ndarray


def homogeneous_gas(
    count: int, dimension: int, collisions: float, restitution: float = 1.0, seed: int = 0
) -> Homogeneous:
    """A gas of `count` particles of speed 1, directions isotropic, until `collisions` of a particle.

    In each step all particles are paired at random, and a pair with the relative velocity g collides along a
    random normal n with a probability proportional to max(g.n, 0): the rate of hard particles, whatever the
    dimension. Statistical errors fall as 1 / sqrt(count).
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
    """Speeds (T, count) at rising times of a gas of spheres that all have speed 1 at time 0.

    hits: n pi d^2, the number density times the cross-section of two of them: per length, so that a particle
    meets those at rest relative to each other at this rate per unit of its speed.
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
    """T_rot / T_tr (S,) after each step of rough discs that cool, until `collisions` of a particle.

    Restitution normal and tangential, moment of inertia q = I / (m R^2). Velocities and spins start
    Maxwellian, at the ratio of `granular.rough_ratio`, and leave that: they become correlated.
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
    """Collisions of a disc (S,) and T_tr - T_rot over the temperature of the start (S,) after each step of
    perfectly rough discs, whose velocities are Maxwellian and whose spins are 0 at first, until `collisions`.
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
    """One step of rough discs: changes their velocities and spins, returns the collisions of a disc."""
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
    """The collisions of one step: particles i and j (M,), unit normals (M, d), speeds of approach (M,)."""
    step = _step(velocity)
    first, second = rng.permutation(len(velocity))[: len(velocity) // 2 * 2].reshape(2, -1)
    normal = directions(rng, len(first), velocity.shape[1])
    approach = dot(velocity[first] - velocity[second], normal)
    meets = rng.random(len(first)) < step * approach
    return first[meets], second[meets], normal[meets], approach[meets]


def _step(velocity: np.ndarray) -> float:
    """The chance of a collision per speed of approach in one step."""
    return _SHARE / float(np.sqrt(dot(velocity, velocity).mean()))


def directions(rng: np.random.Generator, count: int, dimension: int) -> np.ndarray:
    """(count, dimension) random unit vectors."""
    vectors = rng.standard_normal((count, dimension))
    vectors /= lengths(vectors)[:, None]
    return vectors


def lengths(vectors: np.ndarray) -> np.ndarray:
    """(count,) lengths of vectors (count, dimension)."""
    return np.sqrt(dot(vectors, vectors))


def dot(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(count,) scalar products of vectors (count, dimension): column by column, which is several times faster
    than numpy's sum over so short an axis, and rounds alike."""
    products = first[:, 0] * second[:, 0]
    for axis in range(1, first.shape[1]):
        products += first[:, axis] * second[:, axis]
    return products
