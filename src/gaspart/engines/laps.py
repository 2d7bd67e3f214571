"""How often the event-driven engine's clocks start again from zero, lest they lose precision."""

from __future__ import annotations

import math

import numpy as np

from gaspart.engines.common import face_energy
from gaspart.scene import Scene

_LAP = 10  # a lap of the clocks is some 2^10 times of flight over a diameter
_STILL = 2.0**960  # the lap of a scene in which nothing moves
_OTHER = 2.0**10  # by which speeds must have changed for laps of another length
QUIET = 64
"""Laps without an event after which laps are doubled."""


def _speed(scene: Scene, velocities: np.ndarray, lightest: float) -> float:
    """The speed that times of flight are measured with: the rms speed, and what may be added to it."""
    square = float((velocities**2).sum(axis=1).mean()) if len(velocities) else 0.0
    if scene.gravity is not None:  # the square of the speed that a fall can add
        lengths = scene.container.lengths
        square += 2.0 * sum(abs(g) * length for g, length in zip(scene.gravity, lengths, strict=True))
    if scene.faces and len(velocities):  # and of those that a wall can give
        square += face_energy(scene) / lightest
    return math.sqrt(square)


def lap_length(scene: Scene, velocities: np.ndarray, lightest: float, present: float = 0.0) -> float:
    """The time after which clocks start again from zero, for velocities (N, d) and masses of at least
    `lightest`: a power of two, so that it scales with the units.

    A `present` length is kept until speeds have changed by a factor of 2^10: a cooling gas needs longer laps,
    since the work of a lap does not depend on its length.
    """
    speed = _speed(scene, velocities, lightest)
    length = _STILL
    if speed > 0.0:
        length = _power_of_two(2 * scene.smallest_radius / speed, _LAP)
    return present if present / _OTHER < length < present * _OTHER else length


def quiet_lap(scene: Scene, velocities: np.ndarray, lightest: float, lap: float, quiet: int) -> float:
    """The length of a lap after so many `quiet` ones, in which nothing happened: twice the last one, until it
    is a time of flight through the container. The clocks are then as precise as the positions."""
    speed = _speed(scene, velocities, lightest)
    most = _power_of_two(max(scene.container.lengths) / speed, 0) if speed > 0.0 else lap
    doublings = min(max(quiet - QUIET, 0), max(0, math.frexp(most)[1] - math.frexp(lap)[1]))
    return math.ldexp(lap, doublings)


def _power_of_two(time: float, more: int) -> float:
    """The next power of two above a time, times 2^more; at most `_STILL`."""
    _, exponent = math.frexp(time)
    return min(math.ldexp(1.0, exponent + more), _STILL) if time < _STILL else _STILL
