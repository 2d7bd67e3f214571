"""Jams of a scene under gravity: which particles are held until a contact moves them, see `kernels.event.jams`.

All follows from what is taken for rest: a movement of less than 2^-8 of the smallest diameter d. Particles
that neither gravity moves as far in the time of a fall sqrt(d/g), if it is tilted by an angle of tangent
2^-2, nor then any contact that gives less than a speed v, which lifts by v^2/2g on so steep a slope.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gaspart.kernels.model import NONE, no_support
from gaspart.scene.scene import Scene

if TYPE_CHECKING:
    from gaspart.kernels.model import Model, Particles, Tally

FURTHEST = 2.0**-8  # of the smallest diameter: what moves less rests
_TILT = 2.0**-2
_MANY = 1536  # contacts of a particle in the duration of one
_PLANES = 24  # that a particle may touch; if it touches more, the rest supports it less


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
    if len(gravity) == 2:
        across = [np.array([-whole[1], whole[0], 0.0])]
    else:
        one = np.cross(whole, np.eye(3)[np.argmin(np.abs(whole))])
        other = np.cross(whole, one)
        across = [vector * math.hypot(*whole) / math.hypot(*vector) for vector in (one, other)]
    return np.array([whole + sign * _TILT * vector for vector in across for sign in (-1.0, 1.0)])


class Jams:
    """Looks for jams in a scene. axis: of its gravity, not periodic; reach: the largest gap of particles that
    touch."""

    def __init__(self, scene: Scene, axis: int, reach: float) -> None:
        gravity = scene.gravity or ()
        self._axis, self._pulls = axis, _tilted(gravity)
        self._most = reach, 2.0 * FURTHEST * math.hypot(*gravity)
        single = no_support(1, 0.0)
        self._support = single._replace(normal=np.zeros((1, _PLANES, 3)))

    def hold(
        self, particles: Particles, places: np.ndarray, rests: np.ndarray, model: Model, tally: Tally,
        time: float, window: float,
    ) -> bool:  # fmt: skip
        """Hold those of the particles at these places (N, d) that rest (N,) and have been pressed for a
        `window` of time until now, with all of those that rest beside them and are supported. Returns whether
        there are any new ones."""
        from gaspart.kernels.event.islands import join
        from gaspart.kernels.event.jams import HOLDS, PRESSED, STAYS, free_unstable, jam, keep_stable

        law, flights = model.law, particles.flights
        assert law is not None and law.duration is not None  # as `rest.rest_watch` requires
        duration, moves = law.duration, law.duration.inverse_mass > 0.0
        jammed = duration.island >= len(flights)
        marks = np.empty((3, len(flights)), dtype=bool)
        marks[HOLDS], marks[STAYS] = rests & moves, rests | ~moves
        marks[PRESSED] = duration.contacts * duration.length > _MANY * window
        duration.contacts[:] = 0
        if not (marks[HOLDS] & (marks[PRESSED] | jammed)).any():
            return False
        order = np.flatnonzero(marks[STAYS])
        order = order[np.argsort(places[order, self._axis], kind="stable")]
        scene = flights, order, places, self._axis
        keep_stable(*scene, self._most, self._pulls, model, marks, self._support)
        order = order[marks[HOLDS][order]]
        parent = np.empty(len(flights), dtype=np.int64)
        join(flights, order, places, self._axis, self._most[0], model.space, parent)
        freed = free_unstable(flights, time, marks, model)
        return jam(flights, order, time, marks, parent, model, tally) or freed
