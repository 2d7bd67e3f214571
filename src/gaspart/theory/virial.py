"""Virial coefficients of hard discs and hard spheres, and the partial sums of the series.

Z(eta) = 1 + sum over n >= 2 of b_n eta^(n-1), with b_n = B_n / v^(n-1) and v the volume of a particle.
"""

import math
from functools import cache
from pathlib import Path

import numpy as np

from gaspart.scene.sizes import CLOSE_PACKING
from gaspart.theory.geometry import Numbers, Values, checked_dimension, checked_packing_fraction

HIGHEST_ORDER = 10
"""Order up to which all virial coefficients are known."""
_TABLES = Path(__file__).parent / "data"

# b_1 to b_4, exact. Discs: B2 = 2A, B3 and B4 as in source C, Eq. 48 (Rowlinson 1964, Hemmer 1965). Spheres:
# B4 by Boltzmann: B4 / B2^3 is (2707 pi + 438 sqrt 2 - 4131 arccos(1/3)) / (4480 pi).
_EXACT = {
    2: (
        1.0,
        2.0,
        16.0 / 3.0 - 4.0 * math.sqrt(3.0) / math.pi,
        16.0 - 36.0 * math.sqrt(3.0) / math.pi + 80.0 / math.pi**2,
    ),
    3: (
        1.0,
        4.0,
        10.0,
        64.0
        * (2707.0 * math.pi + 438.0 * math.sqrt(2.0) - 4131.0 * math.acos(1.0 / 3.0))
        / (4480.0 * math.pi),
    ),
}


@cache
def _all_coefficients(dimension: int) -> tuple[np.ndarray, np.ndarray]:
    """Return all known coefficients b_n and their standard uncertainties as read-only arrays."""
    exact = np.array(_EXACT[dimension])
    order, ratio, uncertainty = np.loadtxt(
        _TABLES / f"virial_{dimension}d.csv", delimiter=",", skiprows=1, unpack=True
    )
    scale = exact[1] ** (order - 1.0)
    coefficients = np.concatenate([exact, ratio * scale])
    uncertainties = np.concatenate([np.zeros(exact.size), uncertainty * scale])
    coefficients.flags.writeable = uncertainties.flags.writeable = False
    return coefficients, uncertainties


def virial_coefficients(dimension: int, order: int = HIGHEST_ORDER) -> tuple[np.ndarray, np.ndarray]:
    """Return the virial coefficients of discs or spheres and their standard uncertainties.

    The coefficients are exact up to B4 (closed forms). B5 to B10 are from Clisby and McCoy (N. Clisby and B.
    M. McCoy, J. Stat. Phys. 122, 15 (2006)) (literature).

    Parameters
    ----------
    order : int, default 10
        Number of coefficients, from 1 to 10.

    Returns
    -------
    coefficients : ndarray, shape (order,), [1]
        Coefficients b_n of eta^(n-1), read-only; element n - 1 belongs to B_n, element 0 is 1.
    uncertainties : ndarray, shape (order,), [1]
        Standard uncertainties of b_n, read-only.

    Examples
    --------
    >>> from gaspart import theory
    >>> coefficients, uncertainties = theory.virial_coefficients(3, 5)
    >>> coefficients.round(4), uncertainties.round(4)
    (array([ 1.    ,  4.    , 10.    , 18.3648, 28.2245]), array([0.    , 0.    , 0.    , 0.    , 0.0003]))
    """
    checked_dimension(dimension)
    if not 1 <= order <= HIGHEST_ORDER:
        raise ValueError(f"order: {order} (coefficients are known from 1 to {HIGHEST_ORDER})")
    coefficients, uncertainties = _all_coefficients(dimension)
    return coefficients[:order], uncertainties[:order]


def partial_sum(packing_fraction: Numbers, order: int, dimension: int) -> Values:
    """Compute Z by the virial series up to the coefficient B_order.

    Sum of b_n eta^(n-1), n = 1 to `order`. The sum approximates Z only if the first neglected term is small.

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction eta, from 0 to close packing.
    order : int
        Order of the last coefficient, from 1 to 10.
    """
    coefficients, _ = virial_coefficients(dimension, order)
    eta = checked_packing_fraction(packing_fraction, CLOSE_PACKING[dimension])
    return np.polynomial.polynomial.polyval(eta, coefficients)


def partial_sum_uncertainty(packing_fraction: Numbers, order: int, dimension: int) -> Values:
    """Compute the standard uncertainty of `partial_sum` from independent uncertainties of the
    coefficients.
    """
    _, uncertainties = virial_coefficients(dimension, order)
    eta = checked_packing_fraction(packing_fraction, CLOSE_PACKING[dimension])
    return np.sqrt(np.polynomial.polynomial.polyval(eta**2, uncertainties**2))


def linear_tail(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the terms beyond B10, if b_n grows linearly with the last known difference. The result is a
    computed extrapolation: b_(10+k) = b_10 + k (b_10 - b_9), so the tail is eta^10 [b_10 / (1-eta) + (b_10 -
    b_9) / (1-eta)^2]. In 2D the differences converge (0.989, 0.967, 0.953, 0.944), so this is a good estimate
    up to eta = 0.65. In 3D they still grow by about 2 per order, so this is a lower bound.
    """
    coefficients, _ = virial_coefficients(dimension)
    eta = checked_packing_fraction(packing_fraction, CLOSE_PACKING[dimension])
    slope = coefficients[-1] - coefficients[-2]
    return eta**HIGHEST_ORDER * (coefficients[-1] / (1.0 - eta) + slope / (1.0 - eta) ** 2)


def linear_tail_uncertainty(packing_fraction: Numbers, dimension: int) -> Values:
    """Compute the standard uncertainty of `linear_tail`."""
    coefficients, uncertainties = virial_coefficients(dimension)
    eta = checked_packing_fraction(packing_fraction, CLOSE_PACKING[dimension])
    last_change = coefficients[-1] - 2.0 * coefficients[-2] + coefficients[-3]
    slope_uncertainty = np.hypot(last_change, uncertainties[-1])
    level = uncertainties[-1] / (1.0 - eta)
    return eta**HIGHEST_ORDER * np.hypot(level, slope_uncertainty / (1.0 - eta) ** 2)
