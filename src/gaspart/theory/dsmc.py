"""What cells and time steps do to a gas simulated by direct simulation Monte Carlo (DSMC).

Widths are in mean free paths l = 1 / (sqrt 2 pi n sigma^2), steps in l / c with c = sqrt(2 k_B T / m). In a
cell momentum and energy pass between particles wherever they are in it; in a step all particles fly before
any collide. Both are exact in the first Sonine approximation, whose fluxes relax exponentially.
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
"""Of (width / l)^2, spheres; Alexander, Garcia & Alder, Phys. Fluids 10, 1540 (1998), with its erratum,
Phys. Fluids 12, 731 (2000). A particle's own displacement passes nothing on, so D has none."""
STEP_COEFFICIENTS = {
    "viscosity": 16.0 / (75.0 * math.pi),
    "conductivity": 64.0 / (675.0 * math.pi),
    "diffusion": 4.0 / (27.0 * math.pi),
}
"""Of (c step / l)^2, spheres; Hadjiconstantinou, Phys. Fluids 12, 2634 (2000), confirmed by Garcia & Wagner,
Phys. Fluids 12, 2621 (2000)."""


def cell_factor(quantity: str, width: Numbers) -> Values:
    """A transport coefficient of spheres in cells of this width over that in narrow ones: 1 + a width^2, with
    <dx^2> = width^2 / 6 of two places in a cell (exact at any width)."""
    return 1.0 + CELL_COEFFICIENTS[quantity] * np.square(width)


def step_factor(quantity: str, step: Numbers) -> Values:
    """A transport coefficient of spheres with steps of this length over that with short ones.

    (x/2) coth(x/2) = 1 + x^2/12 - ..., x = step over the relaxation time of the flux: the sum of its
    correlation at whole steps in place of the integral. x^2/12 is the literature's first order.
    """
    half = np.sqrt(3.0 * STEP_COEFFICIENTS[quantity]) * np.maximum(step, 1e-6)  # its limit, where it is 0 / 0
    return half / np.tanh(half)


def diffusion_by_modes(
    side: float, count: int, dimension: int, cells: int, path: float, spreading: float
) -> float:
    """What the fluctuating flow in a periodic cube or square adds to D of a kinetic equation, over k_B T / m.

    (1 / d N) sum over k of (d - 1) / [(nu + D) k^2], a time: the integral of the shear modes in `modes`,
    which carry particles along (Donev, Bell, de la Fuente and Garcia, Phys. Rev. Lett. 106, 204501 (2011)).
    Wave vectors k are those that `cells` along each side resolve, up to half of their number, and that are
    longer waves than 2 pi mean free paths, `path`. With one cell there is none: partners are drawn wherever
    they are. spreading: nu + D (length^2 / time). Hydrodynamics: an estimate, of which a half is uncertain.
    """
    squares, numbers = wave_vectors(dimension, int(min(0.5 * cells, 0.5 * side / (math.pi * path))))
    waves = (2.0 * math.pi / side) ** 2 * squares
    return float((dimension - 1.0) / (dimension * count * spreading) * (numbers / waves).sum())
