"""Transport of heat in dilute mixtures of spheres."""

import math

import numpy as np

from gaspart.theory._arguments import Numbers, checked
from gaspart.theory.mixtures import Sizes, checked_mixture


@checked
def dilute_mixture_conductivity(
    diameters: Sizes,
    fractions: Sizes | None = None,
    temperature: float = 1.0,
    masses: Numbers | Sizes = 1.0,
) -> float:
    """Conductivity of heat of a dilute mixture of spheres, without diffusion, 1 / (length time), with k_B =
    1: that of Chapman and Enskog in the first approximation, kappa = -4 x L^-1 x with the fractions x and

        L_ii = -4 x_i^2 / kappa_i - sum_k x_i x_k c_ik (15/2 m_i^2 + 13/4 m_k^2 + 4 m_i m_k),
        L_ik = x_i x_k c_ik m_i m_k (55/4 - 7),    c_ik = 16 / (25 n D_ik (m_i + m_k)^2),

    kappa_i = 75 / (64 sigma_i^2) sqrt(k_B T / (pi m_i)) of each species alone, n D_ik = 3 / (8 sigma_ik^2)
    sqrt(k_B T / (2 pi mu_ik)), mu_ik the reduced mass (Muckenfuss and Curtiss, J. Chem. Phys. 29, 1273
    (1958), whose ratios A and B of collision integrals are 1 of spheres). Of two species tested against the
    formula of Hirschfelder, Curtiss and Bird (1954), 8.2-36. Higher approximations add 2.5 % for one species.
    masses: one for all, or (S,). The unit of length is that of the diameters.
    """
    _, sizes, parts = checked_mixture("santos", 0.1, 3, diameters, fractions)
    mass = np.broadcast_to(np.asarray(masses, dtype=float), sizes.shape)
    alone = 75.0 / (64.0 * sizes**2) * np.sqrt(temperature / (math.pi * mass))
    own, other, together = mass[:, None], mass[None, :], np.add.outer(mass, mass)
    between = 0.5 * np.add.outer(sizes, sizes)
    passing = 0.375 / between**2 * np.sqrt(temperature * together / (2.0 * math.pi * own * other))
    weight = 0.64 * np.outer(parts, parts) / (passing * together**2)
    lost = weight * (7.5 * own**2 + 3.25 * other**2 + 4.0 * own * other)
    matrix = weight * own * other * 6.75
    np.fill_diagonal(matrix, np.diag(lost) - lost.sum(axis=1) - 4.0 * parts**2 / alone)
    return float(-4.0 * parts @ np.linalg.solve(matrix, parts))
