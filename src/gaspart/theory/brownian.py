"""A large particle in a dilute gas: friction, diffusion, and the Langevin equation's mean-squared
displacement.

k_B = 1. Times, lengths and masses in any consistent units.
"""

import math

import numpy as np

from gaspart.theory._arguments import Numbers, Values, checked

SONINE_EQUAL_MASSES = 1.01895
"""D of a particle as heavy as the gas's, over the first Sonine approximation k_B T / (M rate) (derived
again, as in `enskog`)."""


@checked
def friction_rate(
    number_density: Numbers,
    contact_distance: float,
    mass: Numbers,
    gas_mass: float = 1.0,
    temperature: Numbers = 1.0,
) -> Values:
    """Initial decay rate of a sphere's velocity autocorrelation: (8/3) n a^2 sqrt(2 pi mu k_B T) / M.

    Unit 1 / time. Exact for a dilute gas in equilibrium whose mean free path is much longer than the contact
    distance a (sum of the two radii); mu is the reduced mass of particle (`mass`, M) and gas particle.
    Chapman and Cowling.
    """
    reduced = mass * gas_mass / (mass + gas_mass)
    momentum = np.sqrt(2.0 * math.pi * reduced * np.asarray(temperature))
    return 8.0 / 3.0 * number_density * contact_distance**2 * momentum / mass


@checked
def tagged_diffusion(rate: Numbers, mass: float, gas_mass: float = 1.0, temperature: float = 1.0) -> Values:
    """D = k_B T / (M rate), the Langevin equation's; times 1.01895 for a particle as heavy as the gas's.

    For other masses the correction lies below this one, and vanishes as the particle becomes heavy. Unit
    length^2 / time.
    """
    factor = SONINE_EQUAL_MASSES if mass == gas_mass else 1.0
    return factor * temperature / (mass * rate)


@checked
def langevin_msd(time: Numbers, diffusion: Numbers, rate: Numbers, dimension: int = 3) -> Values:
    """2 d D [t - (1 - exp(-g t)) / g], of a particle in equilibrium (Ornstein and Fuerth; length^2).

    From an exponential velocity autocorrelation of rate g: ballistic at short times, 2 d D t at long ones.
    """
    scaled = rate * np.asarray(time, dtype=float)
    # t - (1 - exp(-g t)) / g loses its digits at small g t: its series there, g t^2 / 2 (1 - g t / 3 + ...).
    series = 0.5 * scaled**2 * (1.0 - scaled / 3.0 + scaled**2 / 12.0)
    shape = np.where(scaled < 1e-3, series, scaled + np.expm1(-scaled))
    return 2.0 * dimension * diffusion / rate * shape


@checked
def langevin_msd_from_rest(time: Numbers, diffusion: Numbers, rate: Numbers, dimension: int = 3) -> Values:
    """2 d D [t - 2 (1 - exp(-g t)) / g + (1 - exp(-2 g t)) / (2 g)]: the same of a particle that starts at
    rest.

    Begins as 2 d D g^2 t^3 / 3 (length^2).
    """
    scaled = rate * np.asarray(time, dtype=float)
    shape = scaled + 2.0 * np.expm1(-scaled) - 0.5 * np.expm1(-2.0 * scaled)
    shape = np.where(scaled < 1e-2, scaled**3 / 3.0 * (1.0 - 0.75 * scaled), shape)
    return 2.0 * dimension * diffusion / rate * shape
