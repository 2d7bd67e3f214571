"""Mixtures of additive hard discs and spheres: equations of state, contact values, collision rates.

All functions take the packing fraction (a number) of the mixture, the diameters (S,) of its species in any
unit, and their number fractions (S,), which are normalised. A polydisperse gas is a mixture with one species
per particle size. In every theory here, the contact value is a polynomial in

    z_ij = sigma_i sigma_j / sigma_ij <sigma^(d-1)> / <sigma^d>,    sigma_ij = (sigma_i + sigma_j) / 2,

whose coefficients depend only on the packing fraction (the "universality" of Santos, Yuste and Lopez de Haro
2002). The virial theorem then gives Z from moments of the diameters. All theories are exact up to the second
virial coefficient, and for point particles (z = 0), where g = 1 / (1 - eta). "santos" is also exact for equal
sizes (z = 1), up to the uncertainty of the reference equation of the pure fluid.
"""

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from gaspart.errors import SceneError
from gaspart.theory.geometry import (
    Numbers,
    check_ranges,
    checked_dimension,
    checked_packing_fraction,
    particle_volume,
    unit_sphere_surface,
)
from gaspart.theory.state import HIGHEST_PACKING_FRACTION, contact_value

MIXTURE_THEORIES = {"boublik": (3,), "linear": (2, 3), "santos": (2, 3)}
"""Theories of mixtures and the dimensions in which they exist (see `mixture_contact_values`)."""
Sizes: TypeAlias = Sequence[float] | np.ndarray
"""Positive numbers, shape (S,)."""


def contact_coefficients(theory: str, eta: Numbers, dimension: int, pure: Numbers | None) -> tuple[Any, ...]:
    """Compute the coefficients of the powers of z in the contact values of a theory."""
    point = 1.0 / (1.0 - eta)
    if theory == "boublik":
        return point, 1.5 * eta * point**2, 0.5 * eta**2 * point**3
    pure = contact_value(eta, dimension)[()] if pure is None else pure
    if theory == "linear":
        return point, pure - point
    wall = 1.0 + 2.0 ** (dimension - 1) * eta * pure  # Z of the pure fluid: the contact value at a hard wall
    square = 0.5 * (wall + point) - pure
    return point, pure - point - square, square


def checked_mixture(
    theory: str, packing_fraction: float, dimension: int, diameters: Sizes, fractions: Sizes | None
) -> tuple[float, np.ndarray, np.ndarray]:
    """Return the arguments of a mixture as floats and arrays, if they are in range."""
    highest = HIGHEST_PACKING_FRACTION[checked_dimension(dimension)]
    if dimension not in MIXTURE_THEORIES.get(theory, ()):
        names = [name for name, where in MIXTURE_THEORIES.items() if dimension in where]
        raise SceneError("theory", theory, f"must be one of {', '.join(names)} in {dimension} dimensions")
    eta = float(checked_packing_fraction(packing_fraction, highest))
    sizes = _numbers("diameters", diameters)
    if not (sizes > 0.0).all():
        raise SceneError("diameters", float(sizes.min()), "must be positive")
    parts = np.ones(len(sizes)) if fractions is None else _numbers("fractions", fractions)
    if len(parts) != len(sizes):
        raise SceneError("fractions", len(parts), f"there are {len(sizes)} diameters")
    if not (parts >= 0.0).all() or not parts.any():
        raise SceneError("fractions", float(parts.min()), "must not be negative, nor all zero")
    return eta, sizes, parts / parts.sum()


def _numbers(name: str, values: Sizes) -> np.ndarray:
    """Return a list of numbers as (S,) floats; raise SceneError unless all are finite."""
    numbers = np.atleast_1d(np.asarray(values, dtype=float))
    if numbers.ndim != 1 or not len(numbers) or not np.isfinite(numbers).all():
        raise SceneError(name, values, "must be a list of finite numbers")
    return numbers


def _moment(parts: np.ndarray, sizes: np.ndarray, power: int) -> float:
    """Return the mean of a power of the diameters, with a single rounding. Sums of BLAS depend on the
    processor, and this mean determines the lengths of runs.
    """
    return math.fsum(parts * np.prod([sizes] * power, axis=0)) if power else math.fsum(parts)


def mixture_compressibility_factor(
    packing_fraction: float,
    dimension: int,
    diameters: Sizes,
    fractions: Sizes | None = None,
    theory: str = "santos",
    pure: float | None = None,
) -> float:
    """Compute the compressibility factor Z of a mixture.

    Z = 1 + 2^(d-1) eta sum_ij x_i x_j sigma_ij^d g_ij / <sigma^d> (virial theorem, exact), with the contact
    values of `mixture_contact_values`. "boublik" is the equation of Boublik (T. Boublik, J. Chem. Phys. 53,
    471 (1970)) and of Mansoori, Carnahan, Starling and Leland (G. A. Mansoori and others, J. Chem. Phys. 54,
    1523 (1971)) (tested against its closed form). "linear" is the equation of Santos, Yuste and Lopez de Haro
    (A. Santos, S. B. Yuste and M. Lopez de Haro, Mol. Phys. 96, 1 (1999)); in two dimensions "santos" gives
    the same Z (tested).

    Parameters
    ----------
    theory : {"santos", "linear", "boublik"}, default "santos"
        Theory of the contact values; "boublik" exists for spheres only.
    pure : float, optional, [1]
        Contact value of equal particles at this packing fraction. Default: the reference, `contact_value`.
    """
    eta, sizes, parts = checked_mixture(theory, packing_fraction, dimension, diameters, fractions)
    sizes = sizes / sizes.max()
    moments = [_moment(parts, sizes, power) for power in range(dimension + 1)]
    total = virial_sum(contact_coefficients(theory, eta, dimension, pure), moments)
    return 1.0 + 2.0 ** (dimension - 1) * eta * total / moments[dimension]


def virial_sum(coefficients: Sequence[float], moments: Sequence[float]) -> float:
    """Compute the mean of sigma_ij^d g_ij over pairs, for a polynomial g_ij in z_ij."""
    dimension = len(moments) - 1
    ratio, total = moments[dimension - 1] / moments[dimension], 0.0
    for power, coefficient in enumerate(coefficients):
        rest = dimension - power  # <sigma_i^k sigma_j^k sigma_ij^(d-k)>, from the binomial theorem
        terms = (math.comb(rest, n) * moments[power + n] * moments[dimension - n] for n in range(rest + 1))
        total += coefficient * ratio**power * sum(terms) / 2.0**rest
    return total


def mixture_contact_values(
    packing_fraction: float,
    dimension: int,
    diameters: Sizes,
    fractions: Sizes | None = None,
    theory: str = "santos",
    pure: float | None = None,
) -> np.ndarray:
    """Compute the pair distribution at contact of each pair of species of a mixture.

    - "boublik": 1 / (1 - eta) + (3/2) eta z / (1 - eta)^2 + (1/2) eta^2 z^2 / (1 - eta)^3, with z as defined
      in the module `mixtures` (T. Boublik (1970); E. W. Grundke and D. Henderson (1972); L. L. Lee and D.
      Levesque (1973)).
    - "linear": a straight line in z, through the contact value of equal particles (`contact_value`) at z = 1
      (A. Santos, S. B. Yuste and M. Lopez de Haro (1999)).
    - "santos": a parabola through the values at z = 0 and z = 1 and through the exact contact value at a hard
      wall, z = 2, by the same authors (J. Chem. Phys. 117, 5785 (2002)).

    Parameters
    ----------
    theory : {"santos", "linear", "boublik"}, default "santos"
        Theory; "boublik" exists for spheres only.
    pure : float, optional, [1]
        Contact value of equal particles at this packing fraction. Default: the reference, `contact_value`.

    Returns
    -------
    ndarray, shape (S, S), [1]
        Contact values g_ij.
    """
    eta, sizes, parts = checked_mixture(theory, packing_fraction, dimension, diameters, fractions)
    sizes = sizes / sizes.max()
    ratio = _moment(parts, sizes, dimension - 1) / _moment(parts, sizes, dimension)
    z = 2.0 * np.outer(sizes, sizes) / np.add.outer(sizes, sizes) * ratio
    return np.polynomial.polynomial.polyval(z, contact_coefficients(theory, eta, dimension, pure))


@check_ranges
def mixture_collision_rates(
    packing_fraction: float,
    dimension: int,
    diameters: Sizes,
    fractions: Sizes | None = None,
    theory: str = "santos",
    temperature: float = 1.0,
    masses: Numbers | Sizes = 1.0,
    contact: np.ndarray | None = None,
) -> np.ndarray:
    """Compute the collision rates of each pair of species of a mixture in equilibrium.

    S rho_j sigma_ij^(d-1) g_ij sqrt(k_B T / (2 pi mu_ij)), with S = 2 pi (2D) or 4 pi (3D) and the reduced
    mass mu_ij. The formula is exact if the contact values are exact (S. Chapman and T. G. Cowling (1970)).

    Parameters
    ----------
    contact : ndarray, shape (S, S), optional, [1]
        Contact values g_ij, instead of the theory's.

    Returns
    -------
    ndarray, shape (S, S), [1/time]
        Collisions of one particle of species i with all particles of species j per time. The sum over j is
        the collision rate of a particle.
    """
    if contact is None:
        contact = mixture_contact_values(packing_fraction, dimension, diameters, fractions, theory)
    _, sizes, parts = checked_mixture(theory, packing_fraction, dimension, diameters, fractions)
    each = _numbers("masses", np.atleast_1d(masses))
    if not (each > 0.0).all():
        raise SceneError("masses", float(each.min()), "must be positive")
    if len(each) not in (1, len(sizes)):
        raise SceneError("masses", len(each), f"there are {len(sizes)} diameters")
    inverse = np.broadcast_to(1.0 / each, sizes.shape)
    densities = packing_fraction * parts / (particle_volume(dimension) * _moment(parts, sizes, dimension))
    speeds = np.sqrt(temperature * np.add.outer(inverse, inverse) / (2.0 * math.pi))
    between = 0.5 * np.add.outer(sizes, sizes)
    return unit_sphere_surface(dimension) * densities * between ** (dimension - 1) * speeds * contact


@check_ranges
def enskog_mutual_diffusion(
    packing_fraction: float,
    dimension: int,
    diameters: Sizes,
    fractions: Sizes | None = None,
    theory: str = "santos",
    temperature: float = 1.0,
    masses: Numbers | Sizes = 1.0,
    contact: np.ndarray | None = None,
) -> float:
    """Compute the Maxwell-Stefan coefficient of mutual diffusion of two species [length^2/time].

    Coefficient D_12. The unit of length is the unit of the diameters. Enskog's coefficient in the first
    Sonine approximation (S. Chapman and T. G. Cowling (1970), Eqs. 9.81 and 16.9) is

        D_12 = d k_B T x_2 / (4 mu_12 nu_12),

    with nu_12 of `mixture_collision_rates` and the reduced mass mu_12. For spheres it is 3 / (8 n sigma_12^2
    g_12) sqrt(k_B T / (2 pi mu_12)). The coefficient does not include the thermodynamic factor. Higher
    approximations add 2 % for equal masses, up to 13 % for a few light particles among heavy ones.

    Parameters
    ----------
    diameters : array_like, shape (2,), [length]
        Diameters of both species.
    masses : float or array_like, shape (2,), default 1.0, [mass]
        Masses of the particles: a number for both species, or one for each.
    contact : ndarray, shape (2, 2), optional, [1]
        Contact values g_ij, instead of the theory's.
    """
    rates = mixture_collision_rates(
        packing_fraction, dimension, diameters, fractions, theory, temperature, masses, contact
    )
    if len(rates) != 2:
        raise SceneError("diameters", len(rates), "mutual diffusion is that of two species")
    _, _, parts = checked_mixture(theory, packing_fraction, dimension, diameters, fractions)
    inverse = np.broadcast_to(1.0 / _numbers("masses", np.atleast_1d(masses)), parts.shape).sum()
    return float(0.25 * dimension * temperature * inverse * parts[1] / rates[0, 1])
