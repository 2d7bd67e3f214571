"""Observables from the counters of a run: pressure and collision rate."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gaspart import theory
from gaspart.analysis.observable import Observable, observable, scalar
from gaspart.analysis.source import Run, Source, measured, require_elastic, require_periodic
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.trajectory.amber import face_names

_BLOCKS = 16


def compressibility_factor(source: Source, start: float | None = None) -> Observable:
    """Z = P V / (N k_B T) of a periodic scene, dimensionless, by the virial theorem:

    Z = 1 + sum |dr . dp| / (d N k_B T t), with k_B T = 2 E / (d (N - 1)) about the centre of mass. source: a
    trajectory, by its path or open, or a simulation; start: the time from which frames count (by default a
    quarter of the run). Theory is that of the fluid, with the correction of first order in 1/N.

    Raises SceneError for walls, fixed particles, contacts that lose energy, and too few frames.
    """
    with measured(source, start) as run:
        require_periodic(run)
        require_elastic(run)
        if not run.moving.all():
            raise SceneError("species.fixed", True, "the virial of fixed particles is not a pressure")
        scale = run.dimension * run.count * run.temperature
        z = 1.0 + run.increments("virial_sum") / (scale * np.diff(run.time))
        about: dict[str, Any] = {"units": "1", "long_name": "compressibility factor Z"}
        return scalar("compressibility_factor", z, run.time, **about, **_theory_of_z(run))


def _theory_of_z(run: Run) -> dict[str, Any]:
    if not run.fluid:
        return {}
    eta, d = run.scene.packing_fraction, run.dimension
    value = float(theory.compressibility_factor(eta, d))
    value += float(theory.finite_size_correction(eta, d, run.count, "canonical"))
    source = "reference equation of state of the fluid, corrected for the number of particles"
    return {"theory": (value, float(theory.compressibility_uncertainty(eta, d))), "source": source}


def wall_pressure(source: Source, start: float | None = None) -> Observable:
    """Pressure on each face of the container that is a wall, (face,): the momentum given to it per time and
    per area that centres can touch.

    source, start: as in `compressibility_factor`. Theory: that of equal particles between hard walls of one
    distance (`gaspart.theory.wall_pressure`). Raises SceneError without walls and for too few frames.
    """
    with measured(source, start) as run:
        d, walled = run.dimension, ~run.periodic
        if not walled.any():
            raise SceneError("container.boundary", "periodic", "has no walls: measure compressibility_factor")
        blocks = min(_BLOCKS, len(run.time) - 1)
        if blocks < 4:
            raise SceneError("frames", len(run.time), "an error needs 5 or more")
        lower, upper = run.scene.reach(run.scene.largest_radius)
        touched = np.subtract(upper, lower)
        areas = np.repeat(touched.prod() / touched, 2)
        ends = np.linspace(0, len(run.time) - 1, blocks + 1).astype(int)
        impulse = np.diff(run.data["wall_impulse"].values[ends, : 2 * d], axis=0)
        series = impulse / np.diff(run.time[ends])[:, None] / areas
        faces = np.array(face_names(d))
        chosen = np.repeat(walled, 2)
        values, errors = means_of(np.abs(series[:, chosen]))
        return observable(
            "wall_pressure",
            {"face": (faces[chosen], {"long_name": "face of the container"})},
            values,
            errors,
            units="energy / length^d",
            long_name="pressure",
            **_theory_at_walls(run, touched),
        )


def _theory_at_walls(run: Run, touched: np.ndarray) -> dict[str, Any]:
    walled, lengths = ~run.periodic, np.array(run.scene.container.lengths)
    sides = lengths[walled]
    if not run.simple or run.scene.centres_to_walls or np.ptp(sides) > 1e-9 * sides.max():
        return {}
    diameter = run.particle["diameter"]
    density = run.count / float((touched / diameter).prod())
    try:
        value, error = theory.wall_pressure(
            sides[0] / diameter, density, run.count, run.dimension, int(walled.sum())
        )
    except ValueError:  # denser than theory goes
        return {}
    unit = run.temperature / diameter**run.dimension
    return {"theory": (value * unit, error * unit), "source": "fluid between hard walls"}


def collision_rate(source: Source, start: float | None = None) -> Observable:
    """Collisions of one particle per time, 2 M / (N t) for M collisions of pairs; fixed particles do not
    count in N.

    source, start: as in `compressibility_factor`. Theory: exact in equilibrium, with the contact value of
    the fluid's equation of state, corrected for the number of particles. Raises SceneError for too few
    frames.
    """
    with measured(source, start) as run:
        rate = 2.0 * run.increments("collisions") / (run.moving.sum() * np.diff(run.time))
        about: dict[str, Any] = {"units": "1 / time", "long_name": "collisions of a particle per time"}
        return scalar("collision_rate", rate, run.time, **about, **_theory_of_rate(run))


def _theory_of_rate(run: Run) -> dict[str, Any]:
    if not run.fluid:
        return {}
    eta, d = run.scene.packing_fraction, run.dimension
    rate = float(theory.collision_rate(eta, d, **run.particle))
    # the run's temperature is that of d (N - 1) degrees of freedom, theory's factor is relative to d N
    rate *= math.sqrt((run.count - 1) / run.count)
    rate *= float(theory.collision_rate_finite_size_factor(eta, d, run.count))
    z = float(theory.compressibility_factor(eta, d))
    unsure = float(theory.compressibility_uncertainty(eta, d)) / (z - 1.0)
    return {"theory": (rate, rate * unsure), "source": "Enskog's rate, exact in equilibrium"}
