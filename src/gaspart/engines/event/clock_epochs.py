"""Epochs of the event-driven engine's clocks, which restart from zero so that they lose no precision."""

from __future__ import annotations

import math

import numpy as np

from gaspart.scene.scene import Scene

_LENGTH = 10  # an epoch of the clocks is some 2^10 times of flight over a diameter
_AT_REST = 2.0**960  # the epoch of a scene in which nothing moves
_RESOLVED = 2.0**-52  # of speeds
_OTHER = 2.0**10  # by which speeds must have changed for epochs of another length
QUIET = 64
"""Epochs without an event after which epochs are doubled."""


class Epochs:
    """How long the epochs of a scene are.

    The speed for times of flight is the rms speed, with the largest gain by gravity and faces. masses (N,),
    infinite for fixed particles; gained: the square of the largest speed that the scene itself gives a
    particle.
    """

    def __init__(self, scene: Scene, masses: np.ndarray, gained: float) -> None:
        self._gained = gained if len(masses) else 0.0
        self._diameter = 2 * scene.smallest_radius
        self._across = max(scene.container.lengths)
        self._moving = np.isfinite(masses)
        self._masses = masses[self._moving]

    def speed(self, velocities: np.ndarray) -> float:
        """The speed for times of flight, with velocities (N, d)."""
        square = float((velocities**2).sum(axis=1).mean()) if len(velocities) else 0.0
        return math.sqrt(square + self._gained)

    def _shared(self, velocities: np.ndarray, stored: float) -> float:
        """The rms speed of particles that share their energy equally: the few heavy or spinning ones of a gas
        at rest give it to the others within an epoch. stored: their energy besides that of flight."""
        if not len(self._masses):
            return 0.0
        squares = (velocities[self._moving] ** 2).sum(axis=1)
        energy = 0.5 * float((self._masses * squares).sum()) + stored  # not @: BLAS differs by machine
        return math.sqrt(2.0 * energy / len(self._masses) * float((1.0 / self._masses).mean()))

    def base(self, velocities: np.ndarray, stored: float, present: float = 0.0) -> float:
        """The length of an epoch of particles with velocities (N, d) and a `stored` energy besides; a
        `present` one is kept as by `length`."""
        length = self.length(self.speed(velocities), present)
        return min(length, self.length(self._shared(velocities, stored), length))

    def flights(self, velocities: np.ndarray, length: float) -> float:
        """How many flights through the container particles with velocities (N, d) make in an epoch of this
        length, relative to one another; 0 if rounding hides that they do. Particles that move together do not
        meet, but do not miss one another either."""
        relative = self.speed(velocities - velocities.mean(axis=0))
        return relative * length / self._across if relative > _RESOLVED * self.speed(velocities) else 0.0

    def length(self, speed: float, present: float = 0.0) -> float:
        """The time after which clocks start again from zero: a power of two, so that it scales with the
        units.

        A `present` length is kept until speeds have changed by a factor of 2^10: a cooling gas needs longer
        epochs, since the work of an epoch does not depend on its length.
        """
        length = _power_of_two(self._diameter / speed, _LENGTH) if speed > 0.0 else _AT_REST
        return present if present / _OTHER < length < present * _OTHER else length

    def quiet(self, speed: float, length: float, number: int) -> float:
        """The length of an epoch after a `number` of them without an event: twice the last one, until it is
        a time of flight through the container. The clocks are then as precise as the positions."""
        most = _power_of_two(self._across / speed, 0) if speed > 0.0 else length
        doublings = min(max(number - QUIET, 0), max(0, math.frexp(most)[1] - math.frexp(length)[1]))
        return math.ldexp(length, doublings)


def _power_of_two(time: float, more: int) -> float:
    """The next power of two above a time, times 2^more; at most `_AT_REST`."""
    _, exponent = math.frexp(time)
    return min(math.ldexp(1.0, exponent + more), _AT_REST) if time < _AT_REST else _AT_REST
