"""Half spaces of a gas of hard spheres by moments: numbers that gaspart.theory has from the literature are
derived again from the collision integrals of `gaspart.theory.boltzmann`, in its units."""

import numpy as np
from scipy.linalg import eig
from scipy.special import eval_genlaguerre, lpmv, roots_genlaguerre

from gaspart.theory.boltzmann import brackets, collisions


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
