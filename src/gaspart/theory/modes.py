r"""The long-time velocity autocorrelation in a periodic container: a sum over the hydrodynamic modes.

A tagged particle's velocity spreads over the modes of the fluid, each of which decays while the particle
diffuses away from where it started. With wave vectors k of the container's lattice, the total momentum of N
particles being zero,

.. math:: C(t) = \frac{1}{d N} \sum_{k \ne 0} e^{-D k^2 t} [(d-1) e^{-\nu k^2 t}
          + e^{-\Gamma k^2 t / 2} \cos(c k t)] ,

d - 1 shear modes with the kinematic viscosity nu, and sound with the speed c and the attenuation Gamma =
[2 (d-1)/d eta + zeta] / rho + (gamma - 1) lambda / (rho c_p). Where momentum is free the term k = 0 is 1/N.
In an infinite fluid the sum over shear modes is an integral, the known tail ((d-1) / (d rho)) [4 pi (D + nu)
t]^(-d/2) (Ernst, Hauge and van Leeuwen, Phys. Rev. Lett. 25, 1254 (1970)); sound decays faster. Transport
coefficients are Enskog's. Everything is in diameters, masses and k_B T.
"""

import math
from collections.abc import Sequence

import numpy as np

from gaspart.theory._arguments import Numbers, Values, checked, checked_dimension
from gaspart.theory.enskog import (
    enskog_conductivity,
    enskog_diffusion,
    enskog_longitudinal_viscosity,
    enskog_viscosity,
)
from gaspart.theory.geometry import number_density
from gaspart.theory.state import compressibility_factor, speed_of_sound

_SMALLEST = 40.0
"""Modes that have decayed by exp(-40) at the first time are left out."""


@checked
def sound_attenuation(packing_fraction: float, dimension: int) -> float:
    """Gamma, by which sound of the wave number k decays as exp(-Gamma k^2 t / 2) (diameter^2 / time).

    The heat capacities are those of `heat_capacities`, the transport coefficients Enskog's.
    """
    d, eta = checked_dimension(dimension), packing_fraction
    constant, free = heat_capacities(eta, d)
    viscous = float(enskog_longitudinal_viscosity(eta, d))
    thermal = float(enskog_conductivity(eta, d)) * (1.0 / constant - 1.0 / free)
    return (viscous + thermal) / float(number_density(eta, d))


def heat_capacities(packing_fraction: float, dimension: int) -> tuple[float, float]:
    """c_v and c_p of a particle: d/2, and c_p - c_v = Z^2 / (d rho Z / d rho) (exact; k_B = 1)."""
    z = float(compressibility_factor(packing_fraction, dimension))
    slope = float(speed_of_sound(packing_fraction, dimension)) ** 2 - 2.0 * z**2 / dimension  # of rho Z
    return 0.5 * dimension, 0.5 * dimension + z**2 / slope


@checked
def velocity_autocorrelation_modes(
    time: Numbers, packing_fraction: float, dimension: int, count: int
) -> Values:
    """C(t), over its value at 0, of `count` particles in a periodic square or cube, the term 1/N included.

    time: positive, in diameters sqrt(m / k_B T); valid after many collisions of a particle, whatever the
    time that sound takes to cross the container.
    """
    return _sum(time, packing_fraction, dimension, count, integrated=False) + 1.0 / count


@checked
def diffusion_modes(time: Numbers, packing_fraction: float, dimension: int, count: int) -> Values:
    """The integral of `velocity_autocorrelation_modes` over time, but for a constant (diameter^2 / time).

    What particles diffuse before modes describe them is unknown, so only differences have a meaning.
    """
    return _sum(time, packing_fraction, dimension, count, integrated=True) + np.asarray(time) / count


def _sum(time: Numbers, eta: float, dimension: int, count: int, integrated: bool) -> Values:
    """Over all wave vectors but 0 that matter at the earliest time: C(t), or its integral."""
    d = checked_dimension(dimension)
    diffusion, density = float(enskog_diffusion(eta, d)), float(number_density(eta, d))
    shear = diffusion + float(enskog_viscosity(eta, d)) / density
    sound = diffusion + 0.5 * sound_attenuation(eta, d)
    modes = [(d - 1.0, shear, 0.0), (1.0, sound, float(speed_of_sound(eta, d)))]
    return sum_of_modes(time, modes, d, (density / count) ** (1.0 / d), integrated) / (d * count)


def wave_vectors(dimension: int, most: int) -> tuple[np.ndarray, np.ndarray]:
    """The squares of the vectors of whole numbers from -`most` to `most` but 0, and how many have each."""
    axis = np.arange(-most, most + 1) ** 2
    squares, numbers = np.unique(sum(np.meshgrid(*[axis] * dimension)), return_counts=True)
    return squares[1:], numbers[1:]


def sum_of_modes(
    time: Numbers,
    modes: Sequence[tuple[float, float, float]],
    dimension: int,
    inverse: float,
    integrated: bool,
) -> Values:
    """The sum of w exp(-D k^2 t) cos(c k t) over modes (w, D, c) and all wave vectors k but 0 of a periodic
    cube or square of side 1 / `inverse`; or its integral over time, but for a constant. Raises ValueError for
    a time that is not positive."""
    times = np.atleast_1d(np.asarray(time, dtype=float))
    if np.any(times <= 0.0):
        raise ValueError("time: must be positive")
    weights, widths, speeds = np.array(modes).T
    unit = 2.0 * math.pi * inverse
    most = math.ceil(math.sqrt(_SMALLEST / (widths.min() * times.min())) / unit)
    squares, numbers = wave_vectors(dimension, most)
    inside = squares <= most**2
    squares, numbers = unit**2 * squares[inside], numbers[inside]
    rates = -np.multiply.outer(widths, squares) + 1j * np.multiply.outer(speeds, np.sqrt(squares))
    terms = np.exp(np.multiply.outer(times, rates))
    if integrated:
        terms /= rates
    return (weights @ terms.real @ numbers).reshape(np.shape(time))[()]
