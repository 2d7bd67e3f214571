"""Effects of cells and time steps on a gas simulated by direct simulation Monte Carlo (DSMC).

Widths are in mean free paths l = 1 / (sqrt 2 pi n sigma^2), steps in l / c with c = sqrt(2 k_B T / m). In a
cell momentum and energy pass between particles wherever they are in it; in a step all particles fly before
any collide. Both effects are exact in the first Sonine approximation, whose fluxes relax exponentially.
"""

from __future__ import annotations

import math

import numpy as np

from gaspart.theory._arguments import Numbers, Values
from gaspart.theory.modes import wave_vectors

CELL_COEFFICIENTS = {
    "viscosity": 16.0 / (45.0 * math.pi),
    "conductivity": 32.0 / (225.0 * math.pi),
    "diffusion": 0.0,
}
"""Coefficients of (width / l)^2, spheres; Alexander, Garcia & Alder, Phys. Fluids 10, 1540 (1998), with its
erratum, Phys. Fluids 12, 731 (2000). A particle's own displacement passes nothing on, so D has none."""
STEP_COEFFICIENTS = {
    "viscosity": 16.0 / (75.0 * math.pi),
    "conductivity": 64.0 / (675.0 * math.pi),
    "diffusion": 4.0 / (27.0 * math.pi),
}
"""Coefficients of (c step / l)^2, spheres; Hadjiconstantinou, Phys. Fluids 12, 2634 (2000), confirmed by
Garcia & Wagner, Phys. Fluids 12, 2621 (2000)."""


def cell_factor(quantity: str, width: Numbers) -> Values:
    """Compute a transport coefficient of spheres in cells divided by the value in narrow cells.

    Parameters
    ----------
    quantity : {"viscosity", "conductivity", "diffusion"}
        Transport coefficient.
    width : array_like, [1]
        Width of a cell in mean free paths.

    Returns
    -------
    float or ndarray, same shape as `width`, [1]
        Factor of the coefficient.

    Notes
    -----
    1 + a width^2 with a of `CELL_COEFFICIENTS`, and <dx^2> = width^2 / 6 for two positions in a cell (exact
    at any width).
    """
    return 1.0 + CELL_COEFFICIENTS[quantity] * np.square(width)


def step_factor(quantity: str, step: Numbers) -> Values:
    """Compute a transport coefficient of spheres with time steps divided by its value with short steps.

    Parameters
    ----------
    quantity : {"viscosity", "conductivity", "diffusion"}
        Transport coefficient.
    step : array_like, [1]
        Time step in mean free paths divided by sqrt(2 k_B T / m).

    Returns
    -------
    float or ndarray, same shape as `step`, [1]
        Factor of the coefficient.

    Notes
    -----
    (x/2) coth(x/2) = 1 + x^2/12 - ..., where x is the step divided by the relaxation time of the flux: the
    sum of the flux's correlation at whole steps replaces the integral. x^2/12 is the literature's first
    order, `STEP_COEFFICIENTS`.
    """
    half = np.sqrt(3.0 * STEP_COEFFICIENTS[quantity]) * np.maximum(step, 1e-6)  # its limit, where it is 0 / 0
    return half / np.tanh(half)


def diffusion_by_modes(
    side: float, count: int, dimension: int, cells: int, path: float, spreading: float
) -> float:
    """Estimate the contribution of the fluctuating flow to the self-diffusion of a kinetic equation.

    Parameters
    ----------
    side : float, [length]
        Side of the periodic cube or square.
    count : int
        Number N of particles.
    dimension : {2, 3}
        Discs or spheres.
    cells : int
        Number of cells along each side.
    path : float, [length]
        Mean free path.
    spreading : float, [length^2/time]
        Kinematic viscosity plus diffusion coefficient, nu + D.

    Returns
    -------
    float, [time]
        Contribution to D, divided by k_B T / m.

    Notes
    -----
    (1 / d N) sum over k of (d - 1) / [(nu + D) k^2]: the integral of the shear modes in `modes`, which carry
    particles along [1]_. The wave vectors k are those that `cells` along each side resolve, up to half of
    their number, and whose waves are longer than 2 pi mean free paths. With one cell no mode contributes:
    partners are drawn wherever they are. This is hydrodynamics: an estimate, of which a half is uncertain.

    References
    ----------
    .. [1] A. Donev, J. B. Bell, A. de la Fuente and A. L. Garcia, Phys. Rev. Lett. 106, 204501 (2011).
    """
    squares, numbers = wave_vectors(dimension, int(min(0.5 * cells, 0.5 * side / (math.pi * path))))
    waves = (2.0 * math.pi / side) ** 2 * squares
    return float((dimension - 1.0) / (dimension * count * spreading) * (numbers / waves).sum())
