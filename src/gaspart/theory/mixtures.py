"""Mixtures of additive hard discs and spheres: equations of state, contact values, collision rates.

All take the packing fraction (a number) of the mixture, the diameters (S,) of its species in any unit and
their number fractions (S,), which are normalised; a polydisperse gas is a mixture of as many species as
there are sizes. In every theory here a contact value is a polynomial in

    z_ij = sigma_i sigma_j / sigma_ij <sigma^(d-1)> / <sigma^d>,    sigma_ij = (sigma_i + sigma_j) / 2,

whose coefficients depend on the packing fraction alone (Santos, Yuste and Lopez de Haro 2002: their
"universality"); the virial theorem then gives Z in terms of moments of the diameters. All are exact to the
second virial coefficient and for point particles (z = 0), where g = 1 / (1 - eta); "santos" also for equal
sizes (z = 1), up to the uncertainty of the pure fluid's reference.
"""

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from gaspart.errors import SceneError
from gaspart.theory._arguments import Numbers, checked, checked_dimension, checked_packing_fraction
from gaspart.theory.geometry import particle_volume, unit_sphere_surface
from gaspart.theory.state import HIGHEST_PACKING_FRACTION, contact_value

MIXTURE_THEORIES = {"boublik": (3,), "linear": (2, 3), "santos": (2, 3)}
"""Theories of mixtures and the dimensions in which they exist (see `mixture_contact_values`)."""
Sizes: TypeAlias = Sequence[float] | np.ndarray
"""(S,) positive numbers."""


def contact_coefficients(theory: str, eta: Numbers, dimension: int, pure: Numbers | None) -> tuple[Any, ...]:
    """Of the powers of z in the contact values; pure: that of equal particles."""
    point = 1.0 / (1.0 - eta)
    if theory == "boublik":
        return point, 1.5 * eta * point**2, 0.5 * eta**2 * point**3
    pure = contact_value(eta, dimension)[()] if pure is None else pure
    if theory == "linear":
        return point, pure - point
    wall = 1.0 + 2.0 ** (dimension - 1) * eta * pure  # of a fluid of equal particles at a hard wall: its Z
    square = 0.5 * (wall + point) - pure
    return point, pure - point - square, square


def checked_mixture(
    theory: str, packing_fraction: float, dimension: int, diameters: Sizes, fractions: Sizes | None
) -> tuple[float, np.ndarray, np.ndarray]:
    """The packing fraction, diameters (S,) and normalised fractions (S,). Raises SceneError."""
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
    """(S,) finite floats."""
    numbers = np.atleast_1d(np.asarray(values, dtype=float))
    if numbers.ndim != 1 or not len(numbers) or not np.isfinite(numbers).all():
        raise SceneError(name, values, "must be a list of finite numbers")
    return numbers


def _moment(parts: np.ndarray, sizes: np.ndarray, power: int) -> float:
    """The mean of a power of the diameters, rounded once: that of BLAS depends on the processor, and lengths
    of runs follow from it."""
    return math.fsum(parts * np.prod([sizes] * power, axis=0)) if power else math.fsum(parts)


def mixture_compressibility_factor(
    packing_fraction: float,
    dimension: int,
    diameters: Sizes,
    fractions: Sizes | None = None,
    theory: str = "santos",
    pure: float | None = None,
) -> float:
    """Z of a mixture, Z = 1 + 2^(d-1) eta sum_ij x_i x_j sigma_ij^d g_ij / <sigma^d> (virial theorem, exact),
    with the contact values of `mixture_contact_values`. fractions: by default equal; pure: the contact value
    of equal particles at this packing fraction, by default that of the reference.

    "boublik" is the equation of Boublik, J. Chem. Phys. 53, 471 (1970), and Mansoori, Carnahan, Starling and
    Leland, J. Chem. Phys. 54, 1523 (1971) (tested against its closed form). "linear" is that of Santos,
    Yuste and Lopez de Haro, Mol. Phys. 96, 1 (1999); in two dimensions "santos" gives the same Z (tested).
    Raises SceneError for an argument out of range; packing fractions end where the pure fluid's reference
    does.
    """
    eta, sizes, parts = checked_mixture(theory, packing_fraction, dimension, diameters, fractions)
    sizes = sizes / sizes.max()
    moments = [_moment(parts, sizes, power) for power in range(dimension + 1)]
    total = virial_sum(contact_coefficients(theory, eta, dimension, pure), moments)
    return 1.0 + 2.0 ** (dimension - 1) * eta * total / moments[dimension]


def virial_sum(coefficients: Sequence[float], moments: Sequence[float]) -> float:
    """The mean over pairs of sigma_ij^d g_ij, with g_ij the polynomial in z_ij of these coefficients, from
    the moments <sigma^n> of the diameters, n from 0 to d."""
    dimension = len(moments) - 1
    ratio, total = moments[dimension - 1] / moments[dimension], 0.0
    for power, coefficient in enumerate(coefficients):
        rest = dimension - power  # <sigma_i^k sigma_j^k sigma_ij^(d-k)>, by the binomial theorem
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
    """(S, S) pair distributions g_ij at contact.

    "boublik" (spheres): 1 / (1 - eta) + (3/2) eta z / (1 - eta)^2 + (1/2) eta^2 z^2 / (1 - eta)^3, by
    Boublik (1970), Grundke and Henderson (1972) and Lee and Levesque (1973). "linear": that of equal
    particles from `contact_value` at z = 1 and a straight line in z, by Santos, Yuste and Lopez de Haro
    (1999). "santos": a parabola through both and through the exact contact value at a hard wall, z = 2, by
    the same authors, J. Chem. Phys. 117, 5785 (2002). Arguments as in `mixture_compressibility_factor`.
    """
    eta, sizes, parts = checked_mixture(theory, packing_fraction, dimension, diameters, fractions)
    sizes = sizes / sizes.max()
    ratio = _moment(parts, sizes, dimension - 1) / _moment(parts, sizes, dimension)
    z = 2.0 * np.outer(sizes, sizes) / np.add.outer(sizes, sizes) * ratio
    return np.polynomial.polynomial.polyval(z, contact_coefficients(theory, eta, dimension, pure))


@checked
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
    """(S, S) collisions of one particle of species i with those of species j per time, of a mixture in
    equilibrium: S rho_j sigma_ij^(d-1) g_ij sqrt(k_B T / (2 pi mu_ij)).

    S = 2 pi (2D), 4 pi (3D); mu_ij the reduced mass. Exact with exact contact values (Chapman and Cowling
    1970): the sum over j is the collision rate of a particle. masses: one for all, or (S,); contact: g_ij (S,
    S) in place of the theory's. Other arguments as in `mixture_compressibility_factor`. Unit 1 / time.
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


@checked
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
    """Coefficient of mutual diffusion of two species by Maxwell and Stefan, in length^2 / time: Enskog's in
    the first approximation of Sonine polynomials,

        D_12 = d k_B T x_2 / (4 mu_12 nu_12),

    nu_12 of `mixture_collision_rates`; for spheres 3 / (8 n sigma_12^2 g_12) sqrt(k_B T / (2 pi mu_12))
    (Chapman and Cowling 1970, 9.81 and 16.9; without the thermodynamic factor). Arguments as there; the unit
    of length is that of the diameters. Higher approximations add 2 % for equal masses, up to 13 % for a few
    light particles among heavy ones. Raises SceneError as that, and for other numbers of species than two.
    """
    rates = mixture_collision_rates(
        packing_fraction, dimension, diameters, fractions, theory, temperature, masses, contact
    )
    if len(rates) != 2:
        raise SceneError("diameters", len(rates), "mutual diffusion is that of two species")
    _, _, parts = checked_mixture(theory, packing_fraction, dimension, diameters, fractions)
    inverse = np.broadcast_to(1.0 / _numbers("masses", np.atleast_1d(masses)), parts.shape).sum()
    return float(0.25 * dimension * temperature * inverse * parts[1] / rates[0, 1])
