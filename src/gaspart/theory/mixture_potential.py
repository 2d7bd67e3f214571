"""Chemical potentials of mixtures of additive hard discs and spheres, from their equations of state.

They are in units of k_B T, beyond the potentials of an ideal gas. Arguments are as in `mixtures`.
"""

from collections.abc import Callable

import numpy as np

from gaspart.theory.mixtures import Sizes, checked_mixture, contact_coefficients, virial_sum

_STEP, _WIDE = 1e-3, 1e-2
"""Steps of central differences of the free energy, and of its second derivatives, divided by the number of
all particles.
"""
_NODES = 32  # of the integral over the packing fraction


def mixture_chemical_potentials(
    packing_fraction: float,
    dimension: int,
    diameters: Sizes,
    fractions: Sizes | None = None,
    theory: str = "santos",
) -> np.ndarray:
    """Compute the excess chemical potential of each species of a mixture.

    Parameters
    ----------
    packing_fraction : float, [1]
        Packing fraction eta, from 0 to 0.70 for discs, to 0.539 for spheres.
    dimension : {2, 3}
        Discs or spheres.
    diameters : array_like, shape (S,), [length]
        Diameters of the species, in any unit.
    fractions : array_like, shape (S,), optional, [1]
        Number fractions, which are normalised. Default: equal. One may be 0: a species at infinite dilution.
    theory : {"santos", "linear", "boublik"}, default "santos"
        Equation of state, as for `mixture_compressibility_factor`.

    Returns
    -------
    ndarray, shape (S,), [1]
        Potentials mu_i / k_B T, beyond an ideal gas.

    Raises
    ------
    SceneError
        If an argument is out of range, as for `mixture_compressibility_factor`.

    Notes
    -----
    The derivative of F = N k_B T int_0^eta (Z - 1) / eta' d eta' by the number N_i at a constant volume
    (exact thermodynamics), with Z of `mixture_compressibility_factor`.

    Examples
    --------
    >>> from gaspart import theory
    >>> theory.mixture_chemical_potentials(0.3, 3, [1.0, 2.0]).round(3)
    array([1.969, 6.307])
    """
    parts, free_energy = _free_energy(packing_fraction, dimension, diameters, fractions, theory)
    return _gradient(free_energy, parts, _STEP)


def mixture_insertion_correction(
    packing_fraction: float, dimension: int, diameters: Sizes, counts: Sizes, theory: str = "santos"
) -> np.ndarray:
    """Compute the shift of the insertion potential in a periodic container of finite numbers.

    Parameters
    ----------
    packing_fraction : float, [1]
        Packing fraction eta, from 0 to 0.70 for discs, to 0.539 for spheres.
    dimension : {2, 3}
        Discs or spheres.
    diameters : array_like, shape (S,), [length]
        Diameters of the species, in any unit.
    counts : array_like, shape (S,)
        Numbers of particles of the species.
    theory : {"santos", "linear", "boublik"}, default "santos"
        Equation of state, as for `mixture_compressibility_factor`.

    Returns
    -------
    ndarray, shape (S,), [1]
        -ln P_i - mu_i / k_B T to the first order in 1 divided by the numbers. P_i is the chance that a random
        position in the container is free for one more particle of species i.

    Raises
    ------
    SceneError
        If an argument is out of range, as for `mixture_compressibility_factor`.

    See Also
    --------
    insertion_finite_size_correction : Correction for equal particles, which agrees (tested).

    Notes
    -----
    -ln P_i is the change of the free energy by one particle. The free energy of finite numbers is F + (1/2)
    ln(det G / prod N_a), where G are the covariances of the numbers in an open container: its saddle point,
    as in `state.finite_size_correction`. In an ideal gas G is diagonal and equal to the numbers. With H the
    second derivatives of F beyond the ideal gas, the result is

        H_ii / 2 - (1/2) d ln det(1 + N H) / dN_i,    N the diagonal matrix of the numbers.

    Examples
    --------
    >>> from gaspart import theory
    >>> theory.mixture_insertion_correction(0.3, 3, [1.0, 2.0], [50, 50]).round(4)
    array([0.0038, 0.0738])
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
    """Return the fractions (S,), and F / k_B T as a function of numbers (S,).

    The volume stays the same. F is per particle at first: at numbers equal to the fractions.
    """
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
    """Return (S, ...) derivatives by each of the numbers, by central differences of fourth order."""
    found = []
    for shift in step * np.eye(len(at)):
        near = np.subtract(function(at + shift), function(at - shift))
        far = np.subtract(function(at + 2.0 * shift), function(at - 2.0 * shift))
        found.append((8.0 * near - far) / (12.0 * step))
    return np.array(found)
