"""Enskog theory of the dense gas: collision rate, mean free path and transport coefficients.

All functions take `packing_fraction` (number or array), dimension 2 or 3, and the diameter, temperature (k_B
= 1) and mass of the particles. Time is in units of diameter sqrt(mass / temperature). chi is `contact`, the
pair distribution at contact; the default is `state.contact_value`. `contact` may be the contact value of
another equation of state, or 1 for a gas of points. Literature: Chapman and Cowling (1970) for spheres; Gass,
J. Chem. Phys. 54, 1898 (1971) for discs. The range is the range of the reference equation of state. The
collision rate is exact. The transport coefficients neglect correlated collisions (see `diffusion`).
"""

import math

import numpy as np

from gaspart.theory.geometry import (
    Numbers,
    Values,
    check_ranges,
    checked_dimension,
    number_density,
    unit_sphere_surface,
)
from gaspart.theory.speeds import maxwell_pdf, mean_speed, mean_speed_factor
from gaspart.theory.state import compressibility_factor, contact_value, finite_size_correction

# Exact solutions of the linear Boltzmann equation divided by the first Sonine approximation, at zero density:
# diffusion. Viscosity and conductivity, in units of diameter = mass = k_B T = 1. All values were derived
# again with Sonine polynomials up to the fifth (tested).
_DIFFUSION_FACTOR = {2: 1.02710, 3: 1.01895}
_DILUTE_VISCOSITY = {2: 0.28829, 3: 0.17913}
_DILUTE_CONDUCTIVITY = {2: 1.16192, 3: 0.67783}


def _density_and_contact(
    packing_fraction: Numbers, dimension: int, diameter: float, contact: Numbers | None
) -> tuple[Values, Values]:
    """Return the number density and the contact value, by default of the reference fluid."""
    density = number_density(np.asarray(packing_fraction, dtype=float), dimension, diameter)
    return density, contact_value(packing_fraction, dimension) if contact is None else contact


def _kinetic(
    dilute: float, factor: float, packing_fraction: Numbers, dimension: int, contact: Numbers | None
) -> Values:
    """Compute the kinetic part, (dilute / chi) [1 + factor b chi / (d+2)]^2 with b = 2^(d-1) eta."""
    _, contact = _density_and_contact(packing_fraction, dimension, 1.0, contact)
    excess = 2.0 ** (dimension - 1) * np.asarray(packing_fraction) * contact
    return dilute / contact * (1.0 + factor * excess / (dimension + 2)) ** 2


def kinetic_viscosity(packing_fraction: Numbers, dimension: int, contact: Numbers | None = None) -> Values:
    """Compute the contribution of the kinetic stress to `enskog_viscosity`."""
    return _kinetic(_DILUTE_VISCOSITY[dimension], 2.0, packing_fraction, dimension, contact)


def kinetic_conductivity(packing_fraction: Numbers, dimension: int, contact: Numbers | None = None) -> Values:
    """Compute the contribution of the kinetic heat flux to `enskog_conductivity`."""
    return _kinetic(_DILUTE_CONDUCTIVITY[dimension], 3.0, packing_fraction, dimension, contact)


@check_ranges
def collision_rate(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Compute the number of collisions of a particle per time [1/time].

    nu = S rho sigma^(d-1) chi sqrt(k_B T / (pi m)), with S = 2 pi in 2D and 4 pi in 3D. This is 2 rho sigma
    chi sqrt(pi k_B T / m) in 2D and 4 rho sigma^2 chi sqrt(pi k_B T / m) in 3D. The formula is exact in
    equilibrium, apart from the accuracy of chi, because velocities are independent of positions. In a run of
    N particles, nu = 2 N_coll / (N t).
    """
    density, contact = _density_and_contact(packing_fraction, dimension, diameter, contact)
    speed = math.sqrt(temperature / (math.pi * mass))
    return unit_sphere_surface(dimension) * density * diameter ** (dimension - 1) * contact * speed


@check_ranges
def collision_rate_finite_size_factor(packing_fraction: Numbers, dimension: int, count: int) -> Values:
    """Compute the collision rate of N particles divided by its value in the infinite system.

    The ratio is the product of two factors. The change of the contact value is the canonical Z_N - 1 divided
    by Z - 1, to first order in 1/N (see `finite_size_correction`). The change of the mean relative speed is
    `enskog.approach_factor`.

    Parameters
    ----------
    count : int
        Number N of particles in a periodic container, with a fixed energy and zero total momentum.
    """
    speeds = approach_factor(dimension, count)
    eta = np.maximum(packing_fraction, 1e-6)  # limit of the ratio, where the excess itself vanishes
    shift = finite_size_correction(eta, dimension, count, ensemble="canonical")
    return speeds * (1.0 + shift / (compressibility_factor(eta, dimension) - 1.0))


def approach_factor(dimension: int, count: int) -> float:
    """Compute the mean speed of approach among N particles divided by its Maxwellian value."""
    return math.sqrt(count / (count - 1.0)) * mean_speed_factor(dimension * (count - 1))


@check_ranges
def mean_free_path(
    packing_fraction: Numbers, dimension: int, diameter: float = 1.0, contact: Numbers | None = None
) -> Values:
    """Compute the mean path of a particle between collisions [length].

    Mean free path; infinite at zero density. The mean free path is the mean speed divided by the collision
    rate: 1 / (sqrt 2 pi rho sigma^2 chi) in 3D, and 1 / (2 sqrt 2 rho sigma chi) in 2D. The formula is exact
    in equilibrium, apart from the accuracy of chi.
    """
    with np.errstate(divide="ignore"):
        rate = collision_rate(packing_fraction, dimension, diameter, contact=contact)
        return mean_speed(dimension) / rate


@check_ranges
def enskog_diffusion(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Compute the self-diffusion coefficient of Enskog theory [length^2/time].

    Self-diffusion coefficient D; infinite at zero density. D = c sqrt(k_B T / (pi m)) / (rho sigma^(d-1)
    chi). The constant c, which includes a Sonine factor, is (3/8) 1.01895 in 3D and (1/2) 1.02710 in 2D. In
    3D the formula is exact at zero density; the module `diffusion` contains the correction at higher density.
    In 2D the formula is the diffusion coefficient of the Enskog equation. For real discs D does not exist,
    because D(t) grows as ln t.
    """
    density, contact = _density_and_contact(packing_fraction, dimension, diameter, contact)
    first = {2: 0.5, 3: 0.375}[dimension]
    speed = math.sqrt(temperature / (math.pi * mass))
    with np.errstate(divide="ignore"):  # infinite at zero density
        path = 1.0 / (density * diameter ** (dimension - 1) * contact)
    return first * _DIFFUSION_FACTOR[dimension] * speed * path


@check_ranges
def enskog_bulk_viscosity(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Compute the bulk viscosity of Enskog theory [mass length^(2-d)/time].

    The bulk viscosity is (S / d^2) rho^2 sigma^(d+1) chi sqrt(m k_B T / pi), with S = 2 pi in 2D and 4 pi in
    3D. This is exact within the theory. It is the first-order change of the collisional pressure under
    uniform expansion. A pair at contact then has the mean normal velocity sigma div(u) / d.
    """
    density, contact = _density_and_contact(packing_fraction, dimension, diameter, contact)
    thermal = math.sqrt(mass * temperature / math.pi)
    surface = unit_sphere_surface(dimension)
    return surface / dimension**2 * density**2 * diameter ** (dimension + 1) * contact * thermal


@check_ranges
def enskog_viscosity(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Compute the shear viscosity of Enskog theory [mass length^(2-d)/time].

    The viscosity is (eta_0 / chi) [1 + 2 b chi / (d+2)]^2 plus d / (d+2) times the bulk viscosity, where b is
    2^(d-1) times the packing fraction. The dilute value eta_0 is 0.17913 (3D) or 0.28829 (2D), times sqrt(m
    k_B T) / sigma^(d-1). Together this is eta_0 [1/chi + 0.8 b + 0.7615 b^2 chi] in 3D and eta_0 [1/chi + b +
    0.8729 b^2 chi] in 2D (Gass). In 3D the formula is accurate to a few per cent up to a packing fraction of
    0.3. In denser gases the result is too low.
    """
    unit = math.sqrt(mass * temperature) / diameter ** (checked_dimension(dimension) - 1)
    kinetic = unit * kinetic_viscosity(packing_fraction, dimension, contact)
    bulk = enskog_bulk_viscosity(packing_fraction, dimension, diameter, temperature, mass, contact)
    return kinetic + dimension / (dimension + 2) * bulk


@check_ranges
def enskog_longitudinal_viscosity(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
) -> Values:
    """Compute the longitudinal viscosity of Enskog theory [mass length^(2-d)/time]. The longitudinal
    viscosity is 2 (d-1)/d times the shear viscosity plus the bulk viscosity. It damps sound, and its product
    with (du/dx)^2 is the heat per volume and time in front of a piston.
    """
    shear = enskog_viscosity(packing_fraction, dimension, diameter, temperature, mass)
    bulk = enskog_bulk_viscosity(packing_fraction, dimension, diameter, temperature, mass)
    return 2.0 * (dimension - 1) / dimension * shear + bulk


@check_ranges
def enskog_conductivity(
    packing_fraction: Numbers,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
    contact: Numbers | None = None,
) -> Values:
    """Compute the thermal conductivity of Enskog theory [1/(length^(d-2) time)].

    Thermal conductivity, with k_B = 1. The conductivity is (lambda_0 / chi) [1 + 3 b chi / (d+2)]^2 plus d /
    (2m) times the bulk viscosity, where b is 2^(d-1) times the packing fraction. The dilute value lambda_0 is
    0.67783 (3D) or 1.16192 (2D), times sqrt(T / m) / sigma^(d-1). Together this is lambda_0 [1/chi + 1.2 b +
    0.7574 b^2 chi] in 3D and lambda_0 [1/chi + 1.5 b + 0.8716 b^2 chi] in 2D.
    """
    unit = math.sqrt(temperature / mass) / diameter ** (checked_dimension(dimension) - 1)
    kinetic = unit * kinetic_conductivity(packing_fraction, dimension, contact)
    bulk = enskog_bulk_viscosity(packing_fraction, dimension, diameter, temperature, mass, contact)
    return kinetic + 0.5 * dimension / mass * bulk


@check_ranges
def transport_finite_size_factor(count: int, dimension: int, quantity: str) -> float:
    """Compute a transport coefficient of N dilute particles divided by its value in the infinite gas.

    With D = d (N - 1), the mean square of the stress is multiplied by (1 - 1/N) D / (D + 2), and the mean
    square of the heat flux by (1 - 1/N)^3 D^2 / ((D + 2)(D + 4)) (from moments of the uniform distribution on
    a sphere, with errors of order 1/N^2). Both fluxes decay more slowly by the factor 1 / (1 - 1/N), because
    a particle has N
    - 1 partners.

    Parameters
    ----------
    count : int
        Number N of particles, with a fixed energy and no total momentum.
    """
    share, freedom = 1.0 - 1.0 / count, dimension * (count - 1.0)
    if quantity == "viscosity":
        return freedom / (freedom + 2.0)
    return share**2 * freedom**2 / ((freedom + 2.0) * (freedom + 4.0))


# Distribution of the time of free flight of a particle between two collisions.
#
# All functions take `packing_fraction`, dimension 2 or 3, and the diameter, temperature (k_B = 1) and mass of
# the particles. Range: the collision rate at a given speed is exact in equilibrium at zero density. At higher
# density it is multiplied by chi, as in Enskog theory. The distribution assumes that consecutive collisions
# are independent (molecular chaos), which holds at low density. At a packing fraction of 0.05 the shortest
# flights are 2 % less frequent (from events of 1000 and of 4000 spheres). Literature: Chapman and Cowling,
# The mathematical theory of non-uniform gases (1970), chapter 5, for spheres.


_SPEEDS = 160
"""Number of points of the quadrature over speeds."""
_FASTEST = 8.0
"""Highest speed of the quadrature in thermal speeds. A fraction of less than exp(-32) of the particles is
faster.
"""


@check_ranges
def collision_rate_at_speed(
    speed: Numbers,
    packing_fraction: float,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
) -> Values:
    """Compute the number of collisions per time of a particle at a given speed [1/time]. nu(v) is
    `collision_rate` times u divided by the mean relative speed of all pairs. Here u is the mean relative
    speed between a particle of speed v and partners with Maxwellian velocities. Let the unit of speed be
    sqrt(2 k_B T / m), and c the speed v in this unit. Then u = exp(-c^2) / sqrt(pi) + (c + 1 / (2 c)) erf(c)
    in 3D. In 2D, u is the mean of Rice's distribution, sqrt(pi)/2 exp(-c^2 / 2) [(1 + c^2) I_0(c^2 / 2) + c^2
    I_1(c^2 / 2)]. The formula is exact in equilibrium at zero density. At higher density it is multiplied by
    chi, as in Enskog theory.
    """
    from scipy.special import erf, ive

    gas = {"diameter": diameter, "temperature": temperature, "mass": mass}
    thermal = math.sqrt(2.0 * temperature / mass)
    c = np.abs(np.asarray(speed, dtype=float)) / thermal
    if checked_dimension(dimension) == 3:
        slow = np.maximum(c, 1e-4)  # (c + 1 / 2c) erf(c) -> 1 / sqrt(pi)
        relative = np.exp(-(slow**2)) / math.sqrt(math.pi) + (slow + 0.5 / slow) * erf(slow)
    else:
        x = 0.5 * c**2  # ive(n, x) = exp(-x) I_n(x)
        relative = 0.5 * math.sqrt(math.pi) * ((1.0 + 2.0 * x) * ive(0, x) + 2.0 * x * ive(1, x))
    mean = math.sqrt(2.0) * mean_speed(dimension, temperature, mass) / thermal
    return collision_rate(packing_fraction, dimension, **gas) * relative / mean


@check_ranges
def free_time_pdf(
    time: Numbers,
    packing_fraction: float,
    dimension: int,
    diameter: float = 1.0,
    temperature: float = 1.0,
    mass: float = 1.0,
) -> Values:
    """Compute the probability density of the time between two collisions of a particle [1/time]. The density
    is int f nu(v)^2 exp(-nu(v) t) dv / nu, where f is Maxwell's distribution of speeds and nu(v) is
    `collision_rate_at_speed`. The density decreases more slowly than an exponential, because slow particles
    collide less often. The integral is computed by Gauss-Legendre quadrature to 1e-9. Consecutive collisions
    are assumed to be independent. At a packing fraction of 0.05 the shortest flights are 2 % less frequent.
    """
    gas = {"diameter": diameter, "temperature": temperature, "mass": mass}
    points, weights = np.polynomial.legendre.leggauss(_SPEEDS)
    fastest = _FASTEST * math.sqrt(temperature / mass)
    speeds, weights = 0.5 * fastest * (points + 1.0), 0.5 * fastest * weights
    rates = collision_rate_at_speed(speeds, packing_fraction, dimension, **gas)
    weights = weights * maxwell_pdf(speeds, dimension, temperature, mass) * rates**2
    times = np.asarray(time, dtype=float)
    decay = np.exp(-rates * times[..., None])
    return decay @ weights / collision_rate(packing_fraction, dimension, **gas)
