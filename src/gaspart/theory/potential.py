"""Chemical potential of the fluid, from the reference equation of state.

In units of k_B T, beyond that of an ideal gas; the activity is eta e^{mu_excess}, which is eta when dilute.
"""

from functools import cache

import numpy as np

from ._arguments import Numbers, Values, checked, checked_dimension, checked_packing_fraction
from .state import HIGHEST_PACKING_FRACTION, compressibility_factor, contact_value

_LOWEST = 1e-9
"""Packing fraction below which the fluid is an ideal gas to nine digits."""


def excess_chemical_potential(packing_fraction: Numbers, dimension: int) -> Values:
    """mu_excess / (k_B T) = Z - 1 + integral from 0 to eta of (Z - 1) / eta' (exact thermodynamics).

    Z is `compressibility_factor` (same range, same shape); the integral is by Gauss and Legendre.
    """
    eta = checked_packing_fraction(packing_fraction, HIGHEST_PACKING_FRACTION[checked_dimension(dimension)])
    nodes, weights = np.polynomial.legendre.leggauss(40)
    inner = 0.5 * eta[..., None] * (nodes + 1.0)
    integral = 0.5 * eta * 2.0 ** (dimension - 1) * (contact_value(inner, dimension) @ weights)
    return compressibility_factor(eta, dimension) - 1.0 + integral


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
