"""Gases under gravity: ideal gas in a finite box, and hydrostatics of discs and spheres.

The discs and spheres may form dense fluids. Heights z are heights of the centres above the lowest possible
position of a centre. `height` is the highest possible position. The field is given by w = m g / (k_B T), the
inverse scale height of a particle (1 / length).
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from gaspart.theory.geometry import Numbers, Values, check_ranges, checked_dimension, particle_volume
from gaspart.theory.tables import packing_fraction_at


@check_ranges
def ideal_profile(z: Numbers, height: float, weight: float) -> Values:
    """Compute the probability density of the height of a particle of an ideal gas [1/length].

    w e^{-w z} / (1 - e^{-w height}) (exact; canonical).

    Parameters
    ----------
    z : array_like, [length]
        Height of the centre.
    height : float, [length]
        Largest height that a centre can reach.
    weight : float, [1/length]
        Reduced weight w = m g / (k_B T).
    """
    z = np.asarray(z, dtype=float)
    if weight == 0.0:
        return np.full_like(z, 1.0 / height)
    return weight * np.exp(-weight * z) / -math.expm1(-weight * height)


@check_ranges
def ideal_mean_height(height: float, weight: Numbers) -> Values:
    """Compute the mean height of the particles of an ideal gas [length]: 1/w - height / (e^x - 1), x = w
    height (exact).
    """
    x = np.asarray(weight, dtype=float) * height
    small = np.abs(x) < 1e-4  # both terms cancel here; the next term is x^3 / 720
    safe = np.where(small, 1.0, x)
    return height * np.where(small, 0.5 - x / 12.0, 1.0 / safe + np.exp(-safe) / np.expm1(-safe))


@check_ranges
def ideal_heat_capacity(x: Numbers, dimension: int) -> Values:
    """Compute the heat capacity of an ideal gas under gravity in a box. C_V / (N k_B): d/2 + 1 - x^2 e^x /
    (e^x - 1)^2 (exact; canonical). This is d/2 without gravity. It is d/2 + 1 in a high box, because the
    potential energy also increases with T.
    """
    x = np.asarray(x, dtype=float)
    half = np.where(x == 0.0, 1.0, 0.5 * x)
    return 0.5 * checked_dimension(dimension) + 1.0 - np.where(x == 0.0, 1.0, (half / np.sinh(half)) ** 2)


@check_ranges
def ideal_energy_moments(
    energy: float, count: int, height: float, force: float, dimension: int, points: int = 2**14
) -> tuple[float, float]:
    """Compute mean and variance of the kinetic energy of an ideal gas at fixed total energy. The number of
    states with potential energy U is proportional to p(U) (E - U)^{dN/2 - 1}. Here p is the density of a sum
    of N independent potential energies, each uniform between 0 and force * height. The factor e^{-bU} moves
    the peak to the right energy, and the factor e^{bU} is restored afterwards. Both moments give T = 2 <K> /
    (dN) and, for many particles, the heat capacity, see `lebowitz_percus_verlet`.
    """
    top = force * height
    freedom = 0.5 * checked_dimension(dimension) * count
    if not energy > 0.0:
        raise ValueError(f"energy: {energy} (must be positive)")
    if top == 0.0:
        return energy, 0.0
    inverse = 1.0 / _canonical_temperature(energy / count, top, dimension)
    # The grid covers 12 standard deviations of the sum (the deviation of one term is below T and top / sqrt
    # 12).
    mean = count * ideal_mean_height(top, inverse)
    spread = math.sqrt(count) * min(1.0 / inverse, top / math.sqrt(12.0))
    step = 24.0 * spread / points
    potential = mean + step * (np.arange(points) - points // 2)
    frequency = 2.0 * np.pi * np.fft.fftfreq(points, step)
    # Fourier transform of the density of one term, proportional to e^{-bU} between 0 and top, about its mean.
    transform = -np.expm1(-(inverse + 1j * frequency) * top) / (inverse + 1j * frequency)
    transform *= inverse / -math.expm1(-inverse * top) * np.exp(1j * frequency * mean / count)
    tilted = np.fft.fftshift(np.fft.ifft(transform**count).real)
    allowed = (tilted > 1e-13 * tilted.max()) & (potential < energy)
    kinetic = energy - potential[allowed]
    log_weight = np.log(tilted[allowed]) + inverse * potential[allowed] + (freedom - 1.0) * np.log(kinetic)
    weight = np.exp(log_weight - log_weight.max())
    weight /= weight.sum()
    average = float(weight @ kinetic)
    return average, float(weight @ (kinetic - average) ** 2)


def _canonical_temperature(energy: float, top: float, dimension: int) -> float:
    """Return the temperature at which an ideal-gas particle has this mean energy, by bisection; `top` is m g
    height.
    """
    half = 0.5 * dimension
    low, high = 0.5 * energy / (half + 1.0), energy / half
    for _ in range(60):
        middle = 0.5 * (low + high)
        if half * middle + ideal_mean_height(top, 1.0 / middle) > energy:
            high = middle
        else:
            low = middle
    return middle


@check_ranges
def lebowitz_percus_verlet(mean: Numbers, variance: Numbers, count: int, dimension: int) -> Values:
    """Compute the heat capacity from the fluctuations of the kinetic energy at fixed total energy. C_V / (N
    k_B): <dK^2> = (d/2) N T^2 (1 - (d/2) N k_B / C_V), to leading order in 1/N (J. L. Lebowitz, J. K. Percus
    and L. Verlet, Phys. Rev. 153, 250 (1967)) (tested against an exact case).
    """
    half = 0.5 * dimension
    relative = variance / (half * count * (mean / (half * count)) ** 2)
    return half / (1.0 - relative)


@check_ranges
def hydrostatic_profiles(
    z: np.ndarray, numbers: ArrayLike, weights: ArrayLike, dimension: int, diameter: float = 1.0
) -> np.ndarray:
    """Compute the density profiles of species of equal size from hydrostatics.

    The chemical potential of every species is uniform: ln eta_i + mu_excess(eta) + w_i z = c_i. Here eta is
    the packing fraction of all particles, and mu_excess follows from the reference equation of state. The sum
    of these equations is dP/dz = -sum of m_i g rho_i. This is a local approximation. It is accurate if the
    density changes little over a diameter (error of order (w diameter)^2).

    Parameters
    ----------
    z : ndarray, shape (Z,), [length]
        Evenly spaced heights.
    numbers : array_like, shape (S,), [1/length^(d-1)]
        Number of particles of each species per area (per length in 2D) of the column between the first and
        the last height.
    weights : array_like, shape (S,), [1/length]
        Reduced weight w_i = m_i g / (k_B T) of a particle, for each species.

    Returns
    -------
    ndarray, shape (S, Z), [1/length^d]
        Number densities. The integral of each density by the trapezoidal rule is its number.

    Examples
    --------
    >>> import numpy as np
    >>> from gaspart import theory
    >>> z = np.linspace(0.0, 20.0, 41)
    >>> theory.hydrostatic_profiles(z, [2.0], [0.5], dimension=2)[0, [0, 20]].round(4)
    array([0.4312, 0.0255])
    """
    z = np.asarray(z, dtype=float)
    numbers, weights = np.asarray(numbers, dtype=float), np.asarray(weights, dtype=float)
    fields = -weights[:, None] * (z - z[0])
    volume = particle_volume(dimension, diameter)
    # Start dilute; each iteration scales the activities by the ratio of required to computed numbers. It
    # converges from below, because the density grows more slowly than the activity.
    logarithms = np.log(numbers * volume / np.trapezoid(np.exp(fields), z, axis=1))
    for _ in range(2000):
        parts = np.exp(logarithms[:, None] + fields)
        activity = parts.sum(axis=0)
        densities = parts / activity * packing_fraction_at(activity, dimension) / volume
        missing = np.log(numbers / np.trapezoid(densities, z, axis=1))
        if np.abs(missing).max() < 1e-10:
            return densities
        logarithms += missing
    raise ValueError(f"numbers: {numbers} (no such column was found)")
