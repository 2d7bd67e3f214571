"""Brownian motion of a large particle in a dilute gas: friction, diffusion and the Langevin equation.

Temperatures are in energy units (k_B = 1). Any consistent units of time, length and mass can be used.
"""

from __future__ import annotations

import math

import numpy as np

from gaspart.theory.geometry import Numbers, Values, check_ranges, checked_packing_fraction

SONINE_EQUAL_MASSES = 1.01895
"""Diffusion coefficient D of a particle that has the same mass as the gas particles, divided by its first
Sonine approximation k_B T / (M rate) (derived again, as in `enskog`).
"""


@check_ranges
def friction_rate(
    number_density: Numbers,
    contact_distance: float,
    mass: Numbers,
    gas_mass: float = 1.0,
    temperature: Numbers = 1.0,
) -> Values:
    """Compute the initial decay rate of the velocity autocorrelation of a sphere in a gas [1/time]. The rate
    is (8/3) n a^2 sqrt(2 pi mu k_B T) / M, where mu is the reduced mass of the particle and a gas particle
    (S. Chapman and T. G. Cowling, The Mathematical Theory of Non-uniform Gases (1970)). This is exact for a
    dilute gas in equilibrium whose mean free path is much longer than the contact distance.
    """
    reduced = mass * gas_mass / (mass + gas_mass)
    momentum = np.sqrt(2.0 * math.pi * reduced * np.asarray(temperature))
    return 8.0 / 3.0 * number_density * contact_distance**2 * momentum / mass


@check_ranges
def tagged_diffusion(rate: Numbers, mass: float, gas_mass: float = 1.0, temperature: float = 1.0) -> Values:
    """Compute the diffusion coefficient of a particle from its friction rate [length^2/time]. D = k_B T / (M
    rate) by the Langevin equation. If the particle has the same mass as the gas particles, the result is
    multiplied by 1.01895. The correction of heavier particles is smaller and neglected.
    """
    factor = SONINE_EQUAL_MASSES if mass == gas_mass else 1.0
    return factor * temperature / (mass * rate)


@check_ranges
def langevin_msd(time: Numbers, diffusion: Numbers, rate: Numbers, dimension: int = 3) -> Values:
    """Compute the mean-squared displacement of a Brownian particle in equilibrium [length^2]. The
    mean-squared displacement is 2 d D [t - (1 - exp(-g t)) / g] (Ornstein and Fuerth). The velocity
    autocorrelation is assumed to decay exponentially with the rate g.
    """
    scaled = rate * np.asarray(time, dtype=float)
    # At small g t, t - (1 - exp(-g t)) / g loses digits. The series g t^2 / 2 (1 - g t / 3 + ...) is used
    # instead.
    series = 0.5 * scaled**2 * (1.0 - scaled / 3.0 + scaled**2 / 12.0)
    shape = np.where(scaled < 1e-3, series, scaled + np.expm1(-scaled))
    return 2.0 * dimension * diffusion / rate * shape


@check_ranges
def langevin_msd_from_rest(time: Numbers, diffusion: Numbers, rate: Numbers, dimension: int = 3) -> Values:
    """Compute the mean-squared displacement of a Brownian particle that starts at rest [length^2]. The
    mean-squared displacement is 2 d D [t - 2 (1 - exp(-g t)) / g + (1 - exp(-2 g t)) / (2 g)], from the same
    Langevin equation as `langevin_msd`.
    """
    scaled = rate * np.asarray(time, dtype=float)
    shape = scaled + 2.0 * np.expm1(-scaled) - 0.5 * np.expm1(-2.0 * scaled)
    shape = np.where(scaled < 1e-2, scaled**3 / 3.0 * (1.0 - 0.75 * scaled), shape)
    return 2.0 * dimension * diffusion / rate * shape


# Buoyancy of a large disc in a fluid of small discs, from scaled-particle theory.
#
# The work of insertion is W / k_B T = -ln(1 - eta) + 2 s eta / (1 - eta) + s^2 eta / (1 - eta)^2 (E. Helfand,
# H. L. Frisch and J. L. Lebowitz, J. Chem. Phys. 34, 1037 (1961)). In equilibrium, it depends on the height
# only through the chemical potential mu(z) = const - m g z of the fluid. The upward force on the disc is
# therefore m g dW/dmu, which is m g times the number of displaced small discs, by Archimedes's principle:
# only the mass of the displaced fluid counts, including adsorption.


_HIGHEST = 0.7


@check_ranges
def displaced_area(packing_fraction: Numbers, size_ratio: Numbers) -> Values:
    """Compute the area of fluid that a large disc displaces. By scaled-particle theory the result is s^2 + 2
    s (1 - eta) / (1 + eta) + (1 - eta)^2 / (1 + eta). In a dilute gas the result is (s + 1)^2, because
    centres are excluded within the radius R + r. In a dense fluid the result is smaller, because fluid
    accumulates at the edge of the disc and fills a part of this margin.
    """
    eta = checked_packing_fraction(packing_fraction, _HIGHEST)
    s = np.asarray(size_ratio, dtype=float)
    return s**2 + 2.0 * s * (1.0 - eta) / (1.0 + eta) + (1.0 - eta) ** 2 / (1.0 + eta)
