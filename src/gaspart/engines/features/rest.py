"""Scenes under gravity that come to rest.

With a contact duration, a pile that has settled goes on with tiny elastic contacts for ever. A scene is taken
for being at rest, and nothing happens in it any more, if for the time sqrt(d/g) of a fall each particle has
stayed within 2^-8 of the smallest diameter d, and then lies on a wall or has contacts that last. The same
holds for a part of it, particles with such contacts and what lies or moves within 2^-8 d of them, until
another particle meets one of them. The kinetic energy of flight is then counted as dissipated; spins, on
which elastic contacts do not act, are kept.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.features.jams import FURTHEST, Jams
from gaspart.engines.features.part import Part
from gaspart.scene.scene import Scene
from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.kernels.model import Model, Particles, Tally


class RestWatch(Part):
    """Looks at regular times, which do not depend on where a run is split, whether all particles rest: their
    places (N, d) at the last look, the time of the next one on the clocks of the epoch, and whether they do.
    """

    def __init__(self, scene: Scene, state: State) -> None:
        diameter, gravity = 2.0 * scene.smallest_radius, scene.gravity or ()
        self._window = math.sqrt(diameter / math.hypot(*gravity))
        self._most = FURTHEST * diameter
        self._axis = int(np.argmax(np.abs(gravity)))
        self._jams = Jams(scene, self._axis, self._most, self._window)
        self._before = state.positions.copy()
        self._next = np.array([self._window])
        self._rests = np.zeros(1, dtype=bool)
        arrays = {"before": self._before, "next": self._next, "rests": self._rests}
        arrays = {f"scheduled_{key}": array for key, array in arrays.items()}
        super().__init__(arrays, times=(self._next,), scheduled=self._next)

    @property
    def at_rest(self) -> bool:
        """Whether all particles rest."""
        return bool(self._rests[0])

    def set_clock(self, clock: float) -> None:
        """Look for the first time after the time of a fall from now on."""
        self._next[0] = clock + self._window

    def apply_event(self, particles: Particles, model: Model, tally: Tally, start: float) -> bool:
        """Look which particles rest, and stop them. Returns whether events must be predicted anew: not if all
        rest."""
        from gaspart.kernels.event.scene_at_rest import MOVES, RESTS, find_resting, stop_all

        flights, places, time = particles.flights, self._before, self.next
        self._next += self._window
        marks = np.empty((3, len(flights)), dtype=bool)
        find_resting(flights, places, time, self._most, model, marks)
        if marks[RESTS].all():
            stop_all(flights, time, model, tally)
            self._rests[0] = True
            return False
        found = self._hold(particles, marks, model, tally, time)
        return self._jams.hold(particles, places, ~marks[MOVES], model, tally, time) or found

    def _hold(self, particles: Particles, marks: np.ndarray, model: Model, tally: Tally, time: float) -> bool:
        """Hold islands. Returns whether there are any new ones."""
        from gaspart.kernels.event.islands import hold, join
        from gaspart.kernels.event.scene_at_rest import RESTS, TOUCHES
        from gaspart.kernels.model import NONE

        flights, places, law = particles.flights, self._before, model.law
        assert law is not None and law.duration is not None  # as `rest_watch` requires
        awake = (law.duration.island == NONE) & (law.inverse_mass > 0.0)
        if not (marks[RESTS] & marks[TOUCHES] & awake).any():
            return False
        near = np.flatnonzero(marks.any(axis=0) & awake)  # not what slides slowly and touches nothing
        order = near[np.argsort(places[near, self._axis], kind="stable")]
        parent = np.empty(len(flights), dtype=np.int64)
        join(flights, order, places, self._axis, self._most, model.space, parent)
        return hold(flights, order, time, marks, parent, model, tally)


def rest_watch(scene: Scene, state: State) -> RestWatch | None:
    """The watch of a scene in which all particles may come to rest: contacts that last, gravity that
    drives no flow, and no face or wall that gives energy."""
    falls = scene.gravity is not None and not scene.driven_axes
    still = not (scene.faces or scene.face_temperatures)
    return RestWatch(scene, state) if scene.contact_duration > 0.0 and falls and still else None
