"""Smooth inelastic particles: Haff's law of cooling, and gases heated by random kicks.

Time is counted in collisions per particle, s = 2 N_coll / N. Then the collision rate, and with it the
density, has no influence. Gases are homogeneous, velocities nearly Maxwellian, and particles uncorrelated.
These conditions hold in dilute gases before clustering.
"""

import numpy as np

from gaspart.theory.enskog import collision_rate
from gaspart.theory.geometry import Numbers, Values, check_ranges, checked_dimension

DISCHARGE_EXPONENT = 1.5
"""Exponent of the effective width of an orifice in the flow rate of grains in two dimensions. The effective
width is the width minus a few diameters of the grains. The flow rate is the effective width times the speed
of free fall from an arch of this width. In three dimensions it is 5/2 (Beverloo, Leniger & van de Velde,
Chem. Eng. Sci. 15, 260 (1961)).
"""


def fourth_cumulant(restitution: Numbers, dimension: int) -> Values:
    """Compute the fourth cumulant of a smooth inelastic gas that cools homogeneously.

    Cumulant a2 = d <v^4> / ((d + 2) <v^2>^2) - 1: a2 = 16 (1-e) (1-2e^2) / (9 + 24 d + (8d - 41) e + 30 e^2
    (1-e)) (T. P. C. van Noije and M. H. Ernst, Granular Matter 1, 57 (1998)), to first order in a2.
    Quadrature of the collision integral gives the same to this order (tested). The value is about 0.01 below
    the results of direct simulation for e < 0.6.
    """
    e, d = checked_restitution(restitution), checked_dimension(dimension)
    return (
        16.0
        * (1.0 - e)
        * (1.0 - 2.0 * e**2)
        / (9.0 + 24.0 * d + (8.0 * d - 41.0) * e + 30.0 * e**2 * (1.0 - e))
    )


def cooling_rate(restitution: Numbers, dimension: int) -> Values:
    """Compute the decrease of ln T per collision of a particle in a cooling smooth gas.

    The value is - d ln T / ds, with s collisions of a particle: (1 - e^2) / d (1 + a2 / 4), with a2 of
    `fourth_cumulant`. The factor (1 - e^2) / d is exact for Maxwellian velocities. Within a few collisions
    the gas deviates from them. The dissipation per time is 1 + 3 a2 / 16 times its Maxwellian value, and the
    collision rate is 1 - a2 / 16 times its Maxwellian value (T. P. C. van Noije and M. H. Ernst, Granular
    Matter 1, 57 (1998)).
    """
    e = checked_restitution(restitution)
    return (1.0 - e**2) / dimension * (1.0 + 0.25 * fourth_cumulant(e, dimension))


@check_ranges
def cooling_rate_finite_size_factor(count: Numbers, dimension: int) -> Values:
    """Compute the cooling rate of N particles divided by its value for many particles. d N / (d (N - 1) + 1),
    with the temperature T relative to the centre of mass. At a fixed energy, the velocities are uniformly
    distributed on a sphere in D = d (N - 1) dimensions. The mean energy loss per contact is then D / (D + 1)
    times its value for Maxwellian velocities (exact for nearly elastic contacts, which do not change this
    distribution).
    """
    freedoms = checked_dimension(dimension) * (np.asarray(count, dtype=float) - 1.0)
    return (freedoms + dimension) / (freedoms + 1.0)


@check_ranges
def haff_time(restitution: Numbers, dimension: int, collision_rate: Numbers) -> Values:
    """Compute the characteristic time of Haff's law of cooling [time].

    Time t_H of T = T_0 / (1 + t / t_H)^2. The temperature changes by d ln T = -`cooling_rate` ds, and the
    collision rate is proportional to sqrt(T) (P. K. Haff, J. Fluid Mech. 134, 401 (1983)). So 1 / t_H is half
    of `cooling_rate` times the collision rate, which is 1 - a2 / 16 times the elastic rate.

    Parameters
    ----------
    collision_rate : float or ndarray, [1/time]
        Collision rate of a particle in the elastic gas at the initial temperature T_0.
    """
    slowed = 1.0 - fourth_cumulant(restitution, dimension) / 16.0
    return 2.0 / (cooling_rate(restitution, dimension) * slowed * collision_rate)


def driven_cumulant(restitution: Numbers, dimension: int) -> Values:
    """Compute the fourth cumulant of a smooth inelastic gas in the steady state under white noise. a2 = 16
    (1-e) (1-2e^2) / (73 + 56 d - (24 d + 105) e + 30 e^2 (1-e)) (T. P. C. van Noije and M. H. Ernst, Granular
    Matter 1, 57 (1998)). Derived again (tested): the moments are mu_2 ~ 1 + 3 a2/16 and mu_4 ~ d + 3/2 + e^2
    + a2 (3 (10 d + 39 + 10 e^2)/32 + (d-1)/(1-e)). The condition mu_4 = (d+2) mu_2 gives this formula, and
    mu_4 = (d+2) (1 + a2) mu_2 gives `fourth_cumulant`.
    """
    e, d = checked_restitution(restitution), checked_dimension(dimension)
    below = 73.0 + 56.0 * d - (24.0 * d + 105.0) * e + 30.0 * e**2 * (1.0 - e)
    return 16.0 * (1.0 - e) * (1.0 - 2.0 * e**2) / below


@check_ranges
def finite_size_cumulant(cumulant: Numbers, count: Numbers, dimension: int) -> Values:
    """Compute the fourth cumulant of N particles from its value for many particles. (1 + a2) D / (D + 2) - 1
    with D = d (N - 1). <(v^2)^2> is the time average of the squared mean of v^2 over the particles.
    Velocities are relative to the centre of mass. The formula is exact for a2 = 0: at a fixed energy, the
    velocities are uniformly distributed on a sphere in D dimensions. Corrections are of the order a2/N.
    """
    freedoms = checked_dimension(dimension) * (np.asarray(count, dtype=float) - 1.0)
    return (1.0 + np.asarray(cumulant)) * freedoms / (freedoms + 2.0) - 1.0


@check_ranges
def driven_temperature(
    restitution: Numbers, dimension: int, power: Numbers, packing_fraction: Numbers
) -> Values:
    """Compute the steady temperature of a smooth inelastic gas that is heated by white noise.

    Temperature T of the gas of mass 1 and diameter 1; infinite for e = 1. Contacts dissipate (1 - e^2)/2 nu T
    (1 + 3 a2/16) per particle and time, where nu = nu_1 sqrt(T) is Enskog's collision rate of the elastic
    gas: T^(3/2) = 2 power / ((1 - e^2) nu_1 (1 + 3 a2/16)).

    The formula also holds for N particles, with T relative to the centre of mass defined by N - 1. Kicks that
    conserve the momentum transfer the power (1 - 1/N) to each particle, and each particle has N - 1 partners
    instead of N. (This is for dilute gases. The energy fluctuates by 0.8 to 1.2 times as much as in
    equilibrium, which changes the mean of T^(3/2) by at most 0.1/N.) Molecular chaos is assumed: velocities
    are uncorrelated before contacts. Because of the kicks, pairs that have just collided and lost their
    relative velocity can collide again. The kicks also drive long waves, which renormalise T (T. P. C. van
    Noije, M. H. Ernst, E. Trizac and I. Pagonabarraga, Phys. Rev. E 59, 4326 (1999)). T is 1 % higher for
    discs with e = 0.4 at a packing fraction of 0.01. At 0.001 the difference is below the resolution of 0.2
    %.

    Parameters
    ----------
    power : array_like, [1]
        Power that each particle receives, in units of mass = diameter = 1.
    """
    rate = collision_rate(packing_fraction, dimension)
    e = checked_restitution(restitution)
    lost = 0.5 * (1.0 - e**2) * rate * (1.0 + 0.1875 * driven_cumulant(e, dimension))
    return np.divide(power, lost) ** (2.0 / 3.0)


def checked_restitution(restitution: Numbers) -> np.ndarray:
    """Return the restitution as an array; raise ValueError outside [0, 1]."""
    e = np.asarray(restitution, dtype=float)
    if not np.all((e >= 0.0) & (e <= 1.0)):
        raise ValueError(f"restitution: {restitution} (must be from 0 to 1)")
    return e
