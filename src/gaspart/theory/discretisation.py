"""Effects of cells and time steps of engines, and contact values of the Enskog model.

For DSMC, widths are in mean free paths l = 1 / (sqrt 2 pi n sigma^2), steps in l / c with c = sqrt(2 k_B T /
m). Particles within a cell exchange momentum and energy at any distance. Within a step, all particles
move before any collision takes place. Both effects are computed exactly in the first Sonine approximation, in
which fluxes relax exponentially.

Each run depends on the formulas of its engine, so this module imports no other theory except for geometry.
"""

from __future__ import annotations

import math

import numpy as np

from gaspart.scene.sizes import ball_volume
from gaspart.theory.geometry import Numbers, Values

SLOPE, BEND = {2: 0.5625, 3: 1.5}, {2: 0.0, 3: 0.5}
"""Coefficients of the contact value, see `contact_values`, by dimension."""
HIGHEST = 0.7
"""Packing fraction up to which contact values are evaluated."""
MISSED_CONTACTS = {2: 1.0 / 4.0, 3: 2.0 / 3.0}
"""Fraction of the contacts of a dilute gas that begin and end within a step, divided by (v_th dt / sigma)^2,
by dimension, with v_th = sqrt(k_B T / m): the flux of pairs through chords that they cross within a step.
"""
ONE_PASS = 4.0
"""Factor of the missed contacts if a step resolves only overlaps that grow, in one pass."""
CELL_COEFFICIENTS = {
    "viscosity": 16.0 / (45.0 * math.pi),
    "conductivity": 32.0 / (225.0 * math.pi),
    "diffusion": 0.0,
}
"""Coefficients of (width / l)^2, spheres; Alexander, Garcia & Alder, Phys. Fluids 10, 1540 (1998), with its
erratum, Phys. Fluids 12, 731 (2000). The displacement of a single particle transfers nothing to others, so
cells do not change D.
"""
CELL_VISCOSITY = {2: math.pi / 24.0, 3: CELL_COEFFICIENTS["viscosity"]}
"""Coefficients of (width / l)^2 for the viscosity, by dimension; for discs by the same argument."""
STRESS_TRANSFER = {2: 1.0 / 12.0, 3: 1.0 / 18.0}
"""Viscosity due to the distance of partners in a cell, divided by n m nu width^2, by dimension.

n is the number density and nu the collision rate of a particle. `CELL_VISCOSITY` is this value divided by the
viscosity of a dilute gas.
"""
DENSE_VISCOSITY = {2: (1.0, 0.25 + 2.0 / math.pi), 3: (0.8, 0.16 + 48.0 / (25.0 * math.pi))}
"""Coefficients a and b of Enskog's viscosity 1 + a (Z - 1) + b (Z - 1)^2, by dimension.

The unit is the viscosity of a dilute gas divided by the contact value (Chapman & Cowling 1970; for discs
Gass, J. Chem. Phys. 54, 1898 (1971)).
"""
STEP_COEFFICIENTS = {
    "viscosity": 16.0 / (75.0 * math.pi),
    "conductivity": 64.0 / (675.0 * math.pi),
    "diffusion": 4.0 / (27.0 * math.pi),
}
"""Coefficients of (c step / l)^2, spheres; Hadjiconstantinou, Phys. Fluids 12, 2634 (2000), confirmed by
Garcia & Wagner, Phys. Fluids 12, 2621 (2000)."""


def contact_values(number_densities: np.ndarray, radii: np.ndarray, dimension: int) -> np.ndarray:
    """Compute the contact values of a mixture in the Enskog model."""
    filled = ball_volume(dimension) * float((number_densities * radii**dimension).sum())
    free = 1.0 - min(filled, HIGHEST)
    surface = ball_volume(dimension) * float((number_densities * radii ** (dimension - 1)).sum())
    ratio = surface * 2.0 * radii[:, None] * radii / (radii[:, None] + radii)
    return 1.0 / free + SLOPE[dimension] * ratio / free**2 + BEND[dimension] * ratio**2 / free**3


def cell_factor(quantity: str, width: Numbers) -> Values:
    """Compute a transport coefficient of spheres in cells divided by its value in small cells."""
    return 1.0 + CELL_COEFFICIENTS[quantity] * np.square(width)


def step_factor(quantity: str, step: Numbers) -> Values:
    """Compute a transport coefficient of spheres with time steps divided by its value with short steps."""
    half = np.sqrt(3.0 * STEP_COEFFICIENTS[quantity]) * np.maximum(step, 1e-6)  # limit of 0 / 0
    return half / np.tanh(half)
