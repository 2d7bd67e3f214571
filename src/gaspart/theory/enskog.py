"""Enskog theory of the dense gas: collision rate, mean free path and transport coefficients.

All take `packing_fraction` (number or array), dimension 2 or 3, and the particles' diameter, temperature (k_B
= 1) and mass; time is in units of diameter sqrt(mass / temperature). chi is `contact`, the pair distribution
at contact, by default `state.contact_value`: of another equation of state it is that one's, 1 in a gas of
points.
Literature: Chapman and Cowling (1970) for spheres; Gass, J. Chem. Phys. 54, 1898 (1971) for discs. Range:
that of the reference equation of state; the collision rate is exact, the transport coefficients neglect
correlated collisions (see `diffusion`).
"""

import math

import numpy as np

from gaspart.theory._arguments import Numbers, Values, checked, checked_dimension
from gaspart.theory.geometry import number_density, unit_sphere_surface
from gaspart.theory.speeds import mean_speed, mean_speed_factor
from gaspart.theory.state import compressibility_factor, contact_value, finite_size_correction

# Exact solutions of the linear Boltzmann equation over the first Sonine approximation, at zero density:
# diffusion; and viscosity and conductivity in units of diameter = mass = k_B T = 1. All derived again, by
# Sonine polynomials to the fifth (tested).
_DIFFUSION_FACTOR = {2: 1.02710, 3: 1.01895}
_DILUTE_VISCOSITY = {2: 0.28829, 3: 0.17913}
_DILUTE_CONDUCTIVITY = {2: 1.16192, 3: 0.67783}


def _density_and_contact(
    packing_fraction: Numbers, dimension: int, diameter: float, contact: Numbers | None
) -> tuple[Values, Values]:
    density = number_density(np.asarray(packing_fraction, dtype=float), dimension, diameter)
    return density, contact_value(packing_fraction, dimension) if contact is None else contact


def _kinetic(
    dilute: float, factor: float, packing_fraction: Numbers, dimension: int, contact: Numbers | None
) -> Values:
    """(dilute / chi) [1 + factor b chi / (d+2)]^2, b = 2^(d-1) times the packing fraction."""
    _, contact = _density_and_contact(packing_fraction, dimension, 1.0, contact)
    excess = 2.0 ** (dimension - 1) * np.asarray(packing_fraction) * contact
    return dilute / contact * (1.0 + factor * excess / (dimension + 2)) ** 2


def kinetic_viscosity(packing_fraction: Numbers, dimension: int, contact: Numbers | None = None) -> Values:
    """The part of `enskog_viscosity` that the kinetic stress makes, the first term, which relaxes within some
    collisions. Units: diameter = mass = k_B T = 1."""
    return _kinetic(_DILUTE_VISCOSITY[dimension], 2.0, packing_fraction, dimension, contact)


def kinetic_conductivity(packing_fraction: Numbers, dimension: int, contact: Numbers | None = None) -> Values:
    """Likewise that of `enskog_conductivity`."""
    return _kinetic(_DILUTE_CONDUCTIVITY[dimension], 3.0, packing_fraction, dimension, contact)


@checked
def collision_rate(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Collisions of one particle per time, nu = S rho sigma^(d-1) chi sqrt(k_B T / (pi m)).

    S = 2 pi (2D), 4 pi (3D), so 2 rho sigma chi sqrt(pi k_B T / m) and 4 rho sigma^2 chi sqrt(pi k_B T / m).
    Exact in equilibrium (velocities independent of positions), with the accuracy of chi. In a run: 2 N_coll /
    (N t). Unit 1 / time.
    """
    density, contact = _density_and_contact(packing_fraction, dimension, diameter, contact)
    speed = math.sqrt(temperature / (math.pi * mass))
    return unit_sphere_surface(dimension) * density * diameter ** (dimension - 1) * contact * speed


@checked
def collision_rate_finite_size_factor(packing_fraction: Numbers, dimension: int, count: int) -> Values:
    """nu_N / nu of `count` particles in a periodic container, fixed energy, total momentum zero.

    Contacts: the canonical Z_N - 1 over Z - 1 (to O(1/N), see `state.finite_size_correction`).
    Speeds: see `approach_factor`.
    """
    speeds = approach_factor(dimension, count)
    eta = np.maximum(packing_fraction, 1e-6)  # the ratio's limit, where the excess itself vanishes
    shift = finite_size_correction(eta, dimension, count, ensemble="canonical")
    return speeds * (1.0 + shift / (compressibility_factor(eta, dimension) - 1.0))


def approach_factor(dimension: int, count: int) -> float:
    """<|v_12 . n|> of `count` particles with a fixed energy E and no total momentum over Maxwell's at the
    temperature 2 E / (d N): sqrt(d N / 2) Gamma(D/2) / Gamma((D+1)/2), of velocities uniform on the sphere in
    D = d (N-1) dimensions (exact)."""
    return math.sqrt(count / (count - 1.0)) * mean_speed_factor(dimension * (count - 1))


@checked
def mean_free_path(packing_fraction: Numbers, dimension: int, diameter: float = 1.0) -> Values:
    """Mean path between collisions, <v> / nu.

    1 / (sqrt 2 pi rho sigma^2 chi) in 3D, 1 / (2 sqrt 2 rho sigma chi) in 2D.
    Exact in equilibrium, with the accuracy of chi; infinite at zero density. Unit length.
    """
    with np.errstate(divide="ignore"):
        return mean_speed(dimension) / collision_rate(packing_fraction, dimension, diameter)


@checked
def enskog_diffusion(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Self-diffusion coefficient of Enskog theory, D = c sqrt(k_B T / (pi m)) / (rho sigma^(d-1) chi).

    c = (3/8) 1.01895 in 3D, (1/2) 1.02710 in 2D (Sonine factors). 3D: exact at zero density;
    `diffusion` has the correction at higher density. 2D: D of the Enskog equation only; the true one does not
    exist (it grows like ln t). Unit length^2 / time.
    """
    density, contact = _density_and_contact(packing_fraction, dimension, diameter, contact)
    first = {2: 0.5, 3: 0.375}[dimension]
    speed = math.sqrt(temperature / (math.pi * mass))
    with np.errstate(divide="ignore"):  # infinite at zero density
        path = 1.0 / (density * diameter ** (dimension - 1) * contact)
    return first * _DIFFUSION_FACTOR[dimension] * speed * path


@checked
def enskog_bulk_viscosity(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Bulk viscosity of Enskog theory, (S / d^2) rho^2 sigma^(d+1) chi sqrt(m k_B T / pi).

    S = 2 pi (2D), 4 pi (3D). Exact within the theory: the first-order change of the collisional pressure
    under uniform expansion, in which a pair at contact has the mean normal velocity sigma div(u) / d.
    Unit mass length^(2-d) / time.
    """
    density, contact = _density_and_contact(packing_fraction, dimension, diameter, contact)
    thermal = math.sqrt(mass * temperature / math.pi)
    surface = unit_sphere_surface(dimension)
    return surface / dimension**2 * density**2 * diameter ** (dimension + 1) * contact * thermal


@checked
def enskog_viscosity(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Shear viscosity of Enskog theory, (eta_0 / chi) [1 + 2 b chi / (d+2)]^2 + bulk viscosity d / (d+2).

    b = 2^(d-1) times the packing fraction, eta_0 the dilute value (0.17913 in 3D, 0.28829 in 2D, times
    sqrt(m k_B T) / sigma^(d-1)). 3D: eta_0 [1/chi + 0.8 b + 0.7615 b^2 chi]; 2D: eta_0 [1/chi + b + 0.8729
    b^2 chi] (Gass). Good to a few per cent to eta = 0.3 (3D), too low beyond. Unit mass length^(2-d) / time.
    """
    unit = math.sqrt(mass * temperature) / diameter ** (checked_dimension(dimension) - 1)
    kinetic = unit * kinetic_viscosity(packing_fraction, dimension, contact)
    bulk = enskog_bulk_viscosity(packing_fraction, dimension, diameter, temperature, mass, contact)
    return kinetic + dimension / (dimension + 2) * bulk


@checked
def enskog_longitudinal_viscosity(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
) -> Values:
    """Viscosity against a flow along one axis that changes along it, 2 (d-1)/d shear + bulk viscosity.

    Of sound, and of a gas between a wall and a piston, where it makes heat of longitudinal viscosity times
    (du/dx)^2 in a volume and time. Unit mass length^(2-d) / time.
    """
    shear = enskog_viscosity(packing_fraction, dimension, diameter, temperature, mass)
    bulk = enskog_bulk_viscosity(packing_fraction, dimension, diameter, temperature, mass)
    return 2.0 * (dimension - 1) / dimension * shear + bulk


@checked
def enskog_conductivity(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Conductivity of heat, (lambda_0 / chi) [1 + 3 b chi / (d+2)]^2 + d / (2m) bulk viscosity (Enskog).

    b = 2^(d-1) times the packing fraction, lambda_0 the dilute value (0.67783 in 3D, 1.16192 in 2D, times
    sqrt(T / m) / sigma^(d-1)). 3D: lambda_0 [1/chi + 1.2 b + 0.7574 b^2 chi]; 2D: lambda_0 [1/chi + 1.5 b +
    0.8716 b^2 chi]. Unit 1 / (length^(d-2) time), with k_B = 1.
    """
    unit = math.sqrt(temperature / mass) / diameter ** (checked_dimension(dimension) - 1)
    kinetic = unit * kinetic_conductivity(packing_fraction, dimension, contact)
    bulk = enskog_bulk_viscosity(packing_fraction, dimension, diameter, temperature, mass, contact)
    return kinetic + 0.5 * dimension / mass * bulk


@checked
def transport_finite_size_factor(count: int, dimension: int, quantity: str) -> float:
    """A coefficient of a dilute gas of N particles at a fixed energy without total momentum, over that of an
    infinite one; quantity: "viscosity" or "conductivity".

    With D = d (N - 1), the mean square of the stress is lower by (1 - 1/N) D / (D + 2), that of the heat flux
    by (1 - 1/N)^3 D^2 / ((D + 2)(D + 4)) (moments of the uniform distribution on a sphere; to O(1/N^2)), and
    both last longer by 1 / (1 - 1/N), since a particle has N - 1 partners.
    """
    share, freedom = 1.0 - 1.0 / count, dimension * (count - 1.0)
    if quantity == "viscosity":
        return freedom / (freedom + 2.0)
    return share**2 * freedom**2 / ((freedom + 2.0) * (freedom + 4.0))
