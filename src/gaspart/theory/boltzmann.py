"""Linearised Boltzmann operator of hard discs and spheres, in Sonine polynomials.

Chapman and Cowling, The Mathematical Theory of Non-uniform Gases (1970). Velocities are in units of sqrt(k_B
T / m). Frequencies are in units of n sigma^(d-1) times this velocity unless noted. The collision integrals
are computed by exact quadratures. So the only error of a result is due to the finite number of polynomials.
In the Enskog equation, a homogeneous gas relaxes by the same operator multiplied by the contact value. So
relaxation rates per collision of a particle do not depend on density.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from gaspart.theory.geometry import unit_sphere_surface

_FLUXES = {"viscosity": (2, 0), "conductivity": (1, 1)}
"""Rank of the harmonic tensor and order of the Sonine polynomial, for the stress and for the heat flux."""
_ORDERS = 5
"""Number of polynomials that represent a flux. A sixth polynomial would change the integral of the flux
correlation by 3e-5.
"""


def collisions(
    dimension: int, nodes: int, restitution: float = 1.0
) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """Return quadrature weights and velocities for collisions of two Maxwellian particles."""
    from scipy.special import roots_hermitenorm, roots_laguerre

    abscissae, share = roots_hermitenorm(nodes)
    share = share / np.sqrt(2.0 * np.pi)
    energy, weight = roots_laguerre(nodes)  # half of the squared approach speed, over sqrt 2
    free = 2 * (dimension - 1) + 1
    axes = [part.ravel() for part in np.meshgrid(*[abscissae] * free, np.sqrt(2.0 * energy), indexing="ij")]
    shares = np.meshgrid(*[share] * free, weight / np.sqrt(np.pi), indexing="ij")
    first, second = axes[: dimension - 1], axes[dimension - 1 : 2 * dimension - 2]
    along = [(axes[-2] + sign * axes[-1]) / np.sqrt(2.0) for sign in (1, -1)]
    kick = 0.5 * (1.0 + restitution) * (along[0] - along[1])
    velocities = tuple(
        np.array([*across, normal])
        for across, normal in zip(
            (first, second, first, second), (*along, along[0] - kick, along[1] + kick), strict=True
        )
    )
    return unit_sphere_surface(dimension) * np.prod(shares, axis=0).ravel(), velocities


def brackets(
    rank: int,
    orders: range,
    met: tuple[np.ndarray, tuple[np.ndarray, ...]],
    tagged: bool = False,
) -> np.ndarray:
    """Compute the collision integrals between products of Sonine polynomials and a harmonic tensor."""
    from scipy.special import eval_genlaguerre

    weights, velocities = met
    dimension = len(velocities[0])
    sonine = [
        [eval_genlaguerre(order, rank + 0.5 * dimension - 1.0, 0.5 * (v**2).sum(axis=0)) for order in orders]
        for v in velocities
    ]
    signs, total = (-1, -1, 1, 1), np.zeros((len(orders), len(orders)))
    which = (0, 2) if tagged else range(4)
    for i in which:
        for j in which:
            factor = signs[i] * signs[j] * weights * _contraction(rank, velocities[i], velocities[j])
            total += [[factor @ (a * b) for b in sonine[j]] for a in sonine[i]]
    return total * (0.5 if tagged else 0.25)


def _contraction(rank: int, v: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Return the contraction v^l w^l P_l(cos(angle)) of two harmonic tensors; cos(l angle) replaces P_l in
    2D.
    """
    from scipy.special import eval_legendre

    size = np.sqrt((v**2).sum(axis=0) * (w**2).sum(axis=0))
    cosine = np.clip((v * w).sum(axis=0) / np.maximum(size, 1e-300), -1.0, 1.0)
    angular = eval_legendre(rank, cosine) if len(v) == 3 else np.cos(rank * np.arccos(cosine))
    return size**rank * angular


@lru_cache
def flux_relaxation(quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """Compute decay rates and weights for the relaxation of a kinetic flux of discs."""
    rank, first = _FLUXES[quantity]
    orders = range(first, first + _ORDERS)
    matrix = brackets(rank, orders, collisions(2, 2 * _ORDERS + 2))
    # mean square of S_k times the harmonic tensor
    norms = [2.0**rank * math.gamma(order + rank + 1.0) / math.factorial(order) for order in orders]
    rate = 2.0 * math.sqrt(math.pi)  # decay times, in collisions of a particle
    rates, modes = np.linalg.eigh(matrix / np.sqrt(np.outer(norms, norms)) / rate)
    return rates, modes[0] ** 2


# Homogeneous Boltzmann equation of hard spheres and discs, by direct simulation.
#
# Particles have no positions. Collision partners are drawn at random, which is molecular chaos (Nanbu 1980,
# Babovsky 1986). `tagged_paths` simulates a particle of another size and mass in such a gas. In the tests the
# same steps compute the tables of `data/` for rough discs, and test the tables of relaxation.


_SHARE = 0.01
"""Time step times the root-mean-square speed. In a step 0.4 % of the particles collide. Second collisions of
a particle within a step are neglected; they would be 0.2 % of all collisions.
"""


def relaxing_speeds(count: int, times: np.ndarray, hits: float, seed: int = 0) -> np.ndarray:
    """Simulate the speeds of a gas of spheres that all have speed 1 at time 0."""
    rng = np.random.default_rng(seed)
    velocity = directions(rng, count, 3)
    now, rows = 0.0, []
    for time in times:
        while now < time:
            i, j, normal, approach = _meetings(rng, velocity)
            velocity[i] -= approach[:, None] * normal
            velocity[j] += approach[:, None] * normal
            # all particles are paired in each step, and the mean of max(g.n, 0) over the normals is g / 4
            now += _step(velocity) / (4.0 * hits)
        rows.append(lengths(velocity))
    return np.array(rows)


def _meetings(
    rng: np.random.Generator, velocity: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Draw the M collisions of a step: particles i and j (M,), unit normals (M, d) and speeds of approach
    (M,).
    """
    step = _step(velocity)
    first, second = rng.permutation(len(velocity))[: len(velocity) // 2 * 2].reshape(2, -1)
    normal = directions(rng, len(first), velocity.shape[1])
    approach = dot(velocity[first] - velocity[second], normal)
    meets = rng.random(len(first)) < step * approach
    return first[meets], second[meets], normal[meets], approach[meets]


def _step(velocity: np.ndarray) -> float:
    """Return the probability of a collision in a step, divided by the speed of approach."""
    return _SHARE / float(np.sqrt(dot(velocity, velocity).mean()))


def directions(rng: np.random.Generator, count: int, dimension: int) -> np.ndarray:
    """Draw random unit vectors, shape (count, dimension)."""
    vectors = rng.standard_normal((count, dimension))
    vectors /= lengths(vectors)[:, None]
    return vectors


def lengths(vectors: np.ndarray) -> np.ndarray:
    """Compute the lengths of vectors."""
    return np.sqrt(dot(vectors, vectors))


def dot(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Compute the scalar products of pairs of vectors."""
    products = first[:, 0] * second[:, 0]
    for axis in range(1, first.shape[1]):
        products += first[:, axis] * second[:, axis]
    return products


# Tagged sphere in a dilute gas with given speeds, by direct simulation.
#
# The simulation solves the linear Boltzmann equation. The gas is isotropic and not affected by the sphere. It
# need not be in equilibrium. A sphere of mass M flies freely until a gas particle of mass m hits it along a
# normal n. Then its velocity along n changes by 2 m / (m + M) times the velocity difference along n. Normals
# are isotropic. The velocity along the normal of a gas particle of speed c is uniform in [-c, c]
# (Archimedes), so the hit rate is
#
# .. math:: n a^2 \int d\hat n \int_{-c}^{c} \frac{du}{2c} \max(\mathbf V \cdot \hat n - u, 0) .
#
# Gas particles never return (Chapman and Cowling's molecular chaos). This requires that their mean free path
# is much longer than the contact distance a. In a Maxwellian gas a heavy sphere obeys the Langevin equation,
# and the diffusion coefficient of a sphere with the mass of the gas particles is 1.01895 times the first
# Sonine approximation. Both results are tests of this program.


@dataclass(frozen=True)
class Tagged:
    """Paths of N independent spheres at T + 1 evenly spaced times."""

    displacements: np.ndarray
    velocities: np.ndarray


def tagged_paths(
    speeds: Iterable[np.ndarray], interval: float, hits: float, mass: float, count: int, seed: int = 0
) -> Tagged:
    """Simulate the paths of independent spheres from rest."""
    rng = np.random.default_rng(seed)
    velocity, position = np.zeros((count, 3)), np.zeros((count, 3))
    positions, velocities = [position.copy()], [velocity.copy()]
    for gas in speeds:
        _advance(rng, position, velocity, gas, interval, hits, 2.0 / (1.0 + mass))
        positions.append(position.copy())
        velocities.append(velocity.copy())
    return Tagged(np.array(positions), np.array(velocities))


def _advance(
    rng: np.random.Generator,
    position: np.ndarray,
    velocity: np.ndarray,
    gas: np.ndarray,
    interval: float,
    hits: float,
    share: float,
) -> None:
    """Move all spheres for one interval, in place. Possible hits are drawn at a rate that exceeds the hit
    rate of every sphere, and accepted in proportion to the speed of approach, so there is no time step.
    """
    fastest = float(gas.max())
    flying, moving, remaining = np.arange(len(position)), velocity.copy(), np.full(len(position), interval)
    while flying.size:
        most = lengths(moving) + fastest
        wait = rng.exponential(1.0 / (4.0 * hits * most))
        position[flying] += moving * np.minimum(wait, remaining)[:, None]
        remaining -= wait
        meets = remaining > 0.0
        flying, moving, remaining, most = (values[meets] for values in (flying, moving, remaining, most))
        normal = directions(rng, flying.size, 3)
        along = rng.choice(gas, flying.size) * rng.uniform(-1.0, 1.0, flying.size)
        approach = dot(moving, normal) - along
        hit = rng.random(flying.size) * most < approach
        moving[hit] -= share * (approach[hit, None] * normal[hit])
        velocity[flying[hit]] = moving[hit]
