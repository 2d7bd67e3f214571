"""Rough particles: energies of rotation and translation, from the initial values to the steady ratio.

Time is counted in collisions per particle, s = 2 N_coll / N. Gases are homogeneous, velocities nearly
Maxwellian, and particles uncorrelated. These conditions hold in dilute gases before clustering.
"""

from functools import cache
from pathlib import Path

import numpy as np

from gaspart.theory.geometry import Numbers, Values, check_ranges
from gaspart.theory.granular import checked_restitution


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
