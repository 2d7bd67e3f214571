r"""The linearised Boltzmann operator of hard discs and spheres, in Sonine polynomials of velocity.

Chapman and Cowling, The Mathematical Theory of Non-uniform Gases (1970). Velocities are in sqrt(k_B T / m),
frequencies per n sigma^(d-1) of them unless stated. The collision integrals are exact quadratures, so that
the numbers of kinetic theory follow to as many digits as polynomials give. In the equation of Enskog a
homogeneous gas relaxes by the same operator, times the contact value: rates in collisions of a particle do
not depend on density.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from gaspart.theory.geometry import unit_sphere_surface

_FLUXES = {"viscosity": (2, 0), "conductivity": (1, 1)}
"""Rank of the harmonic tensor and order of the Sonine polynomial of the stress and of the heat flux."""
_ORDERS = 5
"""Polynomials of a flux: a sixth changes the integral of its correlation by 3e-5."""


def collisions(
    dimension: int, nodes: int, restitution: float = 1.0
) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """All collisions of two Maxwellian particles, in which max(g.n, 0) counts: weights (Q,), and the
    velocities (d, Q) of both before and of both after it.

    The normal is the last axis: integrands are scalars, on which its direction has no influence. Exact for
    polynomials of a degree below 2 nodes in each component.
    """
    from scipy.special import roots_hermitenorm, roots_laguerre

    place, share = roots_hermitenorm(nodes)
    share = share / np.sqrt(2.0 * np.pi)
    energy, weight = roots_laguerre(nodes)  # of the approach, half the square of its speed over sqrt 2
    free = 2 * (dimension - 1) + 1
    axes = [part.ravel() for part in np.meshgrid(*[place] * free, np.sqrt(2.0 * energy), indexing="ij")]
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
    """(K, K) collision integrals between S_k(v^2/2) times the harmonic tensor of this rank, contracted, for
    Sonine polynomials of the given orders; met: of `collisions`; tagged: of one particle in a gas, by default
    of the gas."""
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
    """|v|^l |w|^l P_l of their angle, in two dimensions cos(l angle)."""
    from scipy.special import eval_legendre

    size = np.sqrt((v**2).sum(axis=0) * (w**2).sum(axis=0))
    cosine = np.clip((v * w).sum(axis=0) / np.maximum(size, 1e-300), -1.0, 1.0)
    angular = eval_legendre(rank, cosine) if len(v) == 3 else np.cos(rank * np.arccos(cosine))
    return size**rank * angular


@lru_cache
def flux_relaxation(quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """How the kinetic part of a flux of discs relaxes: rates (K,), per collisions of a particle, and weights
    (K,), of sum 1, of its correlation sum w exp(-rate s) after s collisions of a particle.

    quantity: "viscosity", of which the flux is the shear stress, or "conductivity", the heat flux. The
    spectrum of the operator is continuous: rates and weights are those of its Gauss quadrature, which gives
    the correlation's integral and mean time to 1e-4. The integrals are the Sonine factors over the first
    rate; the heat flux of discs relaxes half as fast as their stress. Raises KeyError for another quantity.
    """
    rank, first = _FLUXES[quantity]
    orders = range(first, first + _ORDERS)
    matrix = brackets(rank, orders, collisions(2, 2 * _ORDERS + 2))
    # the mean square of S_k times the harmonic tensor
    norms = [2.0**rank * math.gamma(order + rank + 1.0) / math.factorial(order) for order in orders]
    rate = 2.0 * math.sqrt(math.pi)  # collisions of a particle
    rates, modes = np.linalg.eigh(matrix / np.sqrt(np.outer(norms, norms)) / rate)
    return rates, modes[0] ** 2
