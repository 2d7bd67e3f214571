r"""Long-time velocity autocorrelation in a periodic container: a sum over hydrodynamic modes.

The velocity of a tagged particle spreads to the modes of the fluid. Each mode decays while the particle
diffuses away from its initial position. For zero total momentum of N particles, and with the wave vectors k
that the container permits, there are

.. math:: C(t) = \frac{1}{d N} \sum_{k \ne 0} e^{-D k^2 t} [(d-1) e^{-\nu k^2 t}
          + e^{-\Gamma k^2 t / 2} \cos(c k t)] ,

d - 1 shear modes with the kinematic viscosity nu, and sound modes with the speed c and the attenuation Gamma
= [2 (d-1)/d eta + zeta] / rho + (gamma - 1) lambda / (rho c_p). If the total momentum is not fixed, the term
k = 0 is 1/N. In an infinite fluid the sum over shear modes is an integral, the known tail ((d-1) / (d rho))
[4 pi (D + nu) t]^(-d/2) (Ernst, Hauge and van Leeuwen, Phys. Rev. Lett. 25, 1254 (1970)); sound decays
faster. The transport coefficients come from Enskog theory. All quantities are in units of the diameter, the
mass and k_B T.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gaspart.theory.boltzmann import flux_relaxation
from gaspart.theory.enskog import (
    collision_rate,
    enskog_conductivity,
    enskog_diffusion,
    enskog_longitudinal_viscosity,
    enskog_viscosity,
    kinetic_conductivity,
    kinetic_viscosity,
)
from gaspart.theory.geometry import Numbers, Values, check_ranges, checked_dimension, number_density
from gaspart.theory.state import compressibility_factor, speed_of_sound

_SMALLEST = 40.0
"""Decay exponent above which modes are neglected: they have decayed by exp(-40) at the first time."""


@check_ranges
def sound_attenuation(packing_fraction: float, dimension: int) -> float:
    """Compute the attenuation of sound from Enskog's transport coefficients [length^2/time]. Sound with the
    wave number k decays as exp(-Gamma k^2 t / 2). Gamma = [2 (d-1)/d eta + zeta] / rho + (gamma - 1) lambda /
    (rho c_p).
    """
    d, eta = checked_dimension(dimension), packing_fraction
    constant, free = heat_capacities(eta, d)
    viscous = float(enskog_longitudinal_viscosity(eta, d))
    thermal = float(enskog_conductivity(eta, d)) * (1.0 / constant - 1.0 / free)
    return (viscous + thermal) / float(number_density(eta, d))


def heat_capacities(packing_fraction: float, dimension: int) -> tuple[float, float]:
    """Compute the heat capacities per particle at constant volume and at constant pressure."""
    z = float(compressibility_factor(packing_fraction, dimension))
    slope = float(speed_of_sound(packing_fraction, dimension)) ** 2 - 2.0 * z**2 / dimension  # (rho Z)'
    return 0.5 * dimension, 0.5 * dimension + z**2 / slope


@check_ranges
def velocity_autocorrelation_modes(
    time: Numbers, packing_fraction: float, dimension: int, count: int
) -> Values:
    """Compute the long-time velocity autocorrelation of N particles in a periodic square or cube. C(t) / C(0)
    is a sum over the hydrodynamic modes of the module, with the term 1/N of a momentum that is not fixed. It
    is valid after many collisions of a particle, for any time that sound needs to cross the container.
    Literature: M. H. Ernst, E. H. Hauge and J. M. J. van Leeuwen, Phys. Rev. Lett. 25, 1254 (1970).
    """
    return _sum(time, packing_fraction, dimension, count, integrated=False) + 1.0 / count


@check_ranges
def diffusion_modes(time: Numbers, packing_fraction: float, dimension: int, count: int) -> Values:
    """Compute the time integral of `velocity_autocorrelation_modes`, except for a constant [length^2/time].

    Integral, in units of diameters and diameters sqrt(m / k_B T). The diffusion before modes describe the
    motion is unknown, so only differences between times are meaningful.

    Parameters
    ----------
    time : array_like, [time]
        Positive times, in diameters sqrt(m / k_B T).

    Examples
    --------
    >>> from gaspart import theory
    >>> early, late = theory.diffusion_modes([5.0, 10.0], 0.3, dimension=3, count=1000)
    >>> round(float(late - early), 5)
    0.0065
    """
    return _sum(time, packing_fraction, dimension, count, integrated=True) + np.asarray(time) / count


def _sum(time: Numbers, eta: float, dimension: int, count: int, integrated: bool) -> Values:
    """Return C(t), or its integral, from all wave vectors but 0 that matter at the earliest time."""
    d = checked_dimension(dimension)
    diffusion, density = float(enskog_diffusion(eta, d)), float(number_density(eta, d))
    shear = diffusion + float(enskog_viscosity(eta, d)) / density
    sound = diffusion + 0.5 * sound_attenuation(eta, d)
    modes = [(d - 1.0, shear, 0.0), (1.0, sound, float(speed_of_sound(eta, d)))]
    return sum_of_modes(time, modes, d, (density / count) ** (1.0 / d), integrated) / (d * count)


def wave_vectors(dimension: int, most: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the squares of nonzero integer vectors, and the number of vectors for each square."""
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
    """Compute the sum of decaying modes over the wave vectors of a periodic square or cube."""
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


def diffusion_by_modes(
    side: float, count: int, dimension: int, cells: int, path: float, spreading: float
) -> float:
    """Estimate the contribution of the fluctuating flow to the self-diffusion of a kinetic equation."""
    squares, numbers = wave_vectors(dimension, int(min(0.5 * cells, 0.5 * side / (math.pi * path))))
    waves = (2.0 * math.pi / side) ** 2 * squares
    return float((dimension - 1.0) / (dimension * count * spreading) * (numbers / waves).sum())


# Hydrodynamic modes of discs with relaxing stress and heat flux, beyond the limit of long waves.
#
# Fourier's law and Newton's law of viscosity hold if nothing changes within the time between collisions.
# Sound in a simulated container changes faster: c k times the relaxation time of the heat flux is 0.6 for the
# longest wave of 256 discs at a packing fraction of 0.3. So the fluxes are independent variables here.
# Density, temperature and velocity, each divided by its root mean square, obey the linearised equations of
# continuity, momentum and energy. The kinetic part of each flux consists of parts i that relax with the rates
# r_i of the linearised Boltzmann operator (`boltzmann.flux_relaxation`),
#
# .. math:: \dot q_i = -r_i q_i - i k \sqrt{\kappa_i r_i / (\rho c_v)}\, T , \qquad \sum_i \kappa_i =
# \kappa ,
#
# and the parts of the stress relax in the same way. Collisions transfer the rest of Enskog's coefficients
# instantaneously; it remains a coefficient. Static correlations are exact: the matrices are symmetric. The
# Burnett coupling between the fluxes is neglected. Units: diameters, masses and k_B T.


_FAINT = 1e-3
"""Weight of a part of a flux below which the part is neglected."""


@dataclass(frozen=True)
class Modes:
    """Hydrodynamic modes of M wave numbers. Correlations of the f hydrodynamic variables are sums over the
    modes n of amplitude[n, a] amplitude[n, b] exp(decay t).
    """

    decay: np.ndarray
    amplitude: np.ndarray


@dataclass(frozen=True)
class Relaxation:
    """Relaxation of the kinetic parts of a flux."""

    rates: np.ndarray
    weights: np.ndarray
    slow: float
    total: float

    @classmethod
    def of(cls, packing_fraction: float, quantity: str) -> Relaxation:
        """Return the relaxation of a flux of discs, from Enskog theory."""
        kinetic, total = {
            "viscosity": (kinetic_viscosity, enskog_viscosity),
            "conductivity": (kinetic_conductivity, enskog_conductivity),
        }[quantity]
        rates, weights = flux_relaxation(quantity)
        kept = weights > _FAINT
        frequency = float(collision_rate(packing_fraction, 2))
        return cls(
            frequency * rates[kept],
            weights[kept] / weights[kept].sum(),
            float(kinetic(packing_fraction, 2)),
            float(total(packing_fraction, 2)),
        )

    @property
    def parts(self) -> np.ndarray:
        """Contribution of each part to the coefficient, shape (K,)."""
        integrals = self.weights / self.rates
        return self.slow * integrals / integrals.sum()

    def integral(self, time: np.ndarray) -> np.ndarray:
        """Return the integral of the correlation of the kinetic part up to each time."""
        return self.parts @ -np.expm1(-np.multiply.outer(self.rates, time))


def transverse_modes(packing_fraction: float, wave_numbers: np.ndarray) -> Modes:
    """Compute the shear modes, in the velocity perpendicular to k."""
    return _modes(transverse_matrix(packing_fraction, wave_numbers), 1)


def longitudinal_modes(packing_fraction: float, wave_numbers: np.ndarray) -> Modes:
    """Compute the sound and heat modes, in density, temperature and the velocity along k."""
    return _modes(longitudinal_matrix(packing_fraction, wave_numbers), 3)


def transverse_matrix(packing_fraction: float, wave_numbers: np.ndarray) -> np.ndarray:
    """Compute the matrix for the velocity perpendicular to k and the parts of the stress."""
    density, stress = float(number_density(packing_fraction, 2)), Relaxation.of(packing_fraction, "viscosity")
    matrix = _matrix(wave_numbers, 1, [(0, stress, density)])
    matrix[:, 0, 0] = -(wave_numbers**2) * (stress.total - stress.slow) / density
    return matrix


def longitudinal_matrix(packing_fraction: float, wave_numbers: np.ndarray) -> np.ndarray:
    """Compute the matrix for density, temperature, velocity along k, heat flux and stress."""
    eta = packing_fraction
    density, z = float(number_density(eta, 2)), float(compressibility_factor(eta, 2))
    capacity, speed = heat_capacities(eta, 2)[0], float(speed_of_sound(eta, 2))
    stress, flux = Relaxation.of(eta, "viscosity"), Relaxation.of(eta, "conductivity")
    heat = density * capacity
    matrix = _matrix(wave_numbers, 3, [(1, flux, heat), (2, stress, density)])
    for variable, coupling in ((0, math.sqrt(speed**2 - z**2 / capacity)), (1, z / math.sqrt(capacity))):
        matrix[:, variable, 2] = matrix[:, 2, variable] = -1j * wave_numbers * coupling
    along = float(enskog_longitudinal_viscosity(eta, 2))  # slow part: as for the shear viscosity
    matrix[:, 1, 1] = -(wave_numbers**2) * (flux.total - flux.slow) / heat
    matrix[:, 2, 2] = -(wave_numbers**2) * (along - stress.slow) / density
    return matrix


def _matrix(
    wave_numbers: np.ndarray, variables: int, fluxes: list[tuple[int, Relaxation, float]]
) -> np.ndarray:
    """Return the (M, n, n) matrix for hydrodynamic variables (block 0) and parts of fluxes (variable,
    relaxation, density or heat capacity).
    """
    size = variables + sum(len(flux.rates) for _, flux, _ in fluxes)
    matrix, index = np.zeros((len(wave_numbers), size, size), complex), variables
    for variable, flux, inertia in fluxes:
        for rate, part in zip(flux.rates, flux.parts, strict=True):
            matrix[:, index, index] = -rate
            coupling = -1j * wave_numbers * math.sqrt(part * rate / inertia)
            matrix[:, variable, index] = matrix[:, index, variable] = coupling
            index += 1
    return matrix


def _modes(matrix: np.ndarray, variables: int) -> Modes:
    """Return all modes of symmetric matrices; left and right eigenvectors are equal, with a product of 1."""
    decay, modes = np.linalg.eig(matrix)
    modes = modes / np.sqrt((modes**2).sum(axis=1))[:, None, :]
    return Modes(decay.T, modes[:, :variables].transpose(2, 1, 0))
