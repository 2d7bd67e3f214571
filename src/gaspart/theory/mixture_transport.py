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
    """Compute the thermal conductivity of a dilute mixture of spheres, without diffusion.

    Parameters
    ----------
    diameters : array_like, shape (S,), [length]
        Diameters of the species.
    fractions : array_like, shape (S,), optional, [1]
        Number fractions x, which are normalised. Default: equal.
    temperature : float, default 1.0, [energy]
        Temperature k_B T.
    masses : float or array_like, shape (S,), default 1.0, [mass]
        Masses of the particles: a number for all species, or one for each.

    Returns
    -------
    float, [1/(length time)]
        Conductivity kappa, with k_B = 1. The unit of length is the unit of the diameters.

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    Chapman and Enskog's conductivity in the first approximation [1]_: kappa = -4 x L^-1 x with

        L_ii = -4 x_i^2 / kappa_i - sum_k x_i x_k c_ik (15/2 m_i^2 + 13/4 m_k^2 + 4 m_i m_k),

        L_ik = x_i x_k c_ik m_i m_k (55/4 - 7),    c_ik = 16 / (25 n D_ik (m_i + m_k)^2),

        kappa_i = 75 / (64 sigma_i^2) sqrt(k_B T / (pi m_i)) of each species alone,

        n D_ik = 3 / (8 sigma_ik^2) sqrt(k_B T / (2 pi mu_ik)), with the reduced mass mu_ik.

    The ratios A and B of collision integrals are 1 for spheres. Two species are tested against the formula of
    Hirschfelder, Curtiss and Bird [2]_. Higher approximations add 2.5 % for one species.

    References
    ----------
    .. [1] C. Muckenfuss and C. F. Curtiss, J. Chem. Phys. 29, 1273 (1958).
    .. [2] J. O. Hirschfelder, C. F. Curtiss and R. B. Bird (1954), Eq. 8.2-36.

    Examples
    --------
    >>> from gaspart import theory
    >>> round(theory.dilute_mixture_conductivity([1.0, 2.0], masses=[1.0, 4.0]), 4)
    0.1959
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
