r"""Hydrodynamic modes of discs whose stress and heat flux relax, beyond the limit of long waves.

Fourier's law and Newton's law hold if nothing changes within a time between collisions. For sound in a
simulated container it does: c k times the relaxation time of the heat flux is 0.6 for the longest wave of 256
discs of packing fraction 0.3. So the fluxes are variables here. Density, temperature and velocity, each over
its root mean square, obey the linearised equations of continuity, momentum and energy; the kinetic part of
each flux consists of parts i that relax with the rates r_i of the linearised Boltzmann operator
(`boltzmann.flux_relaxation`),

.. math:: \dot q_i = -r_i q_i - i k \sqrt{\kappa_i r_i / (\rho c_v)}\, T , \qquad \sum_i \kappa_i = \kappa ,

and the parts of the stress relax in the same way. What collisions transfer at once, the rest of Enskog's
coefficients, stays a coefficient. Static correlations are exact: the matrices are symmetric. Burnett's
coupling of the fluxes with each other is left out. Units: diameters, masses and k_B T.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gaspart.theory.boltzmann import flux_relaxation
from gaspart.theory.enskog import (
    collision_rate,
    enskog_conductivity,
    enskog_longitudinal_viscosity,
    enskog_viscosity,
    kinetic_conductivity,
    kinetic_viscosity,
)
from gaspart.theory.geometry import number_density
from gaspart.theory.modes import heat_capacities
from gaspart.theory.state import compressibility_factor, speed_of_sound

_FAINT = 1e-3
"""Weight of a part of a flux below which it is left out."""


@dataclass(frozen=True)
class Modes:
    """Hydrodynamic modes of M wave numbers.

    Correlations of the f hydrodynamic variables are sums over the modes n of amplitude[n, a] amplitude[n, b]
    exp(decay t). Modes of the relaxing fluxes have small amplitudes in long waves.

    Parameters
    ----------
    decay : ndarray of complex, shape (n, M), [1/time]
        Decay of each mode, which changes as exp(decay t).
    amplitude : ndarray of complex, shape (n, f, M), [1]
        Amplitude of each mode in the hydrodynamic variables.
    """

    decay: np.ndarray
    amplitude: np.ndarray


@dataclass(frozen=True)
class Relaxation:
    """Relaxation of the parts of a flux.

    Parameters
    ----------
    rates : ndarray, shape (K,), [1/time]
        Rates of the parts.
    weights : ndarray, shape (K,), [1]
        Weights of the parts, of sum 1.
    slow : float
        Transport coefficient that the parts make.
    total : float
        Complete transport coefficient.
    """

    rates: np.ndarray
    weights: np.ndarray
    slow: float
    total: float

    @classmethod
    def of(cls, packing_fraction: float, quantity: str) -> Relaxation:
        """Return the relaxation of a flux of discs, by Enskog's theory.

        Parameters
        ----------
        packing_fraction : float, [1]
            Packing fraction eta.
        quantity : {"viscosity", "conductivity"}
            Transport coefficient of the flux.

        Returns
        -------
        Relaxation
            Relaxation of its parts.
        """
        kinetic, whole = {
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
            float(whole(packing_fraction, 2)),
        )

    @property
    def parts(self) -> np.ndarray:
        """Contribution of each part to the coefficient, (K,)."""
        integrals = self.weights / self.rates
        return self.slow * integrals / integrals.sum()

    def integral(self, time: np.ndarray) -> np.ndarray:
        """Return the integral of the kinetic part's correlation until each time.

        Parameters
        ----------
        time : ndarray, shape (T,), [time]
            Times.

        Returns
        -------
        ndarray, shape (T,)
            Integrals, in the unit of the coefficient.
        """
        return self.parts @ -np.expm1(-np.multiply.outer(self.rates, time))


def transverse_modes(packing_fraction: float, wave_numbers: np.ndarray) -> Modes:
    """Compute the modes of shear, in the velocity across k.

    Parameters
    ----------
    packing_fraction : float, [1]
        Packing fraction eta.
    wave_numbers : ndarray, shape (M,), [1/length]
        Wave numbers k.

    Returns
    -------
    Modes
        Modes, with the velocity across k as variable.
    """
    return _modes(transverse_matrix(packing_fraction, wave_numbers), 1)


def longitudinal_modes(packing_fraction: float, wave_numbers: np.ndarray) -> Modes:
    """Compute the modes of sound and heat, in density, temperature and the velocity along k.

    Parameters
    ----------
    packing_fraction : float, [1]
        Packing fraction eta.
    wave_numbers : ndarray, shape (M,), [1/length]
        Wave numbers k.

    Returns
    -------
    Modes
        Modes, with density, temperature and the velocity along k as variables.
    """
    return _modes(longitudinal_matrix(packing_fraction, wave_numbers), 3)


def transverse_matrix(packing_fraction: float, wave_numbers: np.ndarray) -> np.ndarray:
    """Compute the matrix of the velocity across k and the parts of the stress.

    Parameters
    ----------
    packing_fraction : float, [1]
        Packing fraction eta.
    wave_numbers : ndarray, shape (M,), [1/length]
        Wave numbers k.

    Returns
    -------
    ndarray of complex, shape (M, n, n), [1/time]
        Time derivatives of the variables, as a linear function of them.
    """
    density, stress = float(number_density(packing_fraction, 2)), Relaxation.of(packing_fraction, "viscosity")
    matrix = _matrix(wave_numbers, 1, [(0, stress, density)])
    matrix[:, 0, 0] = -(wave_numbers**2) * (stress.total - stress.slow) / density
    return matrix


def longitudinal_matrix(packing_fraction: float, wave_numbers: np.ndarray) -> np.ndarray:
    """Compute the matrix of density, temperature, velocity along k, heat flux and stress.

    Parameters
    ----------
    packing_fraction : float, [1]
        Packing fraction eta.
    wave_numbers : ndarray, shape (M,), [1/length]
        Wave numbers k.

    Returns
    -------
    ndarray of complex, shape (M, n, n), [1/time]
        Time derivatives of the variables, as a linear function of them. Heat flux and stress have several
        parts.
    """
    eta = packing_fraction
    density, z = float(number_density(eta, 2)), float(compressibility_factor(eta, 2))
    capacity, speed = heat_capacities(eta, 2)[0], float(speed_of_sound(eta, 2))
    stress, flux = Relaxation.of(eta, "viscosity"), Relaxation.of(eta, "conductivity")
    heat = density * capacity
    matrix = _matrix(wave_numbers, 3, [(1, flux, heat), (2, stress, density)])
    for variable, coupling in ((0, math.sqrt(speed**2 - z**2 / capacity)), (1, z / math.sqrt(capacity))):
        matrix[:, variable, 2] = matrix[:, 2, variable] = -1j * wave_numbers * coupling
    along = float(enskog_longitudinal_viscosity(eta, 2))  # its slow part is that of the shear viscosity
    matrix[:, 1, 1] = -(wave_numbers**2) * (flux.total - flux.slow) / heat
    matrix[:, 2, 2] = -(wave_numbers**2) * (along - stress.slow) / density
    return matrix


def _matrix(
    wave_numbers: np.ndarray, variables: int, fluxes: list[tuple[int, Relaxation, float]]
) -> np.ndarray:
    """Return the (M, n, n) matrix of hydrodynamic variables, followed by the parts of the fluxes.

    The hydrodynamic variables' own block is still 0. Each flux is a tuple: the variable that it carries, its
    relaxation, and the density or heat capacity of this variable.
    """
    size = variables + sum(len(flux.rates) for _, flux, _ in fluxes)
    matrix, place = np.zeros((len(wave_numbers), size, size), complex), variables
    for variable, flux, inertia in fluxes:
        for rate, part in zip(flux.rates, flux.parts, strict=True):
            matrix[:, place, place] = -rate
            coupling = -1j * wave_numbers * math.sqrt(part * rate / inertia)
            matrix[:, variable, place] = matrix[:, place, variable] = coupling
            place += 1
    return matrix


def _modes(matrix: np.ndarray, variables: int) -> Modes:
    """Return all modes of symmetric matrices.

    Their left eigenvectors are the right eigenvectors, of product 1 without complex conjugation.
    """
    decay, modes = np.linalg.eig(matrix)
    modes = modes / np.sqrt((modes**2).sum(axis=1))[:, None, :]
    return Modes(decay.T, modes[:, :variables].transpose(2, 1, 0))
