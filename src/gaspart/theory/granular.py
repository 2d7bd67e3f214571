"""Inelastic and rough particles: Haff's law of cooling, and how rotation and translation share energy.

Time is counted in collisions per particle, s = 2 N_coll / N, in which the collision rate, and with it the
density, has no part. Homogeneous gases, velocities nearly Maxwellian and particles uncorrelated: dilute, and
before clustering.
"""

from functools import cache
from pathlib import Path

import numpy as np

from gaspart.theory._arguments import Numbers, Values, checked, checked_dimension
from gaspart.theory.enskog import collision_rate

DISCHARGE_EXPONENT = 1.5
"""Exponent of the width of an orifice, less some diameters of the grains, in the rate of their flow through
it in two dimensions: the width times the speed of a free fall from an arch as wide. In three it is 5/2
(Beverloo, Leniger & van de Velde, Chem. Eng. Sci. 15, 260 (1961))."""


def fourth_cumulant(restitution: Numbers, dimension: int) -> Values:
    """a2 = d <v^4> / ((d + 2) <v^2>^2) - 1 of the smooth inelastic gas that cools homogeneously.

    a2 = 16 (1-e) (1-2e^2) / (9 + 24 d + (8d - 41) e + 30 e^2 (1-e)); van Noije and Ernst, Granular Matter 1,
    57 (1998). First order in a2, to which quadrature of the collision integral gives the same (tested); 0.01
    or so below direct-simulation results at e < 0.6.
    """
    e, d = _checked_restitution(restitution), checked_dimension(dimension)
    return (
        16.0
        * (1.0 - e)
        * (1.0 - 2.0 * e**2)
        / (9.0 + 24.0 * d + (8.0 * d - 41.0) * e + 30.0 * e**2 * (1.0 - e))
    )


def cooling_rate(restitution: Numbers, dimension: int) -> Values:
    """- d ln T / ds of the smooth inelastic gas: (1 - e^2) / d (1 + a2 / 4).

    The factor 1 - e^2 over d is exact for Maxwellian velocities, which the gas leaves within some collisions;
    dissipation per time is 1 + 3 a2 / 16 times theirs, collisions per time 1 - a2 / 16 (van Noije & Ernst).
    """
    e = _checked_restitution(restitution)
    return (1.0 - e**2) / dimension * (1.0 + 0.25 * fourth_cumulant(e, dimension))


@checked
def cooling_rate_finite_size_factor(count: Numbers, dimension: int) -> Values:
    """`cooling_rate` of N particles over that of many: d N / (d (N - 1) + 1), T about the centre of mass.

    Relative velocities have the variance 2T N / (N - 1); and at one energy, all velocities being uniform on a
    sphere in D = d (N - 1) dimensions, a contact takes D / (D + 1) of the energy that it takes of Maxwellian
    ones (exact for contacts that are nearly elastic, which leave the velocities so distributed).
    """
    freedoms = checked_dimension(dimension) * (np.asarray(count, dtype=float) - 1.0)
    return (freedoms + dimension) / (freedoms + 1.0)


@checked
def haff_time(restitution: Numbers, dimension: int, collision_rate: Numbers) -> Values:
    """t_H of Haff's law T = T_0 / (1 + t / t_H)^2; `collision_rate`: per particle, of the elastic gas at T_0.

    T falls by d ln T = -`cooling_rate` ds, and collisions become as rare as sqrt(T): 1 / t_H is half of
    `cooling_rate` times the rate, itself 1 - a2 / 16 of the elastic one. Haff, J. Fluid Mech. 134, 401
    (1983).
    """
    slowed = 1.0 - fourth_cumulant(restitution, dimension) / 16.0
    return 2.0 / (cooling_rate(restitution, dimension) * slowed * collision_rate)


def driven_cumulant(restitution: Numbers, dimension: int) -> Values:
    """a2 of the smooth inelastic gas that white noise heats, in its steady state; of few particles see
    `finite_size_cumulant`.

    a2 = 16 (1-e) (1-2e^2) / (73 + 56 d - (24 d + 105) e + 30 e^2 (1-e)); van Noije and Ernst, Granular Matter
    1, 57 (1998). Derived again (tested): the moments mu_2 ~ 1 + 3 a2/16 and mu_4 ~ d + 3/2 + e^2 + a2
    (3 (10 d + 39 + 10 e^2)/32 + (d-1)/(1-e)) give it from mu_4 = (d+2) mu_2, and `fourth_cumulant` from mu_4
    = (d+2) (1 + a2) mu_2.
    """
    e, d = _checked_restitution(restitution), checked_dimension(dimension)
    below = 73.0 + 56.0 * d - (24.0 * d + 105.0) * e + 30.0 * e**2 * (1.0 - e)
    return 16.0 * (1.0 - e) * (1.0 - 2.0 * e**2) / below


@checked
def finite_size_cumulant(cumulant: Numbers, count: Numbers, dimension: int) -> Values:
    """(1 + a2) D / (D + 2) - 1, D = d (N - 1): what d <v^4> / ((d + 2) <(v^2)^2>) - 1 is of N particles.

    `cumulant`: a2 of many. <(v^2)^2> is the mean over time of the square of the mean of v^2 over the
    particles, and the velocities are those about the centre of mass. Exact for a2 = 0: at one energy all
    velocities are uniform on a sphere in D dimensions; corrections are a2/N.
    """
    freedoms = checked_dimension(dimension) * (np.asarray(count, dtype=float) - 1.0)
    return (1.0 + np.asarray(cumulant)) * freedoms / (freedoms + 2.0) - 1.0


@checked
def driven_temperature(
    restitution: Numbers, dimension: int, power: Numbers, packing_fraction: Numbers
) -> Values:
    """The steady temperature of such a gas of mass 1 and diameter 1, if each particle is given `power`.

    Contacts take (1 - e^2)/2 nu T (1 + 3 a2/16) per particle and time, nu = nu_1 sqrt(T) Enskog's rate of the
    elastic gas: T^(3/2) = 2 power / ((1 - e^2) nu_1 (1 + 3 a2/16)). Infinite for e = 1.

    Of N particles too, T about the centre of mass of N - 1: kicks that keep the momentum give them power (1 -
    1/N) each, and each has N - 1 partners instead of N (dilute; the energy fluctuates by 0.8 to 1.2 times as
    much as at equilibrium, which changes the mean of T^(3/2) by 0.1/N at most). Molecular chaos:
    velocities are uncorrelated before contacts. Kicks let pairs that have just collided, and lost their
    relative velocity, meet again, and drive long waves, which renormalise T (van Noije, Ernst, Trizac &
    Pagonabarraga, Phys. Rev. E 59, 4326 (1999)): T is 1 % higher for discs of e = 0.4 at a packing fraction
    of 0.01, and less than can be measured, 0.2 %, at 0.001.
    """
    rate = collision_rate(packing_fraction, dimension)
    e = _checked_restitution(restitution)
    lost = 0.5 * (1.0 - e**2) * rate * (1.0 + 0.1875 * driven_cumulant(e, dimension))
    return np.divide(power, lost) ** (2.0 / 3.0)


def rough_matrix(inertia: float, tangential: float, normal: float = 1.0) -> np.ndarray:
    """M (2, 2) of d(T_tr, T_rot)/ds = M (T_tr, T_rot), rough discs; inertia: q = I / (m R^2).

    M = [[-2A, 2B], [4B, -4C]] with A = (1 - normal^2)/4 + h (1 - h)/2, B = h^2 / 2q, C = h (1 - h/q) / 2q and
    h = q (1 + tangential) / (2q + 2). Huthmann and Zippelius, Phys. Rev. E 56, R6275 (1997), Luding et al.,
    Phys. Rev. E 58, 3416 (1998) (exact averages over Maxwellian velocities and spins, tested).
    T_tr = m <v^2> / 2, T_rot = I <w^2>. Perfectly rough: T_tr - T_rot decays at 3q / (1+q)^2.
    """
    q = float(inertia)
    if not q > 0.0:
        raise ValueError(f"inertia: {inertia} (must be positive)")
    if not -1.0 <= tangential <= 1.0:
        raise ValueError(f"tangential: {tangential} (must be from -1 to 1)")
    e = float(_checked_restitution(normal))
    h = q * (1.0 + tangential) / (2.0 * q + 2.0)
    a = 0.25 * (1.0 - e**2) + 0.5 * h * (1.0 - h)
    b = 0.5 * h**2 / q
    c = 0.5 * h / q * (1.0 - h / q)
    return np.array([[-2.0 * a, 2.0 * b], [4.0 * b, -4.0 * c]])


@checked
def rough_temperatures(
    collisions: Numbers,
    inertia: float,
    tangential: float,
    normal: float = 1.0,
    start: tuple[float, float] = (1.0, 0.0),
) -> np.ndarray:
    """T_tr and T_rot (2, ...) after s collisions per particle, from `start`; `rough_matrix` integrated."""
    values, vectors = np.linalg.eig(rough_matrix(inertia, tangential, normal))
    weights = np.linalg.solve(vectors, np.asarray(start, dtype=float))
    s = np.asarray(collisions, dtype=float)
    return np.tensordot(vectors, weights.reshape(2, *[1] * s.ndim) * np.exp(np.multiply.outer(values, s)), 1)


def rough_ratio(inertia: float, tangential: float, normal: float = 1.0) -> float:
    """T_rot / T_tr that rough discs tend to, cooling or not; 1 if they are elastic and perfectly rough.

    The slower eigenvector of `rough_matrix`. Raises ValueError for smooth discs, whose spins never change.
    """
    if tangential == -1.0:
        raise ValueError("tangential: -1 (smooth discs do not exchange energy with their spins)")
    values, vectors = np.linalg.eig(rough_matrix(inertia, tangential, normal))
    slower = vectors[:, np.argmax(values)]
    return float(slower[1] / slower[0])


@cache
def rough_cooling() -> np.ndarray:
    """T_rot / T_tr of rough discs that cool, which `rough_ratio` gives to 5 % only: (n, 5), in each row
    inertia, tangential and normal restitution, the ratio, and its standard uncertainty.

    Velocities and spins are not Maxwellian there, and not independent. Computed by direct simulation of the
    homogeneous Boltzmann equation (`homogeneous.rough_discs`).
    """
    return np.loadtxt(Path(__file__).parent / "data" / "rough_cooling.csv", delimiter=",", skiprows=1)


ROUGH_START_UNCERTAINTY = 0.002
"""Standard uncertainty of `rough_start_excess`, statistical: of two gases of 100 000 discs."""


@checked
def rough_start_excess(inertia: float, collisions: Numbers) -> Values:
    """T_tr - T_rot of perfectly rough discs whose spins are 0 at first, over the temperature of the start,
    minus exp(-3 q s / (1 + q)^2), which Maxwellian velocities would give (Huthmann and Zippelius 1997).

    s: collisions of a particle; NaN where it was not computed, by direct simulation of the homogeneous
    Boltzmann equation (`homogeneous.rough_start`). Uncertain by ROUGH_START_UNCERTAINTY.
    """
    table = np.loadtxt(Path(__file__).parent / "data" / "rough_start.csv", delimiter=",", skiprows=1)
    s, excess = table[np.isclose(table[:, 0], inertia), 1:].T
    if not s.size:
        return np.full_like(np.asarray(collisions, dtype=float), np.nan)
    return np.interp(collisions, s, excess, right=np.nan)


@checked
def rough_wall_difference(time: Numbers, inertia: float) -> Values:
    """(T_par - T_rot) / T_par(0) of perfectly rough particles without spin at first, which meet nothing but
    two parallel rough walls; time: t sqrt(k_B T / m) / h, h the distance between the walls for centres.

    By Spencer 2022, Eq. 40, a hit turns the pair (v, sqrt(q) R w) of a tangential velocity and its spin, seen
    from the wall, by the angle a, cos a = (1 - q)/(1 + q), inertia: q = I / (m R^2). After K hits v is v(0)
    cos(K a), and the difference the mean of cos(2 K a). For uniform positions its mean at a given normal
    speed is linear between the times of integer K; as a Fourier series, and averaged over Maxwellian normal
    velocities: sum over integers j of (sin a / (a + pi j))^2 exp(-2 (a + pi j)^2 time^2). Exact; the sum ends
    at j = 1000, which matters (2e-4) only for times below 0.002.
    """
    q = float(inertia)
    if not q > 0.0:
        raise ValueError(f"inertia: {inertia} (must be positive)")
    angle = np.arccos((1.0 - q) / (1.0 + q)) + np.pi * np.arange(-1000.0, 1001.0)
    decay = np.exp(-2.0 * np.multiply.outer(np.asarray(time, dtype=float), angle) ** 2)
    return decay @ (np.sin(angle) / angle) ** 2


def _checked_restitution(restitution: Numbers) -> np.ndarray:
    e = np.asarray(restitution, dtype=float)
    if not np.all((e >= 0.0) & (e <= 1.0)):
        raise ValueError(f"restitution: {restitution} (must be from 0 to 1)")
    return e
