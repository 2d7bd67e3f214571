"""Chemical potential of the fluid, from the reference equation of state.

In units of k_B T, beyond that of an ideal gas; the activity is eta e^{mu_excess}, which is eta when dilute.
"""

from functools import cache

import numpy as np

from gaspart.theory._arguments import Numbers, Values, checked, checked_dimension, checked_packing_fraction
from gaspart.theory.state import (
    HIGHEST_PACKING_FRACTION,
    compressibility_factor,
    compressibility_uncertainty,
    contact_value,
    reduced_compressibility,
)

_LOWEST = 1e-9
"""Packing fraction below which the fluid is an ideal gas to nine digits."""
_STEP = 2e-3  # of central differences of the compressibility


def excess_free_energy(packing_fraction: Numbers, dimension: int) -> Values:
    """F_excess / (N k_B T), the integral from 0 to eta of (Z - 1) / eta' (exact thermodynamics).

    Z is `compressibility_factor` (same range, same shape); the integral is by Gauss and Legendre. N times its
    negative is the logarithm of the configuration integral Q of source C, Eq. 46, of a large container.
    """
    eta = checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    nodes, weights = np.polynomial.legendre.leggauss(40)
    inner = 0.5 * eta[..., None] * (nodes + 1.0)
    return 0.5 * eta * 2.0 ** (dimension - 1) * (contact_value(inner, dimension) @ weights)


def excess_chemical_potential(packing_fraction: Numbers, dimension: int) -> Values:
    """mu_excess / (k_B T) = Z - 1 + `excess_free_energy` (exact thermodynamics; same range, same shape)."""
    excess = compressibility_factor(packing_fraction, dimension) - 1.0
    return excess + excess_free_energy(packing_fraction, dimension)


def chemical_potential_uncertainty(packing_fraction: Numbers, dimension: int) -> Values:
    """Standard uncertainty of `excess_chemical_potential`: that of Z at this packing fraction and below, of
    one sign throughout (computed estimate; same range, same shape)."""
    eta = checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    nodes, weights = np.polynomial.legendre.leggauss(40)
    inner = 0.5 * eta[..., None] * (nodes + 1.0)
    below = (compressibility_uncertainty(inner, dimension) / (nodes + 1.0)) @ weights
    return compressibility_uncertainty(eta, dimension) + below


def activity(packing_fraction: Numbers, dimension: int) -> Values:
    """eta exp(mu_excess / k_B T), by `excess_chemical_potential` (same range, same shape); the inverse is
    `packing_fraction_at`."""
    return np.asarray(packing_fraction) * np.exp(excess_chemical_potential(packing_fraction, dimension))


@checked
def insertion_finite_size_correction(packing_fraction: Numbers, dimension: int, count: int) -> Values:
    """-ln P_N - mu_excess / (k_B T), to first order in 1/N: P_N is the chance that a random place in a
    periodic container of N particles is free for another one.

    With the configuration integral Q_N as in `state.finite_size_correction`, P_N = Q_(N+1) / (V Q_N) is

        (1 / 2N) [1 / S - 1 + eta S' / S],    S = `reduced_compressibility`, S' its derivative by eta

    (Siepmann, McDonald and Frenkel, J. Phys.: Condens. Matter 4, 679 (1992)). Zero in first order in the
    density, as is exact.
    """
    highest = HIGHEST_PACKING_FRACTION[checked_dimension(dimension)]
    eta = np.clip(checked_packing_fraction(packing_fraction, highest), _STEP, highest - _STEP)
    s = reduced_compressibility(eta, dimension)
    low, high = (reduced_compressibility(eta + step, dimension) for step in (-_STEP, _STEP))
    slope = (high - low) / (2.0 * _STEP)
    return 0.5 / count * (1.0 / s - 1.0 + eta * slope / s)


@cache
def _table(dimension: int) -> tuple[np.ndarray, np.ndarray]:
    """(ln eta, ln activity) from `_LOWEST` to the end of the reference."""
    eta = np.geomspace(_LOWEST, HIGHEST_PACKING_FRACTION[dimension], 12001)
    eta[-1] = HIGHEST_PACKING_FRACTION[dimension]
    return np.log(eta), np.log(eta) + excess_chemical_potential(eta, dimension)


@checked
def packing_fraction_at(activity: Numbers, dimension: int) -> Values:
    """The packing fraction at which eta e^{mu_excess} is `activity` (number or array, > 0; to 1e-5 of it).

    Raises ValueError where that is above the reference's range.
    """
    activity = np.asarray(activity, dtype=float)
    eta, table = _table(checked_dimension(dimension))
    if np.any(np.log(activity) > table[-1]):
        raise ValueError(f"activity: {np.max(activity):g} (above the reference's range)")
    return np.where(activity < _LOWEST, activity, np.exp(np.interp(np.log(activity), table, eta)))
