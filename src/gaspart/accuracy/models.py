"""Errors of equations and of steps in a gas in equilibrium, by theory."""

from __future__ import annotations

import math

from gaspart import theory
from gaspart.analysis import bulk
from gaspart.analysis.observables import OBSERVABLES
from gaspart.scene.gas import Gas
from gaspart.theory.dsmc import step_factor


def model_error(packing_fraction: float, dimension: int, equation: str, observable: str) -> float:
    """Return the |error| of an observable due to the equation that an engine solves.

    The equation is `Engine.equation`; the error is relative to hard spheres or discs, inf where either of
    them has no value, like D of discs. The Boltzmann equation has a contact value of 1, and no virial. The
    Enskog model is given the contact value of Carnahan and Starling, in two dimensions the value of
    Henderson. In neither does D have the memory of correlated collisions [Erpenbeck 1991], whose uncertainty
    is added.
    """
    if equation == bulk.EXACT:
        return 0.0
    gas = Gas(dimension, packing_fraction, 1, 1.0, 1.0)
    of = getattr(bulk, OBSERVABLES[observable].bulk)
    exact, own = of(gas, bulk.EXACT), of(gas, equation)
    if math.isnan(exact) or math.isnan(own):
        return math.inf
    remembers = OBSERVABLES[observable].memory and packing_fraction > 0.01
    return abs(own / exact - 1.0) + (theory.ERPENBECK_WOOD_UNCERTAINTY if remembers else 0.0)


def step_error(packing_fraction: float, step: float) -> float:
    """Compute the relative error of D of spheres due to steps, which make it too high.

    Steps are in diameters divided by the thermal speed. The law is given for a dilute gas; a dense gas
    collides more often by the contact value, as if its free path were shorter by this factor.
    """
    path = float(theory.mean_free_path(packing_fraction, 3))
    return float(step_factor("diffusion", step * math.sqrt(2.0) / path)) - 1.0
