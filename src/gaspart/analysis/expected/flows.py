"""The mean velocity of a gas along an axis: at rest, sheared, and between plates that slide."""

from __future__ import annotations

import numpy as np

from gaspart import theory
from gaspart.analysis.expected.run import Expected
from gaspart.analysis.expected.walls import FLUID, FREE, Plates, dilute, heating_of, plates_of
from gaspart.analysis.run import Run
from gaspart.scene.driving import driven_axes
from gaspart.scene.faces import sliding_faces
from gaspart.scene.shear import flow


def velocity(run: Run, axis: int, places: np.ndarray) -> Expected | None:
    """(component, position) at places (P,) along an axis, in a steady state."""
    scene = run.scene
    if scene.shear_rate is not None:
        middle = np.tile(0.5 * np.array(scene.container.lengths), (len(places), 1))
        middle[:, axis] = places
        return flow(scene, middle).T, 0.0, "the flow of sheared images"
    if plates := plates_of(run):
        return _between(plates, run, axis, places)
    if scene.faces or scene.thermostat or run.dissipates or driven_axes(scene) or scene.walls:
        return None
    if not run.moving.all():
        return None
    momentum = np.einsum("tnd,n->d", run.velocities, run.masses) / len(run.time)
    drift = np.where(run.conserved, momentum / run.masses.sum(), 0.0)
    return np.repeat(drift[:, None], len(places), axis=1), 0.0, "equilibrium"


def _between(plates: Plates, run: Run, axis: int, places: np.ndarray) -> Expected | None:
    """Between plates of one temperature, or that do not slide."""
    velocities = dict(sliding_faces(run.scene))
    ends = [velocities.get(2 * plates.axis + side) for side in (0, 1)]
    rest = (0.0,) * run.dimension
    low, high = (np.array(face.velocity if face else rest) for face in ends)
    mean = np.repeat(0.5 * (low + high)[:, None], len(places), axis=1)
    if not plates.slide.any():
        return mean, 0.0, "the gas is at rest between the plates"
    if not plates.equal:
        return None
    if axis != plates.axis:
        return mean, 0.0, "the mean of both plates, by symmetry"
    if plates.knudsen > FREE:
        error = np.abs(plates.slide)[:, None] / plates.knudsen
        return mean, error, "free flight between plates: half of the particles come from each"
    if plates.dimension == 2 or plates.knudsen > FLUID or not dilute(plates, run):
        return None
    path = plates.knudsen * plates.length
    gap = plates.length + 2.0 * theory.VELOCITY_SLIP * path
    middle = 0.5 * run.scene.container.lengths[axis]
    values = mean + np.multiply.outer(plates.slide, (places - middle) / gap)
    wrong = np.abs(plates.slide)[:, None] * (plates.knudsen**2 + heating_of(plates))
    near = np.abs(places - middle) > 0.5 * plates.length - 2.0 * path  # the layer that no fluid describes
    return np.where(near, np.nan, values), wrong, "linear flow with slip"
