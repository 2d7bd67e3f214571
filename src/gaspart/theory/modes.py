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
"""Exponent of decay: modes that have decayed by exp(-40) at the first time are left out."""


@checked
def sound_attenuation(packing_fraction: float, dimension: int) -> float:
    """Compute the attenuation of sound from Enskog's transport coefficients.

    Parameters
    ----------
    packing_fraction : float, [1]
        Packing fraction eta, from 0 to 0.70 for discs, to 0.539 for spheres.
    dimension : {2, 3}
        Discs or spheres.

    Returns
    -------
    float, [length^2/time]
        Gamma, by which sound of the wave number k decays as exp(-Gamma k^2 t / 2), in diameters and diameters
        sqrt(m / k_B T).

    Raises
    ------
    SceneError
        If an argument is out of range.

    Notes
    -----
    Gamma = [2 (d-1)/d eta + zeta] / rho + (gamma - 1) lambda / (rho c_p). The heat capacities come from
    `modes.heat_capacities`; the transport coefficients Enskog's.

    Examples
    --------
    >>> from gaspart import theory
    >>> round(theory.sound_attenuation(0.3, dimension=3), 4)
    4.6484
    """
    d, eta = checked_dimension(dimension), packing_fraction
    constant, free = heat_capacities(eta, d)
    viscous = float(enskog_longitudinal_viscosity(eta, d))
    thermal = float(enskog_conductivity(eta, d)) * (1.0 / constant - 1.0 / free)
    return (viscous + thermal) / float(number_density(eta, d))


def heat_capacities(packing_fraction: float, dimension: int) -> tuple[float, float]:
    """Compute the heat capacities of a particle at constant volume and at constant pressure.

    Parameters
    ----------
    packing_fraction : float, [1]
        Packing fraction eta, from 0 to 0.70 for discs, to 0.539 for spheres.
    dimension : {2, 3}
        Discs or spheres.

    Returns
    -------
    constant_volume : float, [1]
        c_v = d/2 (k_B = 1).
    constant_pressure : float, [1]
        c_p, with c_p - c_v = Z^2 / (d rho Z / d rho) (exact).
    """
    z = float(compressibility_factor(packing_fraction, dimension))
    slope = float(speed_of_sound(packing_fraction, dimension)) ** 2 - 2.0 * z**2 / dimension  # of rho Z
    return 0.5 * dimension, 0.5 * dimension + z**2 / slope


@checked
def velocity_autocorrelation_modes(
    time: Numbers, packing_fraction: float, dimension: int, count: int
) -> Values:
    """Compute the long-time velocity autocorrelation of N particles in a periodic square or cube.

    Parameters
    ----------
    time : array_like, [time]
        Positive times, in diameters sqrt(m / k_B T).
    packing_fraction : float, [1]
        Packing fraction eta, from 0 to 0.70 for discs, to 0.539 for spheres.
    dimension : {2, 3}
        Discs or spheres.
    count : int
        Number N of particles.

    Returns
    -------
    float or ndarray, same shape as `time`, [1]
        C(t) divided by C(0), with the term 1/N of free momentum.

    Raises
    ------
    SceneError
        If an argument is out of range.
    ValueError
        If a time is not positive.

    See Also
    --------
    diffusion_modes : Integral of this function.

    Notes
    -----
    The sum over hydrodynamic modes of the module `modes`. It is valid after many collisions of a particle,
    whatever the time that sound takes to cross the container.

    References
    ----------
    .. [1] M. H. Ernst, E. H. Hauge and J. M. J. van Leeuwen, Phys. Rev. Lett. 25, 1254 (1970).

    Examples
    --------
    >>> from gaspart import theory
    >>> float(theory.velocity_autocorrelation_modes(10.0, 0.3, dimension=3, count=1000).round(5))
    0.00109
    """
    return _sum(time, packing_fraction, dimension, count, integrated=False) + 1.0 / count


@checked
def diffusion_modes(time: Numbers, packing_fraction: float, dimension: int, count: int) -> Values:
    """Compute the integral of `velocity_autocorrelation_modes` over time, except for a constant.

    Parameters
    ----------
    time : array_like, [time]
        Positive times, in diameters sqrt(m / k_B T).
    packing_fraction : float, [1]
        Packing fraction eta, from 0 to 0.70 for discs, to 0.539 for spheres.
    dimension : {2, 3}
        Discs or spheres.
    count : int
        Number N of particles.

    Returns
    -------
    float or ndarray, same shape as `time`, [length^2/time]
        Integral, in diameters and diameters sqrt(m / k_B T).

    Raises
    ------
    SceneError
        If an argument is out of range.
    ValueError
        If a time is not positive.

    Notes
    -----
    The diffusion of particles before modes describe them is unknown, so only differences have a meaning.

    Examples
    --------
    >>> from gaspart import theory
    >>> early, late = theory.diffusion_modes([5.0, 10.0], 0.3, dimension=3, count=1000)
    >>> round(float(late - early), 5)
    0.0065
    """
    return _sum(time, packing_fraction, dimension, count, integrated=True) + np.asarray(time) / count


def _sum(time: Numbers, eta: float, dimension: int, count: int, integrated: bool) -> Values:
    """Return C(t), or its integral, from all wave vectors but 0.

    Only wave vectors that matter at the earliest time are included.
    """
    d = checked_dimension(dimension)
    diffusion, density = float(enskog_diffusion(eta, d)), float(number_density(eta, d))
    shear = diffusion + float(enskog_viscosity(eta, d)) / density
    sound = diffusion + 0.5 * sound_attenuation(eta, d)
    modes = [(d - 1.0, shear, 0.0), (1.0, sound, float(speed_of_sound(eta, d)))]
    return sum_of_modes(time, modes, d, (density / count) ** (1.0 / d), integrated) / (d * count)


def wave_vectors(dimension: int, most: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the squares of integer vectors without 0, and how many vectors have each square.

    Parameters
    ----------
    dimension : {2, 3}
        Discs or spheres.
    most : int
        Largest absolute value of a component.

    Returns
    -------
    squares : ndarray of int, shape (n,)
        Squares in ascending order.
    numbers : ndarray of int, shape (n,)
        Number of vectors with each square.
    """
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
    """Compute the sum of decaying modes over the wave vectors of a periodic square or cube.

    Parameters
    ----------
    time : array_like, [time]
        Positive times t.
    modes : sequence of (float, float, float)
        Weight w, diffusivity D and speed c of each mode: w exp(-D k^2 t) cos(c k t).
    dimension : {2, 3}
        Discs or spheres.
    inverse : float, [1/length]
        1 divided by the side of the container.
    integrated : bool
        Return the integral over time, except for a constant.

    Returns
    -------
    float or ndarray, same shape as `time`
        Sum over the modes and all wave vectors k but 0.

    Raises
    ------
    ValueError
        If a time is not positive.
    """
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
