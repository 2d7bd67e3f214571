"""Chemical potentials of mixtures of additive hard discs and spheres, from equations of state.

The potentials are in units of k_B T, relative to an ideal gas. Arguments are as in `mixtures`.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from gaspart.theory.geometry import Numbers, check_ranges, particle_volume
from gaspart.theory.mixtures import Sizes, checked_mixture, contact_coefficients, virial_sum

_STEP, _WIDE = 1e-3, 1e-2
"""Steps of central differences of the free energy and of its second derivatives: largest relative change of a
moment of the diameters.
"""
_NODES = 32  # number of nodes of the integral over the packing fraction


def mixture_chemical_potentials(
    packing_fraction: float,
    dimension: int,
    diameters: Sizes,
    fractions: Sizes | None = None,
    theory: str = "santos",
) -> np.ndarray:
    """Compute the excess chemical potential of each species of a mixture.

    The derivative of F = N k_B T int_0^eta (Z - 1) / eta' d eta' with respect to N_i at constant volume
    (exact thermodynamics), with Z of `mixture_compressibility_factor`.

    Parameters
    ----------
    fractions : array_like, shape (S,), optional, [1]
        Number fractions, which are normalised. Default: equal. A fraction may be 0: a species at infinite
        dilution.

    Returns
    -------
    ndarray, shape (S,), [1]
        Potentials mu_i / k_B T, relative to an ideal gas.
    """
    parts, unit, free_energy = _free_energy(packing_fraction, dimension, diameters, fractions, theory)
    return _gradient(free_energy, parts, _STEP * unit)


def mixture_insertion_correction(
    packing_fraction: float, dimension: int, diameters: Sizes, counts: Sizes, theory: str = "santos"
) -> np.ndarray:
    """Compute the shift of the insertion potential of a mixture due to finite particle numbers. -ln P_i is
    the change of the free energy when one particle is added. For finite numbers the free energy is F + (1/2)
    ln(det G / prod N_a). Here G are the covariances of the numbers in an open container. The formula follows
    from the saddle point of the grand partition function, as in `state.finite_size_correction`. In an ideal
    gas G is diagonal and equal to the numbers. With the matrix H of second derivatives of F relative to the
    ideal gas, the result is

        H_ii / 2 - (1/2) d ln det(1 + N H) / dN_i,    where N is the diagonal matrix of the numbers.
    """
    parts, unit, free_energy = _free_energy(packing_fraction, dimension, diameters, counts, theory)
    step = _STEP * unit

    def curvature(numbers: np.ndarray) -> np.ndarray:
        return _gradient(lambda at: _gradient(free_energy, at, step), numbers, step)

    def fluctuations(numbers: np.ndarray) -> float:
        return float(np.linalg.slogdet(np.eye(len(parts)) + numbers[:, None] * curvature(numbers))[1])

    total = float(np.sum(np.asarray(counts, dtype=float)))
    change = np.diag(curvature(parts)) - _gradient(fluctuations, parts, _WIDE * unit)
    return 0.5 * change / total


def _free_energy(
    packing_fraction: float, dimension: int, diameters: Sizes, fractions: Sizes | None, theory: str
) -> tuple[np.ndarray, np.ndarray, Callable[[np.ndarray], float]]:
    """Return fractions (S,), units of changes (S,) and F / k_B T of numbers (S,); a unit doubles a moment of
    the diameters.
    """
    eta, sizes, parts = checked_mixture(theory, packing_fraction, dimension, diameters, fractions)
    powers = (sizes / sizes.max()) ** np.arange(dimension + 1)[:, None]
    covered = eta / float(powers[dimension] @ parts)
    unit = ((powers @ parts)[:, None] / powers).min(axis=0)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)

    def free_energy(numbers: np.ndarray) -> float:
        moments = (powers @ numbers).tolist()
        filled = covered * moments[dimension]
        inner = 0.5 * filled * (nodes + 1.0)
        integrals = [
            coefficient @ weights for coefficient in contact_coefficients(theory, inner, dimension, None)
        ]
        total = 0.5 * filled * virial_sum(integrals, moments)
        return float(2.0 ** (dimension - 1) * total / moments[dimension])

    return parts, unit, free_energy


def _gradient(
    function: Callable[[np.ndarray], float | np.ndarray], at: np.ndarray, steps: np.ndarray
) -> np.ndarray:
    """Return derivatives (S, ...) with respect to each number, by central differences of fourth order."""
    derivatives = []
    for step, shift in zip(steps, np.diag(steps), strict=True):
        near = np.subtract(function(at + shift), function(at - shift))
        far = np.subtract(function(at + 2.0 * shift), function(at - 2.0 * shift))
        derivatives.append((8.0 * near - far) / (12.0 * step))
    return np.array(derivatives)


# Structure of mixtures of additive hard spheres, from the Percus-Yevick equation.


_RADIAL_NODES = 80  # Gauss-Legendre nodes per species: exact to rounding up to k = 100 / largest diameter


@check_ranges
def percus_yevick_partial_factors(
    wave_number: Numbers, packing_fraction: float, diameters: Sizes, fractions: Sizes | None = None
) -> np.ndarray:
    """Compute the partial structure factors of a mixture of spheres, by Percus and Yevick's equation.
    Lebowitz's solution (J. L. Lebowitz, Phys. Rev. 133, A895 (1964)) in Baxter's factorised form (R. J.
    Baxter, J. Chem. Phys. 52, 4559 (1970)). The inverse matrix is Q^H Q with

        Q_ab = delta_ab - 2 pi sqrt(rho_a rho_b) int q_ab(r) e^{ikr} dr from (sigma_a - sigma_b) / 2 to
        sigma_ab,

        q_ab = a_a (r^2 - sigma_ab^2) / 2 + b_a (r - sigma_ab),

        a_a = (1 - xi_3 + 3 xi_2 sigma_a) / (1 - xi_3)^2,    b_a = -(3/2) xi_2 sigma_a^2 / (1 - xi_3)^2,

    and xi_n = (pi / 6) sum rho sigma^n. The sum of sqrt(x_a x_b) S_ab is S(k) of all particles. Tested: for
    equal spheres the result is S(k) of `percus_yevick_structure_factor`, and k = 0 gives the Percus-Yevick
    compressibility.
    """
    eta, sizes, parts = checked_mixture("santos", packing_fraction, 3, diameters, fractions)
    k = np.asarray(wave_number, dtype=float)[..., None, None, None]
    density = eta * parts / (particle_volume(3) * float(parts @ sizes**3))
    second, rest = np.pi / 6.0 * float(density @ sizes**2), 1.0 - eta
    square = ((rest + 3.0 * second * sizes) / rest**2)[:, None, None]
    slope = (-1.5 * second * sizes**2 / rest**2)[:, None, None]
    between = (0.5 * np.add.outer(sizes, sizes))[..., None]
    nodes, weights = np.polynomial.legendre.leggauss(_RADIAL_NODES)
    r = between - sizes[None, :, None] * 0.5 * (1.0 - nodes)  # from the difference of the radii
    inside = 0.5 * square * (r**2 - between**2) + slope * (r - between)
    integral = (inside * np.exp(1j * k * r)) @ weights * 0.5 * sizes[None, :]
    factor = np.eye(len(sizes)) - 2.0 * np.pi * np.sqrt(np.outer(density, density)) * integral
    return np.linalg.inv((factor.conj().swapaxes(-1, -2) @ factor).real)


# Heat transport in dilute mixtures of spheres.


@check_ranges
def dilute_mixture_conductivity(
    diameters: Sizes,
    fractions: Sizes | None = None,
    temperature: float = 1.0,
    masses: Numbers | Sizes = 1.0,
) -> float:
    """Compute the thermal conductivity of a dilute mixture of spheres, without diffusion [1/(length time)].
    Conductivity kappa, with k_B = 1. The unit of length is the unit of the diameters. The first approximation
    of Chapman and Enskog (C. Muckenfuss and C. F. Curtiss, J. Chem. Phys. 29, 1273 (1958)) is kappa = -4 x
    L^-1 x with

        L_ii = -4 x_i^2 / kappa_i - sum_k x_i x_k c_ik (15/2 m_i^2 + 13/4 m_k^2 + 4 m_i m_k),

        L_ik = x_i x_k c_ik m_i m_k (55/4 - 7),    c_ik = 16 / (25 n D_ik (m_i + m_k)^2),

        kappa_i = 75 / (64 sigma_i^2) sqrt(k_B T / (pi m_i)) for each species alone,

        n D_ik = 3 / (8 sigma_ik^2) sqrt(k_B T / (2 pi mu_ik)), with the reduced mass mu_ik.

    The ratios A and B of collision integrals are 1 for spheres. For two species the result was tested against
    the formula of Hirschfelder, Curtiss and Bird (J. O. Hirschfelder, C. F. Curtiss and R. B. Bird (1954),
    Eq. 8.2-36). For one species, higher approximations add 2.5 %.
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
