"""Smooth inelastic particles: Haff's law of cooling, and gases heated by random kicks.

Time is counted in collisions per particle, s = 2 N_coll / N. Then the collision rate, and with it the
density, has no influence. Gases are homogeneous, velocities nearly Maxwellian, and particles uncorrelated.
These conditions hold in dilute gases before clustering.
"""

import math
from functools import cache
from pathlib import Path

import numpy as np

from gaspart.theory.enskog import collision_rate
from gaspart.theory.geometry import Numbers, Values, check_ranges, checked_dimension, checked_range

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


# Rough particles: energies of rotation and translation, from the initial values to the steady ratio.
#
# Time is counted in collisions per particle, s = 2 N_coll / N. Gases are homogeneous, velocities nearly
# Maxwellian, and particles uncorrelated. These conditions hold in dilute gases before clustering.


def rough_matrix(inertia: float, tangential: float, normal: float = 1.0) -> np.ndarray:
    """Compute the matrix that describes the exchange of translational and rotational energy of rough discs. M
    = [[-2A, 2B], [4B, -4C]] with A = (1 - normal^2)/4 + h (1 - h)/2, B = h^2 / 2q, C = h (1 - h/q) / 2q and h
    = q (1 + tangential) / (2q + 2) (M. Huthmann and A. Zippelius, Phys. Rev. E 56, R6275 (1997)) (S. Luding
    and others, Phys. Rev. E 58, 3416 (1998)) (exact averages over Maxwellian velocities and spins, tested).
    In a perfectly rough gas, T_tr - T_rot decays at the rate 3q / (1+q)^2.
    """
    q = float(inertia)
    if not q > 0.0:
        raise ValueError(f"inertia: {inertia} (must be positive)")
    if not -1.0 <= tangential <= 1.0:
        raise ValueError(f"tangential: {tangential} (must be from -1 to 1)")
    e = float(checked_restitution(normal))
    h = q * (1.0 + tangential) / (2.0 * q + 2.0)
    a = 0.25 * (1.0 - e**2) + 0.5 * h * (1.0 - h)
    b = 0.5 * h**2 / q
    c = 0.5 * h / q * (1.0 - h / q)
    return np.array([[-2.0 * a, 2.0 * b], [4.0 * b, -4.0 * c]])


@check_ranges
def rough_temperatures(
    collisions: Numbers,
    inertia: float,
    tangential: float,
    normal: float = 1.0,
    start: tuple[float, float] = (1.0, 0.0),
) -> np.ndarray:
    """Compute the translational and rotational temperatures of rough discs after some collisions.

    The result is the solution of the linear equation with `rough_matrix`.

    Parameters
    ----------
    collisions : array_like, [1]
        Number s of collisions of a particle.
    tangential : float, [1]
        Coefficient of tangential restitution, from -1 (smooth) to 1 (perfectly rough).
    start : tuple of float, default (1.0, 0.0), [energy]
        Initial values of T_tr and T_rot.

    Returns
    -------
    ndarray, shape (2, ...), [energy]
        T_tr and T_rot; both have the shape of `collisions`.
    """
    values, vectors = np.linalg.eig(rough_matrix(inertia, tangential, normal))
    weights = np.linalg.solve(vectors, np.asarray(start, dtype=float))
    s = np.asarray(collisions, dtype=float)
    return np.tensordot(vectors, weights.reshape(2, *[1] * s.ndim) * np.exp(np.multiply.outer(values, s)), 1)


def rough_ratio(inertia: float, tangential: float, normal: float = 1.0) -> float:
    """Compute the steady ratio of the rotational and translational temperatures of rough discs.

    T_rot / T_tr, for cooling and for elastic discs; 1 if the discs are elastic and perfectly rough. The ratio
    is given by the eigenvector of `rough_matrix` with the slower decay. For cooling rough discs it is
    accurate to only 5 %; `rough_cooling` has values from direct simulation.

    Parameters
    ----------
    tangential : float, [1]
        Coefficient of tangential restitution, above -1 and at most 1 (perfectly rough).
    """
    if tangential == -1.0:
        raise ValueError("tangential: -1 (smooth discs do not exchange energy with their spins)")
    values, vectors = np.linalg.eig(rough_matrix(inertia, tangential, normal))
    slower = vectors[:, np.argmax(values)]
    return float(slower[1] / slower[0])


@cache
def rough_cooling() -> np.ndarray:
    """Return the temperature ratio of cooling rough discs from direct simulation."""
    return np.loadtxt(Path(__file__).parent / "data" / "rough_cooling.csv", delimiter=",", skiprows=1)


ROUGH_START_UNCERTAINTY = 0.002
"""Standard uncertainty of `rough_start_excess` (statistical, from two gases of 100 000 discs)."""


@check_ranges
def rough_start_excess(inertia: float, collisions: Numbers) -> Values:
    """Return the deviation of rough discs from Maxwellian energy exchange, for a start without spin. T_tr -
    T_rot of perfectly rough discs divided by the initial temperature, minus exp(-3 q s / (1 + q)^2). NaN if
    it was not computed. The exponential is the result for Maxwellian velocities (M. Huthmann and A.
    Zippelius, Phys. Rev. E 56, R6275 (1997)). The values were computed by direct simulation of the
    homogeneous Boltzmann equation (`tests/theory/homogeneous.py`).
    """
    table = np.loadtxt(Path(__file__).parent / "data" / "rough_start.csv", delimiter=",", skiprows=1)
    s, excess = table[np.isclose(table[:, 0], inertia), 1:].T
    if not s.size:
        return np.full_like(np.asarray(collisions, dtype=float), np.nan)
    return np.interp(collisions, s, excess, right=np.nan)


@check_ranges
def rough_wall_difference(time: Numbers, inertia: float) -> Values:
    """Compute the temperature difference of rough particles that collide only with two rough walls. (T_par -
    T_rot) / T_par(0). A wall hit rotates the pair (v, sqrt(q) R w) by the angle a, with cos a = (1 - q)/(1 +
    q) (Spencer 2022, Eq. 40). Here v is a tangential velocity and w the corresponding spin, relative to the
    wall. After K hits v is v(0) cos(K a), and the difference is the mean of cos(2 K a). For uniform
    positions, its mean at a given normal speed is linear in time between the times of integer K. Written as a
    Fourier series and averaged over Maxwellian normal velocities, it is the sum over integers j of (sin a /
    (a + pi j))^2 exp(-2 (a + pi j)^2 time^2).
    """
    q = float(inertia)
    if not q > 0.0:
        raise ValueError(f"inertia: {inertia} (must be positive)")
    angle = np.arccos((1.0 - q) / (1.0 + q)) + np.pi * np.arange(-1000.0, 1001.0)
    decay = np.exp(-2.0 * np.multiply.outer(np.asarray(time, dtype=float), angle) ** 2)
    return decay @ (np.sin(angle) / angle) ** 2


# Dilute beds of inelastic discs on a vibrating floor under gravity.
#
# The results follow from the energy balance of a nearly elastic gas. The gas is isothermal and Maxwellian,
# and its density is exponential in the height. Vibrations are small, fast, and slow compared with the
# particles (Kumaran, Phys. Rev. E 57, 5660 (1998); McNamara and Luding, Phys. Rev. E 58, 813 (1998), who show
# that losses at the floor matter). All results are derived from averages over Maxwellian velocities, and
# tested against them. Discs have mass 1 and diameter d. `layers` is N d / width. For a finite bed it is (N -
# 1) d / width, because a disc does not collide with itself. Contacts with the floor have the same restitution
# as contacts of particles. All results are exact to first order in `packing_fraction`, the packing fraction
# of an ideal gas at the floor, pi N d^2 g / (4 width T).


# Coefficient of first order in the packing fraction: 2/3 of the coefficient of the contact value, b_3 / 2 for
# discs (Rowlinson 1964), minus 4/3, because the volume of the discs raises the bed.
_FIRST_ORDER = (8.0 / 3.0 - 2.0 * math.sqrt(3.0) / math.pi) * 2.0 / 3.0 - 4.0 / 3.0


def bed_loss(layers: Numbers, restitution: Numbers, packing_fraction: Numbers = 0.0) -> Values:
    """Compute the power dissipated by inelastic contacts in the bed, divided by N g sqrt(T).

    Dissipated power, the small parameter of the theory: (1 - e^2) (sqrt(pi) layers / 2 + 1 / sqrt(2 pi)). The
    first term is due to contacts between particles. Their loss per area, (1 - e^2) sqrt(pi) d n^2 T^(3/2)
    with n = N g / (T width) exp(-g z / T), is integrated over z. At a packing fraction eta this term is
    multiplied by 1 - 0.2907 eta. The second term is due to the floor: particles arrive with a mean normal
    energy T at the rate sqrt(T / 2 pi) n(0).

    Parameters
    ----------
    layers : array_like, [1]
        Number of layers N d / width, or (N - 1) d / width for a finite bed; not negative.
    packing_fraction : array_like, default 0.0, [1]
        Packing fraction eta of an ideal gas at the floor, from 0 to 1.
    """
    count = checked_range("layers", layers, 0.0, math.inf, "must be finite and not negative")
    e = checked_range("restitution", restitution, 0.0, 1.0, "must be from 0 to 1")
    eta = checked_range("packing_fraction", packing_fraction, 0.0, 1.0, "must be from 0 to 1")
    pairs = 0.5 * math.sqrt(math.pi) * count * (1.0 + _FIRST_ORDER * eta)
    return (1.0 - e**2) * (pairs + 1.0 / math.sqrt(2.0 * math.pi))


def bed_height(packing_fraction: Numbers) -> Values:
    """Compute the mean height of the bed above the floor, in units of T / g.

    Mean height, 1 + packing_fraction. The result follows from the virial theorem for a bed with the pressure
    n T (1 + 2 eta).

    Parameters
    ----------
    packing_fraction : array_like, [1]
        Packing fraction of an ideal gas at the floor, from 0 to 1.
    """
    return 1.0 + checked_range("packing_fraction", packing_fraction, 0.0, 1.0, "must be from 0 to 1")


def sawtooth_temperature(layers: Numbers, restitution: Numbers, packing_fraction: Numbers = 0.0) -> Values:
    """Compute T / V^2 of a bed on a floor that moves up at speed V.

    Temperature divided by V^2, for a floor that always moves up and discs of mass 1. The inverse square of
    `bed_loss`. The power of the floor is exactly N g V: V times the mean force, which is the weight. The next
    order is V / sqrt(T) = `bed_loss`.

    Parameters
    ----------
    layers : array_like, [1]
        Number of layers N d / width, or (N - 1) d / width for a finite bed; not negative.
    packing_fraction : array_like, default 0.0, [1]
        Packing fraction of an ideal gas at the floor, from 0 to 1.
    """
    return bed_loss(layers, restitution, packing_fraction) ** -2


def sine_temperature(layers: Numbers, restitution: Numbers, packing_fraction: Numbers = 0.0) -> Values:
    """Compute T / <U^2> of a bed on a floor whose velocity U averages to zero.

    Temperature divided by <U^2>, for discs of mass 1: sqrt(8 / pi) / `bed_loss`. To lowest order in U^2 / T
    the power of the floor is N g <U^2> sqrt(8 / (pi T)). Without losses at the floor, the result is 4 sqrt(2)
    / (pi layers (1 - e^2)).

    Parameters
    ----------
    layers : array_like, [1]
        Number of layers N d / width, or (N - 1) d / width for a finite bed; not negative.
    packing_fraction : array_like, default 0.0, [1]
        Packing fraction of an ideal gas at the floor, from 0 to 1.
    """
    return math.sqrt(8.0 / math.pi) / bed_loss(layers, restitution, packing_fraction)
