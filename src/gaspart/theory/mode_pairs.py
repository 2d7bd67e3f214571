r"""Long-time tails of the viscosity and conductivity of discs, from pairs of hydrodynamic modes.

The container is periodic. For long waves the stress is m rho u_x u_y. The heat flux, minus the enthalpy that
the momentum carries, is rho T s u + p u. Here u is the velocity, and the entropy per particle s and the
pressure p are relative to their means (k_B = 1). So these fluxes correlate as pairs of modes with wave
vectors k and -k. There are shear modes with the kinematic viscosity nu, heat modes with D_T = lambda / (rho
c_p), and sound modes with the speed c and the attenuation Gamma (`modes.sound_attenuation`). In an infinite
fluid the integrals grow with the logarithm of time, by

.. math:: \frac{1}{32\pi}\left(\frac1\nu + \frac1\Gamma\right) k_BT \quad\text{and}\quad
          \frac{1}{8\pi}\left(\frac{k_BT c_p}{m(\nu+D_T)} + \frac{c^2}{\Gamma}\right)

each time that the time increases by a factor e. The method is due to Ernst, Hauge and van Leeuwen, Phys. Rev.
A 4, 2055 (1971), and J. Stat. Phys. 15, 7 (1976). The amplitudes were derived again and not compared with the
papers (tested against the linearised equations of the fluid). The term with c^2 is energy that travels with
the sound.

The corrections of the next order in 1/t have no free parameter. (a) The kinetic part of the flux has its own
correlation. It relaxes with the rates r_i and weights a_i of the linearised Boltzmann operator. (b) Modes
create a flux through collisions, so the flux is delayed. Collisions of particles 1 and 2 in the modes psi and
phi conserve the sums psi(1) + psi(2) and phi(1) + phi(2). From this follows, for the part i of a flux j,

.. math:: \langle i(1)+i(2)|\,T\,|\psi(1)\phi(2)+\psi(2)\phi(1)\rangle = 2 r_i \langle i|\psi\phi\rangle ,

so each of the two vertices is <j|psi phi> times F(p) = sum a_i r_i / (r_i + p). F(p) is the Laplace transform
of a delay with the mean sum a_i / r_i, which is 2.06 collisions of a particle for the heat flux and 1.02 for
the stress. (c) The modes belong to a gas whose fluxes relax (`modes.Relaxation`). Neglected are waves as
short as the mean free path, Burnett terms, and corrections to Enskog's coefficients. All quantities are in
units of the diameter, the mass and k_B T.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np

from gaspart.errors import SceneError
from gaspart.theory.enskog import enskog_conductivity, enskog_viscosity, mean_free_path
from gaspart.theory.geometry import Numbers, Values, check_ranges, number_density
from gaspart.theory.modes import (
    Modes,
    Relaxation,
    heat_capacities,
    longitudinal_modes,
    sound_attenuation,
    transverse_modes,
)
from gaspart.theory.state import compressibility_factor, speed_of_sound

QUANTITIES = ("viscosity", "conductivity")
_SHORTEST = 2.0
"""Largest k l; there the factor exp(-(k l)^4) is 1e-7."""
_SMALLEST = 40.0
"""Decay exponent above which pairs of modes are neglected: they have decayed by exp(-40) at the first time.
"""


@check_ranges
def transport_modes(
    time: Numbers, packing_fraction: float, count: int, quantity: str, shortest: float = 1.0
) -> Values:
    """Compute the Green-Kubo integral of discs in a periodic square from pairs of modes.

    Integral up to each time: [mass/time] for the viscosity, [1/time] for the conductivity. The result
    includes the kinetic part and the pairs of modes (module `mode_pairs`). During the first collisions of a
    particle, waves as short as its mean free path contribute, which are not hydrodynamic modes. So only
    differences between later times are meaningful. The change of the result with `shortest` is an uncertainty
    of the theory. Doubling this length at a packing fraction of 0.3 changes the growth of the conductivity by
    12 % after 10 collisions, and by 2 % after 20 collisions. Literature: M. H. Ernst, E. H. Hauge and J. M.
    J. van Leeuwen, Phys. Rev. A 4, 2055 (1971); J. Stat. Phys. 15, 7 (1976).

    Parameters
    ----------
    time : array_like, [time]
        Positive upper limits of the integral, in diameters sqrt(m / k_B T).
    packing_fraction : float, [1]
        Packing fraction eta, from 0 to 0.70.
    shortest : float, default 1.0, [1]
        Shortest length of modes, in mean free paths. Modes are cut off smoothly at the wave number 1 /
        length.

    Examples
    --------
    >>> from gaspart import theory
    >>> early, late = theory.transport_modes([5.0, 10.0], 0.3, 256, "viscosity")
    >>> round(float(late - early), 4)
    0.0041
    """
    times = np.atleast_1d(np.asarray(time, dtype=float))
    if np.any(times <= 0.0):
        raise ValueError("time: must be positive")
    relaxation = _relaxation(packing_fraction, quantity)
    density = float(number_density(packing_fraction, 2))
    squares, numbers = _wave_numbers(packing_fraction, count, float(times.min()), shortest)
    pairs = _viscosity_pairs if quantity == "viscosity" else _conductivity_pairs
    along = longitudinal_modes(packing_fraction, np.sqrt(squares))
    across = transverse_modes(packing_fraction, np.sqrt(squares))
    integrals = relaxation.integral(times)
    for weight, decay in pairs(packing_fraction, along, across):
        for n, upper in enumerate(times):
            grown = (weight * _integrate_delayed(decay, upper, relaxation)).real
            integrals[n] += density / count * grown.sum(axis=(0, 1)) @ numbers
    return integrals.reshape(np.shape(time))[()]


def _relaxation(packing_fraction: float, quantity: str) -> Relaxation:
    """Return the relaxation of the flux of a quantity; raise SceneError for another quantity."""
    if quantity not in QUANTITIES:
        raise SceneError("quantity", quantity, f"must be {' or '.join(QUANTITIES)}")
    return Relaxation.of(packing_fraction, quantity)


def _wave_numbers(eta: float, count: int, first: float, shortest: float) -> tuple[np.ndarray, np.ndarray]:
    """Return squared wave numbers (M,) that matter at the first time, and their numbers times
    exp(-(k l)^4).
    """
    density = float(number_density(eta, 2))
    unit = 2.0 * math.pi * math.sqrt(density / count)
    heat = float(enskog_conductivity(eta, 2)) / (density * heat_capacities(eta, 2)[1])
    slowest = min(float(enskog_viscosity(eta, 2)) / density, heat, 0.5 * sound_attenuation(eta, 2))
    path = shortest * float(mean_free_path(eta, 2))
    longest = min(_SHORTEST / path, math.sqrt(_SMALLEST / (2.0 * slowest * first)))
    most = max(1, math.ceil(longest / unit))
    axis = np.arange(-most, most + 1) ** 2
    squares, numbers = np.unique(np.add.outer(axis, axis), return_counts=True)
    inside = (squares > 0) & (squares <= most**2)
    squares = unit**2 * squares[inside]
    return squares, numbers[inside] * np.exp(-((squares * path**2) ** 2))


_Pairs: TypeAlias = list[tuple[np.ndarray, np.ndarray]]


def _viscosity_pairs(eta: float, along: Modes, across: Modes) -> _Pairs:
    """Return weights and decays (n, m, M) of pairs of modes in the stress u_x u_y, averaged over directions
    of k.
    """
    longitudinal, transverse = along.amplitude[:, 2], across.amplitude[:, 0]
    return [
        (0.25 * _squares(longitudinal, longitudinal), _sums(along, along)),
        (0.25 * _squares(transverse, transverse), _sums(across, across)),
        (0.5 * _squares(longitudinal, transverse), _sums(along, across)),
    ]


def _conductivity_pairs(eta: float, along: Modes, across: Modes) -> _Pairs:
    """Return weights and decays (n, m, M) of pairs of modes in the heat flux (rho T s + p) u."""
    z, capacity = float(compressibility_factor(eta, 2)), heat_capacities(eta, 2)[0]
    slope = float(speed_of_sound(eta, 2)) ** 2 - z**2 / capacity  # dp / d rho
    carried = (slope - z) / math.sqrt(slope) * along.amplitude[:, 0]
    carried = carried + (capacity + z) / math.sqrt(capacity) * along.amplitude[:, 1]
    moved = along.amplitude[:, 2]
    crossed = carried * moved  # pair of k and -k: the velocity along k changes its sign
    return [
        (0.5 * _squares(carried, across.amplitude[:, 0]), _sums(along, across)),
        (0.5 * (_squares(carried, moved) - crossed[:, None] * crossed[None, :]), _sums(along, along)),
    ]


def _squares(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return the squares (n, m, M) of the products of amplitudes (n, M) and (m, M)."""
    return (first[:, None] * second[None, :]) ** 2


def _sums(first: Modes, second: Modes) -> np.ndarray:
    """Return the decay rates (n, m, M) of pairs."""
    return first.decay[:, None] + second.decay[None, :]


def _integrate_delayed(decay: np.ndarray, time: float, relaxation: Relaxation) -> np.ndarray:
    """Return the integrals up to a time of exp(decay t), delayed by both vertices: inverse Laplace transforms
    of F(p)^2 / (p - decay) / p.
    """

    def integral(p: np.ndarray) -> np.ndarray:
        safe = np.where(p == 0.0, 1.0, p)
        return np.where(p == 0.0, time, np.expm1(safe * time) / safe)

    poles = -relaxation.rates
    shares = relaxation.weights * relaxation.rates
    ends = integral(poles)
    alike = (time * np.exp(poles * time) - ends) / poles  # derivative
    to_pole = [(integral(decay) - end) / (decay - pole) for pole, end in zip(poles, ends, strict=True)]
    total = np.zeros(decay.shape, dtype=complex)
    for i, first in enumerate(poles):
        for j, second in enumerate(poles):
            between = alike[i] if i == j else (ends[i] - ends[j]) / (first - second)
            total += shares[i] * shares[j] * (to_pole[i] - between) / (decay - second)
    return total
