"""Errors of the DSMC engine in a gas in equilibrium, by theory."""

from __future__ import annotations

import math

import numpy as np

from gaspart import theory
from gaspart.engines import DSMC
from gaspart.scene.scene import Scene
from gaspart.theory.dsmc import step_factor

CELL_LOSS = 0.5
"""Part of its collisions that the Enskog model loses at most, times the particles in a cell: those that have
met part, and among few others those that approach become rare (docs/dsmc.md: 8 in a cell lose 3 % at a
packing fraction of 0.1, 6 % at 0.4)."""


def model_error(packing_fraction: float, dimension: int, model: str, observable: str) -> float:
    """|error| of an observable by the Boltzmann or the Enskog equation, relative to hard spheres or discs.

    The Boltzmann equation has a contact value of 1, and no virial. The Enskog model is given the contact
    value of Carnahan and Starling, in two dimensions that of Henderson. D of neither has the memory of
    correlated collisions [Erpenbeck 1991], whose uncertainty is added; discs have no D, and its error is inf.
    """
    eta, contact = packing_fraction, float(theory.contact_value(packing_fraction, dimension))
    z, first_order = float(theory.compressibility_factor(eta, dimension)), 2.0 ** (dimension - 1) * eta
    equation = theory.carnahan_starling if dimension == 3 else theory.henderson
    given = 1.0 if model == "boltzmann" else (float(equation(eta)) - 1.0) / first_order
    if observable == "collision_rate":
        return abs(given / contact - 1.0)
    if observable == "Z":
        virial = 0.0 if model == "boltzmann" else first_order * given
        return abs((1.0 + virial) / z - 1.0)
    if dimension == 2:
        return math.inf
    ratio = float(theory.erpenbeck_wood_ratio(eta))
    known = theory.ERPENBECK_WOOD_UNCERTAINTY if eta > 0.01 else 0.0
    return abs(contact / (given * ratio) - 1.0) + known


def step_error(packing_fraction: float, step: float) -> float:
    """By how much steps, in diameters over the thermal speed, make D of spheres too high. The law is stated
    for a dilute gas; a dense one collides more often by the contact value, as if its free path were shorter
    by that."""
    path = float(theory.mean_free_path(packing_fraction, 3))
    return float(step_factor("diffusion", step * math.sqrt(2.0) / path)) - 1.0


def cell_loss(engine: DSMC, scene: Scene) -> float:
    """Bound on the part of its collisions that the Enskog model loses; none in a single cell."""
    cells = int(np.prod(engine.resolved(scene).cells_per_side or 1))
    return float(CELL_LOSS * cells / scene.count) if cells > 1 else 0.0
