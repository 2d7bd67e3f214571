r"""Tagged sphere in a dilute gas of given speeds, by direct simulation.

The simulation solves the linear Boltzmann equation. The gas is isotropic, unaffected by the sphere, and need
not be in equilibrium. The sphere, of mass M, flies freely until a gas particle of mass m hits it along a
normal n; then its velocity along n changes by 2 m / (m + M) times the difference of both. Normals are
isotropic, and a gas particle of speed c has a velocity along them that is uniform in [-c, c] (Archimedes), so
hits come at the rate

.. math:: n a^2 \int d\hat n \int_{-c}^{c} \frac{du}{2c} \max(\mathbf V \cdot \hat n - u, 0) .

Gas particles never come back (Chapman and Cowling's molecular chaos): this needs a mean free path of theirs
that is much longer than the distance of contact a. In Maxwell's gas a heavy sphere obeys Langevin's equation,
and one of the gas's own mass has 1.01895 times its diffusion; there this program has both as tests.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from gaspart.theory.homogeneous import directions, dot, lengths


@dataclass(frozen=True)
class Tagged:
    """Paths of N independent spheres at T + 1 evenly spaced times.

    Parameters
    ----------
    displacements : ndarray, shape (T + 1, N, 3), [length]
        Displacements from the start.
    velocities : ndarray, shape (T + 1, N, 3), [length/time]
        Velocities.
    """

    displacements: np.ndarray
    velocities: np.ndarray


def tagged_paths(
    speeds: Iterable[np.ndarray], interval: float, hits: float, mass: float, count: int, seed: int = 0
) -> Tagged:
    """Simulate the paths of independent spheres from rest.

    Parameters
    ----------
    speeds : iterable of ndarray, shape (G,), [length/time]
        Speeds of gas particles, whose mass is 1, during each interval of time.
    interval : float, [time]
        Length of an interval.
    hits : float, [1/length]
        n pi a^2, with the number density n of the gas and the distance of contact a.
    mass : float
        Mass of a sphere divided by the mass of a gas particle.
    count : int
        Number N of spheres.
    seed : int, default 0
        Seed of the random numbers.

    Returns
    -------
    Tagged
        Displacements and velocities at the start and after each interval.

    Notes
    -----
    Statistical errors fall as 1 / sqrt(count).
    """
    rng = np.random.default_rng(seed)
    velocity, place = np.zeros((count, 3)), np.zeros((count, 3))
    places, velocities = [place.copy()], [velocity.copy()]
    for gas in speeds:
        _advance(rng, place, velocity, gas, interval, hits, 2.0 / (1.0 + mass))
        places.append(place.copy())
        velocities.append(velocity.copy())
    return Tagged(np.array(places), np.array(velocities))


def _advance(
    rng: np.random.Generator,
    place: np.ndarray,
    velocity: np.ndarray,
    gas: np.ndarray,
    interval: float,
    hits: float,
    share: float,
) -> None:
    """Move all spheres for one interval, in place.

    Hits are drawn at a rate that no sphere exceeds at its present speed, and accepted in proportion to the
    speed of approach. So there is no time step, and no error of a time step.
    """
    fastest = float(gas.max())
    flying, moving, left = np.arange(len(place)), velocity.copy(), np.full(len(place), interval)
    while flying.size:
        most = lengths(moving) + fastest
        wait = rng.exponential(1.0 / (4.0 * hits * most))
        place[flying] += moving * np.minimum(wait, left)[:, None]
        left -= wait
        meets = left > 0.0
        flying, moving, left, most = (values[meets] for values in (flying, moving, left, most))
        normal = directions(rng, flying.size, 3)
        along = rng.choice(gas, flying.size) * rng.uniform(-1.0, 1.0, flying.size)
        approach = dot(moving, normal) - along
        hit = rng.random(flying.size) * most < approach
        moving[hit] -= share * (approach[hit, None] * normal[hit])
        velocity[flying[hit]] = moving[hit]
