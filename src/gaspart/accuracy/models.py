"""Errors of the DSMC engine in a gas in equilibrium, by theory."""

from __future__ import annotations

import math

from gaspart import theory
from gaspart.analysis import bulk
from gaspart.analysis.observables import OBSERVABLES
from gaspart.engines import DSMC
from gaspart.scene.gas import Gas
from gaspart.scene.scene import Scene
from gaspart.theory.dsmc import step_factor


def model_error(packing_fraction: float, dimension: int, model: str, observable: str) -> float:
    """|error| of an observable by the Boltzmann or the Enskog equation, relative to hard spheres or discs;
    inf where one of them has none, as of D of discs.

    The Boltzmann equation has a contact value of 1, and no virial. The Enskog model is given the contact
    value of Carnahan and Starling, in two dimensions that of Henderson. D of neither has the memory of
    correlated collisions [Erpenbeck 1991], whose uncertainty is added.
    """
    gas = Gas(dimension, packing_fraction, 1, 1.0, 1.0)
    of = getattr(bulk, OBSERVABLES[observable].bulk)
    exact, own = of(gas, bulk.EXACT), of(gas, model)
    if math.isnan(exact) or math.isnan(own):
        return math.inf
    remembers = OBSERVABLES[observable].memory and packing_fraction > 0.01
    return abs(own / exact - 1.0) + (theory.ERPENBECK_WOOD_UNCERTAINTY if remembers else 0.0)


def step_error(packing_fraction: float, step: float) -> float:
    """By how much steps, in diameters over the thermal speed, make D of spheres too high. The law is stated
    for a dilute gas; a dense one collides more often by the contact value, as if its free path were shorter
    by that."""
    path = float(theory.mean_free_path(packing_fraction, 3))
    return float(step_factor("diffusion", step * math.sqrt(2.0) / path)) - 1.0


def cell_loss(engine: DSMC, scene: Scene) -> float:
    """Bound on the part of its collisions that the Enskog model loses; none in a single cell."""
    return engine.bias(scene, "rates")
