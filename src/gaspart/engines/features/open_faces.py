"""Open faces: which particles are inside, and the reservoirs from which they come."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.engines.features.part import Part
from gaspart.errors import SimulationError
from gaspart.kernels import model as kernels
from gaspart.scene.faces import Open
from gaspart.scene.open_faces import number_density
from gaspart.scene.scene import Scene
from gaspart.state.random import key_of
from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.kernels.event.box_lists import BoxLists
    from gaspart.kernels.event.entry import Reservoirs
    from gaspart.kernels.event.queue import Queue
    from gaspart.kernels.model import Model, Particles, Tally

_ENTRY_DRAWS = 7  # the purpose of their random numbers, after those of interior walls
_ARRAYS = "positions", "velocities", "images", "radii", "masses", "species", "spins", "moments_of_inertia"
"""Those of a `State` that have a row for each particle."""


def with_room(scene: Scene, state: State) -> State:
    """A state with all numbers that particles may have: those that no particle has are at no place (NaN) and
    at rest. The same one without open faces."""
    free = scene.capacity - state.count
    if free == 0:
        return state
    padded: dict[str, Any] = {}
    for key in _ARRAYS:
        values = getattr(state, key)
        padded[key] = np.concatenate([values, np.repeat(values[:1], free, axis=0)])
    padded["positions"][state.count :], padded["velocities"][state.count :] = np.nan, 0.0
    return replace(state, **padded)


def opened(scene: Scene, state: State) -> kernels.Open | None:
    """The kernels' `Open` of a state with all numbers; None without open faces."""
    if not scene.is_open:
        return None
    present = np.isfinite(state.positions[:, 0]).astype(np.uint8)
    return kernels.Open(present, np.zeros(2 * scene.dimension, dtype=np.int64))


def reservoirs(scene: Scene, seed: int | tuple[int, ...]) -> Reservoirs | None:
    """What is outside; None if that is nothing."""
    from gaspart.kernels.event.entry import Reservoirs

    rates, widths = np.zeros((2, 2 * scene.dimension))
    for number, face in scene.faces_of(Open):
        if face.temperature is not None:
            area = scene.container.volume / scene.container.lengths[number // 2]
            widths[number] = math.sqrt(face.temperature / scene.species[0].mass)
            rates[number] = number_density(scene, face) * area * widths[number] / math.sqrt(2.0 * math.pi)
    if not rates.any():
        return None
    up_to = np.cumsum(rates) / rates.sum()
    up_to[np.flatnonzero(rates)[-1] :] = 1.0  # whatever rounding makes of it
    return Reservoirs(key_of(seed, _ENTRY_DRAWS), float(rates.sum()), up_to, widths)


class OpenPart(Part):
    """The open faces of a scene: which particles are inside, how many have entered since the tally began, and
    the number and the time, on the clocks of the epoch, of the next attempt to enter.

    queue, boxes: those of the particles, in which one that enters is put.
    """

    def __init__(
        self,
        scene: Scene,
        seed: int | tuple[int, ...],
        inside: kernels.Open,
        queue: Queue | None,
        boxes: BoxLists,
    ) -> None:
        self._scene, self._inside, self._search = scene, inside, (queue, boxes)
        self._reservoirs = reservoirs(scene, seed)
        self._number, self._next = np.zeros(1, dtype=np.int64), np.full(1, np.inf)
        arrays = {"present": inside.present, "entries": inside.entries}
        arrays |= {"entry_number": self._number, "entry_next": self._next}
        super().__init__(arrays, times=(self._next,), scheduled=self._next)

    def _wait(self, clock: float) -> None:
        """Schedule the next attempt, after the time `clock`."""
        from gaspart.kernels.event.entry import waiting_time

        if self._reservoirs:
            self._next[0] = clock + waiting_time(self._reservoirs, int(self._number[0]))

    def set_clock(self, clock: float) -> None:
        """The first attempt."""
        self._wait(clock)

    def apply_event(self, particles: Particles, model: Model, tally: Tally, start: float) -> bool:
        """Let a particle try to enter. Returns that the events of all others are as they were. Raises
        SimulationError if there is no room for it."""
        from gaspart.kernels.event.entry import NO_ROOM, attempt

        time, number = self.next, int(self._number[0])
        if attempt(particles, (time, number), *self._search, model, tally, self._reservoirs) == NO_ROOM:
            most = len(self._inside.present)
            raise SimulationError(f"at time {start + time:g} there is no room for more than {most} particles")
        self._number += 1
        self._wait(time)
        return False

    def write(self, state: State, clock: float) -> None:
        """Leave only the particles that are inside, with their numbers."""
        state.numbers = np.flatnonzero(self._inside.present)
        for key in _ARRAYS:
            setattr(state, key, getattr(state, key)[state.numbers])

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        self._inside.entries[:] = 0

    def counts(self, clock: float) -> dict[str, Any]:
        """How many particles have entered through each face, by the field of `Tally`."""
        return {"entries": np.pad(self._inside.entries, (0, len(self._scene.walls)))}
