"""Chemical potentials of mixtures of additive hard discs and spheres, from their equations of state.

In units of k_B T, beyond those of an ideal gas. Arguments as in `mixtures`.
"""

from collections.abc import Callable

import numpy as np

from gaspart.theory.mixtures import Sizes, checked_mixture, contact_coefficients, virial_sum

_STEP, _WIDE = 1e-3, 1e-2
"""Steps of central differences of the free energy, and of its second derivatives, over the number of all
particles."""
_NODES = 32  # of the integral over the packing fraction


def mixture_chemical_potentials(
    packing_fraction: float,
    dimension: int,
    diameters: Sizes,
    fractions: Sizes | None = None,
    theory: str = "santos",
) -> np.ndarray:
    """(S,) mu_i / k_B T beyond an ideal gas's, of each species: the derivative of F = N k_B T integral of
    (Z - 1) / eta' from 0 to eta by the number N_i at a constant volume (exact thermodynamics), with Z of
    `mixture_compressibility_factor`. fractions: by default equal; one may be 0, of a species at infinite
    dilution. Raises SceneError as that.
    """
    parts, free_energy = _free_energy(packing_fraction, dimension, diameters, fractions, theory)
    return _gradient(free_energy, parts, _STEP)


def mixture_insertion_correction(
    packing_fraction: float, dimension: int, diameters: Sizes, counts: Sizes, theory: str = "santos"
) -> np.ndarray:
    """(S,) -ln P_i - mu_i / k_B T to first order in one over the numbers `counts` (S,): P_i is the chance
    that a random place in a periodic container of these particles is free for one more of species i.

    -ln P_i is the change of the free energy by one particle, of which that of a finite number is F + (1/2) ln
    (det G / prod N_a), G the covariances of the numbers in an open container (its saddle point, as in
    `state.finite_size_correction`; of an ideal gas G is diagonal and equal to the numbers). With H the second
    derivatives of F beyond the ideal gas's, this is

        H_ii / 2 - (1/2) d ln det(1 + N H) / dN_i,    N the diagonal matrix of the numbers.

    Of equal particles it is `insertion_finite_size_correction` (tested).
    """
    parts, free_energy = _free_energy(packing_fraction, dimension, diameters, counts, theory)

    def curvature(numbers: np.ndarray) -> np.ndarray:
        return _gradient(lambda at: _gradient(free_energy, at, _STEP), numbers, _STEP)

    def fluctuations(numbers: np.ndarray) -> float:
        return float(np.linalg.slogdet(np.eye(len(parts)) + numbers[:, None] * curvature(numbers))[1])

    total = float(np.sum(np.asarray(counts, dtype=float)))
    change = np.diag(curvature(parts)) - _gradient(fluctuations, parts, _WIDE)
    return 0.5 * change / total


def _free_energy(
    packing_fraction: float, dimension: int, diameters: Sizes, fractions: Sizes | None, theory: str
) -> tuple[np.ndarray, Callable[[np.ndarray], float]]:
    """The fractions (S,), and F / k_B T, per particle at first, of any numbers (S,) in the same volume."""
    eta, sizes, parts = checked_mixture(theory, packing_fraction, dimension, diameters, fractions)
    powers = (sizes / sizes.max()) ** np.arange(dimension + 1)[:, None]
    covered = eta / float(powers[dimension] @ parts)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)

    def free_energy(numbers: np.ndarray) -> float:
        moments = (powers @ numbers).tolist()
        filled = covered * moments[dimension]
        inner = 0.5 * filled * (nodes + 1.0)
        integrals = [one @ weights for one in contact_coefficients(theory, inner, dimension, None)]
        total = 0.5 * filled * virial_sum(integrals, moments)
        return float(2.0 ** (dimension - 1) * total / moments[dimension])

    return parts, free_energy


def _gradient(
    function: Callable[[np.ndarray], float | np.ndarray], at: np.ndarray, step: float
) -> np.ndarray:
    """(S, ...) derivatives by each of the numbers (S,), by central differences of fourth order."""
    found = []
    for shift in step * np.eye(len(at)):
        near = np.subtract(function(at + shift), function(at - shift))
        far = np.subtract(function(at + 2.0 * shift), function(at - 2.0 * shift))
        found.append((8.0 * near - far) / (12.0 * step))
    return np.array(found)
