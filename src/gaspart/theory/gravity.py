"""Gases under gravity: the ideal gas in a box of finite height, and hydrostatics of dense discs and spheres.

Heights z are those of the particles' centres, from the lowest place that a centre can reach; `height` is the
highest. A field is given by w = m g / (k_B T) of a particle, one over its scale height (1 / length).
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from gaspart.theory._arguments import Numbers, Values, checked, checked_dimension
from gaspart.theory.geometry import particle_volume
from gaspart.theory.potential import packing_fraction_at


@checked
def ideal_profile(z: Numbers, height: float, weight: float) -> Values:
    """Chance per length of finding a particle at z: w e^{-w z} / (1 - e^{-w height}) (exact; canonical)."""
    z = np.asarray(z, dtype=float)
    if weight == 0.0:
        return np.full_like(z, 1.0 / height)
    return weight * np.exp(-weight * z) / -math.expm1(-weight * height)


@checked
def ideal_mean_height(height: float, weight: Numbers) -> Values:
    """<z> = 1/w - height / (e^x - 1), x = w height (exact; canonical). Without a field, height / 2."""
    x = np.asarray(weight, dtype=float) * height
    small = np.abs(x) < 1e-4  # where the two terms cancel; next is x^3 / 720
    safe = np.where(small, 1.0, x)
    return height * np.where(small, 0.5 - x / 12.0, 1.0 / safe + np.exp(-safe) / np.expm1(-safe))


@checked
def ideal_heat_capacity(x: Numbers, dimension: int) -> Values:
    """C_V / (N k_B) = d/2 + 1 - x^2 e^x / (e^x - 1)^2, x = m g height / (k_B T) (exact; canonical).

    d/2 without gravity; d/2 + 1 in a box far higher than the gas, whose potential energy grows with T too.
    """
    x = np.asarray(x, dtype=float)
    half = np.where(x == 0.0, 1.0, 0.5 * x)
    return 0.5 * checked_dimension(dimension) + 1.0 - np.where(x == 0.0, 1.0, (half / np.sinh(half)) ** 2)


@checked
def ideal_energy_moments(
    energy: float, count: int, height: float, force: float, dimension: int, points: int = 2**14
) -> tuple[float, float]:
    """<K> and the variance of the kinetic energy K of an ideal gas at fixed total energy (exact).

    energy: kinetic and potential, of `count` particles that weigh `force` = m g each, floor at 0. The number
    of states with potential energy U is proportional to p(U) (E - U)^{dN/2 - 1}, p the density of a sum of N
    independent potential energies, each uniform between 0 and force * height (walls all around: no momentum
    is conserved). p is found as the N-fold convolution, by Fourier transform, of one e^{-bU}, which puts its
    peak where it is wanted; the factor e^{bU} is put back afterwards.

    Returns (mean, variance). From them follow T = 2 <K> / (dN) and, in the limit of many particles, the heat
    capacity `lebowitz_percus_verlet`. Raises ValueError unless 0 < energy <= d/2 N force height.
    """
    top = force * height
    freedom = 0.5 * checked_dimension(dimension) * count
    if not energy > 0.0:
        raise ValueError(f"energy: {energy} (must be positive)")
    if top == 0.0:
        return energy, 0.0
    inverse = 1.0 / _canonical_temperature(energy / count, top, dimension)
    # The sum's grid holds 12 standard deviations of it (that of one term is below T and top / sqrt 12).
    mean = count * ideal_mean_height(top, inverse)
    spread = math.sqrt(count) * min(1.0 / inverse, top / math.sqrt(12.0))
    step = 24.0 * spread / points
    potential = mean + step * (np.arange(points) - points // 2)
    frequency = 2.0 * np.pi * np.fft.fftfreq(points, step)
    # Fourier transform of one term's density, proportional to e^{-bU} between 0 and top, about its mean.
    one = -np.expm1(-(inverse + 1j * frequency) * top) / (inverse + 1j * frequency)
    one *= inverse / -math.expm1(-inverse * top) * np.exp(1j * frequency * mean / count)
    tilted = np.fft.fftshift(np.fft.ifft(one**count).real)
    allowed = (tilted > 1e-13 * tilted.max()) & (potential < energy)
    kinetic = energy - potential[allowed]
    log_weight = np.log(tilted[allowed]) + inverse * potential[allowed] + (freedom - 1.0) * np.log(kinetic)
    weight = np.exp(log_weight - log_weight.max())
    weight /= weight.sum()
    average = float(weight @ kinetic)
    return average, float(weight @ (kinetic - average) ** 2)


def _canonical_temperature(energy: float, top: float, dimension: int) -> float:
    """T at which a particle of an ideal gas has this mean energy, by bisection; `top`: m g height."""
    half = 0.5 * dimension
    low, high = 0.5 * energy / (half + 1.0), energy / half
    for _ in range(60):
        middle = 0.5 * (low + high)
        if half * middle + ideal_mean_height(top, 1.0 / middle) > energy:
            high = middle
        else:
            low = middle
    return middle


@checked
def lebowitz_percus_verlet(mean: Numbers, variance: Numbers, count: int, dimension: int) -> Values:
    """C_V / (N k_B) from the kinetic energy's mean and variance at fixed total energy.

    <dK^2> = (d/2) N T^2 (1 - (d/2) N k_B / C_V), to leading order in 1/N; Lebowitz, Percus and Verlet,
    Phys. Rev. 153, 250 (1967) (tested against an exact case).
    """
    half = 0.5 * dimension
    relative = variance / (half * count * (mean / (half * count)) ** 2)
    return half / (1.0 - relative)


@checked
def hydrostatic_profiles(
    z: np.ndarray, numbers: ArrayLike, weights: ArrayLike, dimension: int, diameter: float = 1.0
) -> np.ndarray:
    """Densities of species of one size at heights z, hydrostatics with the reference equation of state.

    Every species' chemical potential is uniform, ln eta_i + mu_excess(eta) + w_i z = c_i, where eta is the
    packing fraction of all particles; summed, that is dP/dz = -sum of m_i g rho_i. A local approximation:
    good where the density changes little over a diameter (error of order (w diameter)^2).

    z: (Z,) evenly spaced heights; numbers: (S,) particles of each species per area (length in 2D) of the
    column between the first and the last; weights: (S,) m_i g / (k_B T). Returns (S, Z) number densities, of
    which each integrates (trapezoids) to its number.
    """
    z = np.asarray(z, dtype=float)
    numbers, weights = np.asarray(numbers, dtype=float), np.asarray(weights, dtype=float)
    fields = -weights[:, None] * (z - z[0])
    volume = particle_volume(dimension, diameter)
    # Start dilute; each round scales the activities by what is missing. It converges from below, because the
    # density grows more slowly than the activity.
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
