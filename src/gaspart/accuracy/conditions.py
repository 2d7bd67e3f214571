"""Local conditions that a pilot run measures, and the energy of steady scenes."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from gaspart.analysis.run import open_run
from gaspart.errors import SceneError
from gaspart.scene.faces import LeesEdwards, Vibrating
from gaspart.scene.scene import Scene
from gaspart.theory.conditions import Conditions

_LAYERS = 12
"""Number of layers per axis in a measured profile; all layers contain equally many particles."""
_CERTAIN = 4.0
"""Difference between two layers, in standard errors, beyond which the profile has a gradient."""


def measured_conditions(scene: Scene, path: Path) -> Conditions:
    """Measure the local conditions in a run, along the axis with the largest gradient. Raises SceneError for
    a file that does not store all particles.
    """
    with open_run(path, None, sheared=True) as run:
        positions = run.positions[:, run.moving]
        thermal = (run.masses[run.moving] * (run.peculiar**2).sum(axis=2)) / run.dimension
    profiles = [_along(scene, k, positions[..., k], thermal) for k in range(scene.dimension)]
    return min(profiles, key=lambda profile: profile.scale)


def _along(scene: Scene, axis: int, positions: np.ndarray, thermal: np.ndarray) -> Conditions:
    """Compute layers along an axis that contain equally many particles of the frames (T, M)."""
    lower, upper = (corner[axis] for corner in scene.reach(scene.smallest_radius))
    order = np.argsort(positions, axis=None)
    layers = np.array_split(order, _LAYERS)
    sorted_positions = positions.ravel()[order]
    ends = np.cumsum([len(layer) for layer in layers])[:-1]
    edges = np.concatenate([[lower], 0.5 * (sorted_positions[ends - 1] + sorted_positions[ends]), [upper]])
    width = np.maximum(np.diff(edges), 1e-12 * (upper - lower))
    middle, share = 0.5 * (edges[1:] + edges[:-1]), np.full(_LAYERS, 1.0 / _LAYERS)
    crowding = share * (upper - lower) / width
    temperature = np.array([float(thermal.ravel()[layer].mean()) for layer in layers])
    # Particles of one frame are treated as independent, but frames are treated as fully correlated.
    error = math.sqrt(2.0 * _LAYERS / max(1, positions.shape[1]) / max(1.0, len(positions) / 8.0))
    logarithms = [np.log(np.maximum(values, 1e-300)) for values in (crowding, temperature)]
    first, second = np.triu_indices(_LAYERS, 1)
    change = np.maximum(*(np.abs(values[second] - values[first]) for values in logarithms))
    certain = np.maximum(change - _CERTAIN * error, 0.0) / (middle[second] - middle[first])
    scale = 1.0 / float(certain.max()) if certain.max() > 0.0 else math.inf
    return Conditions(scene, share, crowding, temperature, axis, scale)


# Energy of a scene: sources, sinks, and whether a steady state exists.


def require_steady(scene: Scene) -> None:
    """Raise SceneError if a scene is empty, cools or heats, so that observables depend on time."""
    if not scene.count:
        raise SceneError("count", 0, "advice is for a gas: the scene is empty")
    law, loses = scene.restitution, scene.dissipates
    thermal, kicked = bool(scene.face_temperatures), scene.thermostat is not None
    driven = thermal or kicked or any(face.moves for face in scene.faces.values())
    if law is not None and not driven:
        law.refuse_loss(
            "loses energy that nothing returns: there is no steady state to measure; give a duration"
        )
    moved = any(isinstance(face, Vibrating | LeesEdwards) for face in scene.faces.values())
    if (moved or kicked) and not loses and not thermal:
        rule = "nothing takes the energy that the scene is given: there is no steady state; give a duration"
        raise SceneError("restitution", None, rule)


def keeps_energy(scene: Scene) -> bool:
    """Return True if a run conserves its initial energy, or its enthalpy under a loaded piston."""
    loaded = [piston for _, piston in scene.pistons if piston.pressure is not None]
    moved = any(face.moves for face in scene.faces.values() if face not in loaded)
    exchanged = moved or scene.face_temperatures or scene.thermostat is not None or scene.is_open
    return not exchanged and not scene.dissipates
