"""Open faces: which particles are inside, and the reservoirs from which they come."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gaspart.engines.features.part import Part
from gaspart.errors import SimulationError
from gaspart.kernels import model as kernels
from gaspart.kernels.event.entry import schedule_first
from gaspart.kernels.obstacles.open_face import NUMBERS
from gaspart.scene.faces import Open
from gaspart.scene.open_faces import attempt_rate
from gaspart.scene.scene import Scene
from gaspart.state.random import key_of
from gaspart.state.state import State

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
    blocks = -(-len(present) // NUMBERS)
    return kernels.Open(present, np.zeros(blocks, np.int64), np.zeros(2 * scene.dimension, np.int64))


def reservoirs_of(
    scene: Scene, seed: int | tuple[int, ...], inside: kernels.Open
) -> kernels.Reservoirs | None:
    """The gases behind open faces; None if there is a vacuum behind all of them."""
    rates, widths = np.zeros((2, 2 * scene.dimension))
    for number, face in scene.faces_of(Open):
        if face.temperature is not None:
            widths[number] = math.sqrt(face.temperature / scene.species[0].mass)
            rates[number] = attempt_rate(scene, number, face)
    if not rates.any():
        return None
    up_to = np.cumsum(rates) / rates.sum()
    up_to[np.flatnonzero(rates)[-1] :] = 1.0  # whatever rounding makes of it
    next_one = np.zeros(1, dtype=np.int64), np.full(1, np.inf), np.zeros(3)
    return kernels.Reservoirs(
        key_of(seed, _ENTRY_DRAWS), float(rates.sum()), up_to, widths, *next_one, inside
    )


def crowded_error(time: float, most: int) -> SimulationError:
    """The error of a run in which more than `most` particles would be inside."""
    return SimulationError(f"at time {time:g} there is no room for more than {most} particles")


class OpenPart(Part):
    """The open faces of a scene: which particles are inside, how many have entered since the tally began, and
    the number and the time, on the clocks of the epoch, of the next attempt to enter."""

    def __init__(self, scene: Scene, inside: kernels.Open, reservoirs: kernels.Reservoirs | None) -> None:
        self._scene, self._inside, self._reservoirs = scene, inside, reservoirs
        arrays, times = {"present": inside.present, "entries": inside.entries}, ()
        if reservoirs:
            arrays |= {"entry_number": reservoirs.number, "entry_next": reservoirs.time}
            times = (reservoirs.time,)
        super().__init__(arrays, times=times)

    def set_clock(self, clock: float) -> None:
        """Schedule the first attempt to enter."""
        if self._reservoirs:
            schedule_first(self._reservoirs, clock)

    def begin_epoch(self, length: float, start: float, model: kernels.Model) -> kernels.Model:
        """Count the vacant numbers, which a checkpoint does not have."""
        absent = np.flatnonzero(self._inside.present == 0)
        self._inside.vacant[:] = np.bincount(absent // NUMBERS, minlength=len(self._inside.vacant))
        return model

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
