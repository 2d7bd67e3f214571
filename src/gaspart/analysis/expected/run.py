"""What is known of the engine of a run, and of its number of particles.

A run of the DSMC engine is that of the Boltzmann or the Enskog equation, not of spheres that touch, and is
compared with these. Where a value is that of a finite number N of particles, k_B T is that of their d (N - 1)
degrees of freedom of flight about the centre of mass. The uncertainty contains what cells and steps of the
engine do; it is NaN where it is not known, as of an approximation.
"""

from __future__ import annotations

import json
from typing import Any, TypeAlias

import numpy as np

from gaspart import theory
from gaspart.analysis.bulk import BOLTZMANN, ENSKOG, EXACT
from gaspart.analysis.run import Run
from gaspart.engines import Engine, engine_from_dict
from gaspart.scene.gas import Mixture

Expected: TypeAlias = tuple[Any, Any, str]
"""Values, their uncertainties, and the source."""
OF_NUMBER = "of this number of particles"
LEAST_OF_MIXTURE = 10
"""Least number of particles of several sizes for which a theory is stated: terms of second order in 1/N are
not known."""
SOURCES = {EXACT: "Enskog", BOLTZMANN: "Boltzmann equation", ENSKOG: "Enskog equation"}
"""Of what kinetic theory states of each equation; of particles that touch it is an approximation."""


def engine_of(run: Run) -> Engine | None:
    """The engine that made a run; None if the frames do not state it."""
    text = run.data.attrs.get("engine")
    return engine_from_dict(json.loads(text)) if text else None


def equation_of(run: Run) -> str:
    """The equation that the engine of a run solves, `EXACT` if the frames do not state an engine."""
    engine = engine_of(run)
    return engine.equation if engine else EXACT


def bias_of(run: Run, kind: str) -> float:
    """The relative error that the engine states of its cells and steps."""
    engine = engine_of(run)
    return engine.bias(run.scene, kind) if engine else 0.0


def partners(run: Run) -> float:
    """A particle has N - 1 others about it where the equation of state has N."""
    return 1.0 - 1.0 / run.count


def contact_of_number(run: Run, packing_fraction: float, dimension: int) -> tuple[float, float] | None:
    """Return the contact value of the N particles of a periodic gas, and its uncertainty.

    None where theory does not state it: for few particles at high density (`theory.finite_contact_value`).
    """
    lengths = np.array(run.scene.container.lengths)
    volume = packing_fraction * float(lengths.prod()) / run.count  # of a particle
    diameter = (volume / theory.particle_volume(dimension)) ** (1.0 / dimension)
    try:
        side = float(lengths.min()) / diameter
        return theory.finite_contact_value(packing_fraction, dimension, run.count, side)
    except ValueError:
        return None


def scale_of_number(run: Run, mixture: Mixture) -> float | None:
    """Return the contact value of N particles divided by that of infinitely many, as of equal ones.

    None for fewer than `LEAST_OF_MIXTURE` particles, and where it is not known for equal ones.
    """
    eta, d = mixture.packing_fraction, mixture.dimension
    if run.count < LEAST_OF_MIXTURE or (found := contact_of_number(run, eta, d)) is None:
        return None
    return found[0] / float(theory.contact_value(eta, d))
