"""Jams of a scene under gravity: particles that are held until a contact moves them (`kernels.event.jams`).

All follows from what is taken for rest: a movement of less than 2^-8 of the smallest diameter d. Gravity g,
tilted by an angle a of tangent 2^-2, moves no particle of a jam as far in the time sqrt(d/g) of a fall, nor
does a contact that gives it less than a speed v: up a slope of this angle it comes v^2/(2 g sin a) far. A jam
is what has one particle at least that is pressed: its contacts follow one another faster, in the mean of a
fall, than those of two particles that gravity alone presses together.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gaspart.kernels.model import no_support
from gaspart.scene.scene import Scene

if TYPE_CHECKING:
    from gaspart.kernels.model import Model, Particles, Tally

FURTHEST = 2.0**-8  # of the smallest diameter: what moves less rests
_TILT = 2.0**-2
_PLANES = 24  # that a particle touches, of which more are not regarded


def slowest_that_moves(scene: Scene) -> float:
    """The speed that frees a particle from a jam; infinite without gravity."""
    gravity = math.hypot(*(scene.gravity or ()))
    if gravity == 0.0:
        return math.inf
    return math.sqrt(4.0 * gravity * math.sin(math.atan(_TILT)) * FURTHEST * scene.smallest_radius)


def _tilted(gravity: tuple[float, ...]) -> np.ndarray:
    """(2, 3) or (4, 3) accelerations, tilted to all sides; whatever supports all of them supports gravity."""
    whole = np.zeros(3)
    whole[: len(gravity)] = gravity
    across = [np.array([-whole[1], whole[0], 0.0])]
    if len(gravity) == 3:
        one = np.cross(whole, np.eye(3)[np.argmin(np.abs(whole))])
        across = [one, np.cross(whole, one)]
    sides = [_TILT * math.hypot(*whole) / math.hypot(*vector) * vector for vector in across]
    return np.array([whole + sign * side for side in sides for sign in (-1.0, 1.0)])


class Jams:
    """Looks for jams in a scene after every `window` of time. axis: of its gravity, not periodic; reach: the
    largest gap of particles that touch."""

    def __init__(self, scene: Scene, axis: int, reach: float, window: float) -> None:
        from gaspart.kernels.event.jams import Limits
        from gaspart.kernels.physics.contact_duration import SHORTEST

        gravity = scene.gravity or ()
        self._axis, self._most = axis, window / (SHORTEST * scene.contact_duration)
        support = no_support(1, 0.0)._replace(normal=np.zeros((1, _PLANES, 3)))
        least = 2.0 * FURTHEST * math.hypot(*gravity)
        self._limits = Limits(_tilted(gravity), least, reach, support)
        self._plain = self._limits._replace(pulls=self._limits.pulls[:2].mean(axis=0, keepdims=True))

    def hold(
        self,
        particles: Particles,
        places: np.ndarray,
        stays: np.ndarray,
        model: Model,
        tally: Tally,
        time: float,
    ) -> bool:
        """Hold those of the particles at these places (N, d) that belong to a jam at this time. stays (N,):
        which have not left their places. Returns whether events must be predicted anew."""
        from gaspart.kernels.event.islands import join
        from gaspart.kernels.event.jams import HELD, PRESSED, STAYS, Line, free_unstable, jam, keep_stable

        law, flights = model.law, particles.flights
        assert law is not None and law.duration is not None  # as `rest.rest_watch` requires
        duration, moves = law.duration, law.duration.inverse_mass > 0.0
        marks = np.empty((3, len(flights)), dtype=bool)
        marks[HELD], marks[STAYS] = stays & moves, stays | ~moves
        marks[PRESSED] = duration.contacts > self._most
        duration.contacts[:] = 0
        if not (marks[HELD] & marks[PRESSED]).any() and duration.island.max() < len(flights):
            return False
        order = np.flatnonzero(marks[STAYS])
        order = order[np.argsort(places[order, self._axis], kind="stable")]
        line = Line(order, places, self._axis)
        keep_stable(flights, line, self._limits, model, marks)
        kept = marks[:2] | (stays & (duration.island >= len(flights)))
        if (kept != marks[:2]).any():  # what a jam has held before remains unless gravity itself moves it
            marks[:2] = kept
            keep_stable(flights, line, self._plain, model, marks)
        freed = free_unstable(flights, time, marks, model)
        order = order[marks[HELD][order]]
        parent = np.empty(len(flights), dtype=np.int64)
        join(flights, order, places, self._axis, self._limits.reach, model.space, parent)
        return jam(flights, order, time, marks, parent, model, tally) or freed
