"""Epochs of the event-driven engine's clocks, which restart from zero so that they lose no precision."""

from __future__ import annotations

import math

import numpy as np

from gaspart.engines.arrays import face_energy
from gaspart.engines.vibration import greatest_speed
from gaspart.scene.faces import pistons
from gaspart.scene.scene import Scene

_LENGTH = 10  # an epoch of the clocks is some 2^10 times of flight over a diameter
_AT_REST = 2.0**960  # the epoch of a scene in which nothing moves
_OTHER = 2.0**10  # by which speeds must have changed for epochs of another length
QUIET = 64
"""Epochs without an event after which epochs are doubled."""


def _speed(scene: Scene, velocities: np.ndarray, lightest: float) -> float:
    """The speed for times of flight: the rms speed, with the largest gain by gravity and walls, among them
    twice the speed that its load gives a piston."""
    square = float((velocities**2).sum(axis=1).mean()) if len(velocities) else 0.0
    if scene.gravity is not None:  # the square of the speed gained in a fall
        lengths = scene.container.lengths
        square += 2.0 * sum(abs(g) * length for g, length in zip(scene.gravity, lengths, strict=True))
    if scene.faces and len(velocities):  # and of the speed gained at a wall
        square += face_energy(scene) / lightest + (2.0 * greatest_speed(scene)) ** 2
        square += sum(8.0 * face.pressure * scene.container.volume / face.mass for _, face in pistons(scene))
    return math.sqrt(square)


def epoch_length(scene: Scene, velocities: np.ndarray, lightest: float, present: float = 0.0) -> float:
    """The time after which clocks start again from zero, for velocities (N, d) and masses of at least
    `lightest`: a power of two, so that it scales with the units.

    A `present` length is kept until speeds have changed by a factor of 2^10: a cooling gas needs longer
    epochs, since the work of an epoch does not depend on its length.
    """
    speed = _speed(scene, velocities, lightest)
    length = _AT_REST
    if speed > 0.0:
        length = _power_of_two(2 * scene.smallest_radius / speed, _LENGTH)
    return present if present / _OTHER < length < present * _OTHER else length


def quiet_epoch(scene: Scene, velocities: np.ndarray, lightest: float, epoch: float, quiet: int) -> float:
    """The length of an epoch after so many `quiet` ones, without an event: twice the last one, until
    it is a time of flight through the container. The clocks are then as precise as the positions."""
    speed = _speed(scene, velocities, lightest)
    most = _power_of_two(max(scene.container.lengths) / speed, 0) if speed > 0.0 else epoch
    doublings = min(max(quiet - QUIET, 0), max(0, math.frexp(most)[1] - math.frexp(epoch)[1]))
    return math.ldexp(epoch, doublings)


def _power_of_two(time: float, more: int) -> float:
    """The next power of two above a time, times 2^more; at most `_AT_REST`."""
    _, exponent = math.frexp(time)
    return min(math.ldexp(1.0, exponent + more), _AT_REST) if time < _AT_REST else _AT_REST
