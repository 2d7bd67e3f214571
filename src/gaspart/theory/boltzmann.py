"""Linearised Boltzmann operator of hard discs and spheres, in Sonine polynomials of velocity.

Chapman and Cowling, The Mathematical Theory of Non-uniform Gases (1970). Velocities are in sqrt(k_B T / m),
frequencies per n sigma^(d-1) of them unless stated. The collision integrals are exact quadratures, so the
numbers of kinetic theory follow to as many digits as polynomials give. In the equation of Enskog a
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
"""Number of polynomials of a flux: a sixth changes the integral of its correlation by 3e-5."""


def collisions(
    dimension: int, nodes: int, restitution: float = 1.0
) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """Return quadrature weights and velocities of all collisions of two Maxwellian particles.

    Parameters
    ----------
    dimension : {2, 3}
        Discs or spheres.
    nodes : int
        Number of nodes for each component of the velocities.
    restitution : float, default 1.0, [1]
        Coefficient of normal restitution.

    Returns
    -------
    weights : ndarray, shape (Q,), [1]
        Weights, in which max(g.n, 0) counts.
    velocities : tuple of ndarray, shape (d, Q), [1]
        Velocities of both particles before, and of both after the collision.

    Notes
    -----
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
    """Compute the collision integrals between Sonine polynomials times a harmonic tensor.

    Parameters
    ----------
    rank : int
        Rank of the harmonic tensor.
    orders : range
        Orders k of the Sonine polynomials S_k(v^2/2), K of them.
    met : tuple
        Weights and velocities of `collisions`.
    tagged : bool, default False
        True for one particle in a gas, False for the gas itself.

    Returns
    -------
    ndarray, shape (K, K), [1]
        Collision integrals, with the tensors contracted.
    """
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
    """Return the contraction of two harmonic tensors of velocities.

    It is v^l w^l P_l of the cosine of their angle, with v and w their sizes; in two dimensions cos(l angle)
    instead of P_l.
    """
    from scipy.special import eval_legendre

    size = np.sqrt((v**2).sum(axis=0) * (w**2).sum(axis=0))
    cosine = np.clip((v * w).sum(axis=0) / np.maximum(size, 1e-300), -1.0, 1.0)
    angular = eval_legendre(rank, cosine) if len(v) == 3 else np.cos(rank * np.arccos(cosine))
    return size**rank * angular


@lru_cache
def flux_relaxation(quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """Compute rates and weights of the relaxation of the kinetic part of a flux of discs.

    Parameters
    ----------
    quantity : {"viscosity", "conductivity"}
        Transport coefficient, whose flux is the shear stress or the heat flux.

    Returns
    -------
    rates : ndarray, shape (K,), [1]
        Decay rates, per collision of a particle.
    weights : ndarray, shape (K,), [1]
        Weights, whose sum is 1.

    Raises
    ------
    KeyError
        If the quantity is unknown.

    Notes
    -----
    The correlation of the flux after s collisions of a particle is sum w exp(-rate s). The spectrum of the
    operator is continuous. Rates and weights belong to its Gauss quadrature, which gives the correlation's
    integral and mean time to 1e-4. The integrals are the Sonine factors divided by the first rate; the heat
    flux of discs relaxes half as fast as their stress.
    """
    rank, first = _FLUXES[quantity]
    orders = range(first, first + _ORDERS)
    matrix = brackets(rank, orders, collisions(2, 2 * _ORDERS + 2))
    # the mean square of S_k times the harmonic tensor
    norms = [2.0**rank * math.gamma(order + rank + 1.0) / math.factorial(order) for order in orders]
    rate = 2.0 * math.sqrt(math.pi)  # collisions of a particle
    rates, modes = np.linalg.eigh(matrix / np.sqrt(np.outer(norms, norms)) / rate)
    return rates, modes[0] ** 2
