"""What the time-stepped engine can model, and with what settings."""

from __future__ import annotations

import math

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene import Scene
from gaspart.state import State

_GIANTS = 16  # at most so many bodies are tested against all others
_GIANT = 2.0  # radii of the next smaller body that make one of them


def giants_of(state: State) -> np.ndarray:
    """(N,) which bodies are too large for the partition: a few, much larger than all the others."""
    order = np.argsort(state.radii, kind="stable")
    sizes = state.radii[order]
    giants = np.zeros(state.count, dtype=bool)
    for few in range(1, min(_GIANTS, state.count - 1) + 1):
        if sizes[-few] > _GIANT * sizes[-few - 1]:
            giants[order[-few:]] = True
    return giants


def check_scene(scene: Scene, state: State, giants: np.ndarray) -> None:
    """Raise SceneError for what this engine does not model."""
    rough = scene.restitution is not None and not scene.restitution.smooth_and_elastic
    fixed = np.isinf(state.masses).any()
    for key, value in (
        ("restitution", scene.restitution if rough else None),
        ("walls", scene.walls or None),
        ("faces", scene.faces or None),
        ("vibration", scene.vibrates or None),
        ("fixed", True if fixed and scene.gravity is not None else None),
    ):
        if value is not None:
            what = "this one knows no fixed bodies under gravity" if key == "fixed" else "this one knows none"
            raise SceneError(key, value, f'needs the "event" engine; {what}')
    reach = 2.0 * state.radii.max(initial=0.0)
    if giants.any():
        reach = state.radii[giants].min() + state.radii.max()
    for length, periodic in zip(scene.container.lengths, scene.container.periodic, strict=True):
        if periodic and length < reach:
            rule = "the time-stepped engine needs periodic sides of two largest diameters"
            raise SceneError("lengths", scene.container.lengths, rule)


def check_step(engine, scene: Scene, state: State) -> None:
    """Raise SceneError for a step with which the engine would be wrong."""


def passes_for(engine, scene: Scene, state: State) -> int:
    """How often a step looks for overlaps."""
    return engine.passes or 1


def quantum_for(scene: Scene, state: State, masses: np.ndarray) -> float:
    """The unit in which momenta given to walls are summed: a power of two, 2^-28 of the largest momentum."""
    speeds = np.sqrt((state.velocities**2).sum(axis=1))
    if scene.gravity is not None:
        speeds = speeds + math.sqrt(2.0 * float(np.abs(scene.gravity) @ np.array(scene.container.lengths)))
    most = float(np.where(np.isinf(masses), 0.0, masses * speeds).max(initial=0.0))
    return 2.0 ** (math.frexp(most or 1.0)[1] - 28)
