"""Collision integrals of hard discs and spheres by exact quadrature, and what follows: the numbers that
gaspart.theory has from the literature are derived again from them.

Velocities are in sqrt(T / m), frequencies per n sigma^(d-1) of them. The normal of all collisions is the last
axis: integrands are scalars, so that nothing depends on its direction.
"""

import numpy as np
from scipy.linalg import eig
from scipy.special import (
    eval_genlaguerre,
    eval_legendre,
    lpmv,
    roots_genlaguerre,
    roots_hermitenorm,
    roots_laguerre,
)


def collisions(dimension, nodes, restitution=1.0):
    """Weights (Q,) and the velocities (d, Q) of both particles before and after, of all collisions of two
    Maxwellian particles in which max(g.n, 0) counts. Exact for polynomials of a degree below 2 nodes in each
    component."""
    place, share = roots_hermitenorm(nodes)
    share = share / np.sqrt(2.0 * np.pi)
    energy, weight = roots_laguerre(nodes)  # of the approach, half the square of its speed over sqrt 2
    free = 2 * (dimension - 1) + 1
    axes = [part.ravel() for part in np.meshgrid(*[place] * free, np.sqrt(2.0 * energy), indexing="ij")]
    shares = np.meshgrid(*[share] * free, weight / np.sqrt(np.pi), indexing="ij")
    first, second = axes[: dimension - 1], axes[dimension - 1 : 2 * dimension - 2]
    along = [(axes[-2] + sign * axes[-1]) / np.sqrt(2.0) for sign in (1, -1)]
    kick = 0.5 * (1.0 + restitution) * (along[0] - along[1])
    surface = 2.0 * np.pi * (dimension - 1)
    velocities = [
        np.array([*across, normal])
        for across, normal in zip(
            (first, second, first, second), (*along, along[0] - kick, along[1] + kick), strict=True
        )
    ]
    return surface * np.prod(shares, axis=0).ravel(), velocities


def brackets(rank, orders, met, tagged=False):
    """(K, K) collision integrals between S_k(v^2/2) times the harmonic tensor of this rank, contracted, for
    Sonine polynomials of the given orders; of one tagged particle, or of a gas."""
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


def _contraction(rank, v, w):
    """|v|^l |w|^l P_l of their angle, in two dimensions cos(l angle)."""
    size = np.sqrt((v**2).sum(axis=0) * (w**2).sum(axis=0))
    cosine = np.clip((v * w).sum(axis=0) / np.maximum(size, 1e-300), -1.0, 1.0)
    angular = eval_legendre(rank, cosine) if len(v) == 3 else np.cos(rank * np.arccos(cosine))
    return size**rank * angular


def temperature_jump(highest, nodes):
    """T_gas - T_wall over l_0 dT/dx of hard spheres at a diffuse wall, by moments up to an odd degree.

    The linearised Boltzmann equation in the half space: a uniform gradient with its Chapman-Enskog part, and
    all modes that decay away from the wall, the even moments of whose flux into the gas are the wall's
    (Grad 1949, Marshak's form). It converges as highest^-3.
    """
    basis = [(rank, order) for rank in range(highest + 1) for order in range((highest - rank) // 2 + 1)]
    one, warm = np.zeros(len(basis)), np.zeros(len(basis))
    one[basis.index((0, 0))] = 1.0
    warm[basis.index((0, 1))] = -_norm(0, 1)  # v^2/2 - 5/2 = -S_1 - 1: warmer at the same pressure
    return _half_space(basis, 0, nodes, warm - one, [one], [(0, 0), (1, 0), (0, 1)])


def velocity_slip(highest, nodes):
    """u_gas - u_wall over l_0 du/dx of hard spheres at a diffuse wall, likewise, up to an even degree."""
    basis = [(rank, order) for rank in range(1, highest + 1) for order in range((highest - rank) // 2 + 1)]
    along = np.zeros(len(basis))
    along[basis.index((1, 0))] = 1.0
    return _half_space(basis, 1, nodes, along, [], [(1, 0)])


def _norm(rank, order):
    """Root of <S^2 v^(2l) P_l^2> of Maxwellian velocities in three dimensions."""
    energy, share = roots_genlaguerre(40, 0.5)
    square = eval_genlaguerre(order, rank + 0.5, energy) ** 2 * (2.0 * energy) ** rank
    return np.sqrt(square @ share / share.sum() / (2 * rank + 1))


def _half_space(basis, turns, nodes, field, others, conserved):
    """What a field far away, of unit gradient, has at the wall, in l_0.

    basis: ranks and orders of functions of velocity with the azimuthal number `turns`; field: the function
    whose amplitude has a gradient; others: functions that may be added to it everywhere; conserved: the ranks
    and orders of functions that collisions do not change.
    """
    into, parity = _into(basis, turns)
    streaming = into - parity[:, None] * into * parity
    decay = _decay(basis, nodes)
    kept = [basis.index(one) for one in conserved]
    decay[kept], decay[:, kept] = 0.0, 0.0
    free = [k for k in range(len(basis)) if k not in kept]
    gradient = np.zeros(len(basis))
    gradient[free] = -np.linalg.solve(decay[np.ix_(free, free)], (streaming @ field)[free])
    rates, modes = eig(decay, streaming)
    lasting = np.isfinite(rates) & (np.abs(rates) < 1e6) & (rates.real > 1e-6)
    even = np.flatnonzero(parity > 0.0)
    unknown = np.column_stack([field, *others, modes[:, lasting].real])
    found = np.linalg.solve(into[even] @ unknown, -into[even] @ gradient)
    return found[0] * np.sqrt(2.0) * np.pi


def _into(basis, turns):
    """(K, K) products of the functions, weighted by the flux into the gas; (K,) their parity under a reversal
    of the velocity across the wall."""
    energy, share = roots_genlaguerre(40, 0.5)
    cosine, weight = np.polynomial.legendre.leggauss(40)
    speed, along = np.meshgrid(np.sqrt(2.0 * energy), 0.5 * (cosine + 1.0), indexing="ij")
    half = 0.25 * np.outer(share / share.sum(), weight).ravel()  # velocities into the gas, half of all
    square, mu = 0.5 * speed.ravel() ** 2, along.ravel()
    flux = half * speed.ravel() * mu
    values = np.array([
        eval_genlaguerre(order, rank + 0.5, square) * (2.0 * square) ** (0.5 * rank) * lpmv(turns, rank, mu)
        for rank, order in basis
    ])  # fmt: skip
    values /= np.sqrt(2.0 * (values**2 @ half))[:, None]
    return (values * flux) @ values.T, np.array([(-1.0) ** (rank + turns) for rank, _ in basis])


def _decay(basis, nodes):
    """(K, K) the collision integrals between the functions."""
    met, decay = collisions(3, nodes), np.zeros((len(basis), len(basis)))
    for rank in {rank for rank, _ in basis}:
        at = [k for k, (other, _) in enumerate(basis) if other == rank]
        block = brackets(rank, [basis[k][1] for k in at], met)
        norms = np.array([_norm(*basis[k]) for k in at])
        decay[np.ix_(at, at)] = block / ((2 * rank + 1) * np.outer(norms, norms))
    return decay
