"""How often the event-driven engine's clocks start again from zero, lest they lose precision."""

from __future__ import annotations

import numpy as np

from gaspart.engines.arrays import face_energy
from gaspart.scene.scene import Scene
from gaspart.state.state import State

_LAP = 10  # a lap of the clocks is some 2^10 times of flight over a diameter
_STILL = 2.0**960  # the lap of a scene in which nothing moves


def lap_length(scene: Scene, state: State) -> float:
    """The time after which clocks start again from zero: a power of two, so that it scales with the units."""
    square = float((state.velocities**2).sum(axis=1).mean()) if state.count else 0.0
    if scene.gravity is not None:  # the square of the speed that a fall can add
        square += 2.0 * sum(abs(g) * length for g, length in zip(scene.gravity, state.lengths, strict=True))
    if scene.faces and state.count:  # and of those that a wall can give
        square += face_energy(scene) / float(state.masses.min())
    speed = float(np.sqrt(square))
    if not speed > 0.0:
        return _STILL
    _, exponent = np.frexp(2 * scene.smallest_radius / speed)
    return float(np.ldexp(1.0, int(exponent) + _LAP))
