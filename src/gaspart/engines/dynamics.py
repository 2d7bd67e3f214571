"""Interface of a running scene, and code for all engines: events, checkpoints, optional tallies."""

from __future__ import annotations

import hashlib
import json
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from gaspart import __version__
from gaspart.engines.features.part import Part, TallyPart, arrays_of
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.state.state import State
from gaspart.state.tally import Tally

# Record of the events of a run.


_ROOM = 4096  # capacity of the record in events


class EventLog:
    """Record of events: their times, particles, and positions, velocities and spins after the event."""

    def __init__(self, dimension: int, spins: bool = False) -> None:
        from gaspart.kernels.event.pair_contact import Record

        self._keys = ("time", "particles", "positions", "velocities", *(("spins",) if spins else ()))
        self._dimension = dimension
        self._parts: list[tuple[np.ndarray, ...]] = []
        self.room = Record(
            filled=np.zeros(1, dtype=np.int64),
            time=np.empty(_ROOM),
            particles=np.empty((_ROOM, 2), dtype=np.int64),
            positions=np.empty((_ROOM, 2, dimension)),
            velocities=np.empty((_ROOM, 2, dimension)),
            spins=np.empty((_ROOM, 2, 3)),
        )

    def _copy(self, count: int) -> tuple[np.ndarray, ...]:
        """Copy the first `count` events of the kernel's record; in 2D, only normal components of spins."""
        record = {key: getattr(self.room, key)[:count] for key in self._keys}
        if "spins" in record and self._dimension == 2:
            record["spins"] = record["spins"][..., 2]
        return tuple(array.copy() for array in record.values())

    def take(self, start: float) -> None:
        """Move the events out of the kernel's record, whose times are relative to `start`."""
        n = int(self.room.filled[0])
        self.room.filled[0] = 0
        if n:
            time, *others = self._copy(n)
            self._parts.append((start + time, *others))

    @property
    def events(self) -> dict[str, np.ndarray]:
        """Recorded events as arrays, by name, for M events. `time`: (M,). `particles`: (M, 2); for a wall hit
        the second entry is -1 - face. `positions` and `velocities`: (M, 2, d); for a wall hit the second
        entry is NaN. `spins`: (M, 2) or (M, 2, 3).
        """
        parts = zip(*(self._parts or [self._copy(0)]), strict=True)
        return dict(zip(self._keys, map(np.concatenate, parts), strict=True))


# Identity of a checkpoint: the simulation to which it belongs.
#
# A checkpoint may be restored only in this simulation.


def checkpoint_identity(
    scene: Scene, settings: Mapping[str, Any], seed: int | tuple[int, ...], initial: State | None = None
) -> dict[str, np.ndarray]:
    """Return texts that identify all input of a simulation, by their keys in a checkpoint. `settings`: name
    of the engine, and its settings that change the results. `initial`: initial state; None if it follows from
    the scene and the seed.
    """
    texts = {
        "version": __version__,
        "scene": hashlib.sha256(_text(scene.to_dict()).encode()).hexdigest(),
        "engine": _text(dict(settings)),
        "seed": _text(seed),
        "initial state": _digest(initial),
    }
    return {f"of_{key}": np.array(text) for key, text in texts.items()}


def _digest(state: State | None) -> str:
    if state is None:
        return "of the seed"
    moving = state.piston, state.displaced, state.vibrations
    parts = state.positions, state.velocities, state.spins, *moving
    there = (np.ascontiguousarray(part).tobytes() for part in parts if part is not None)
    return hashlib.sha256(b"".join(there)).hexdigest()


def _text(value: object) -> str:
    return json.dumps(value, sort_keys=True, default=int)  # the seed may be a numpy integer


def check_identity(checkpoint: Any, identity: Mapping[str, np.ndarray]) -> None:
    """Raise SceneError, and name the difference, unless a checkpoint has this `identity`."""
    if not isinstance(checkpoint, Mapping) or not all(key in checkpoint for key in identity):
        raise SceneError("checkpoint", checkpoint, "must be what Simulation.checkpoint has returned")
    for key, text in identity.items():
        if str(checkpoint[key]) != str(text):
            subject = key.removeprefix("of_")
            this = "" if subject == "scene" else f", which has {text}"
            rule = f"is of another {subject} than this simulation{this}"
            raise SceneError("checkpoint", str(checkpoint[key]), rule)


def check_parts(parts: Mapping[str, np.ndarray], expected: Mapping[str, np.ndarray]) -> None:
    """Raise SceneError unless a checkpoint has all `expected` arrays with their shapes and kinds of types."""
    for key, array in expected.items():
        value = parts.get(key)
        alike = isinstance(value, np.ndarray) and value.shape == np.shape(array)
        if not alike or value.dtype.kind != np.asarray(array).dtype.kind:  # type: ignore[union-attr]
            raise SceneError("checkpoint", key, "is missing or of another form: the checkpoint is damaged")


class Dynamics(ABC):
    """Running scene under an engine.

    numbers : names in a checkpoint of scalar attributes; the names of the attributes have an underscore in
        front
    """

    numbers: ClassVar[tuple[str, ...]]
    _parts: list[Part]
    _clock = 0.0

    @property
    @abstractmethod
    def time(self) -> float:
        """Present simulation time."""

    @property
    @abstractmethod
    def state(self) -> State:
        """Copy of the present state of all particles."""

    @property
    @abstractmethod
    def tally(self) -> Tally:
        """Copy of the counters and sums since the last `reset_tally`."""

    @property
    @abstractmethod
    def dissipated(self) -> float:
        """Energy removed by contacts and thermal walls since time 0, minus the energy added by kicks."""

    @property
    @abstractmethod
    def exchanged(self) -> float:
        """Sum of the absolute energies that contacts and each face have exchanged since time 0."""

    @abstractmethod
    def advance(
        self,
        until: float,
        max_events: int | None = None,
        log: EventLog | None = None,
        max_work: int | None = None,
    ) -> None:
        """Advance to the time `until`, but by at most `max_events` events or `max_work` work. Events are
        recorded in `log`. Raises SceneError for a limit that the engine does not support. Raises
        SimulationError if the run cannot continue; the state then remains usable.
        """

    @abstractmethod
    def reset_tally(self) -> None:
        """Reset all counters to zero."""

    def _tally_part(self, name: str) -> TallyPart | None:
        """Return the part of an optional tally, or None if it was not requested."""
        parts = (part for part in self._parts if isinstance(part, TallyPart))
        return next((part for part in parts if part.name == name), None)

    def sums_of(self, tally: str) -> np.ndarray:
        """Return the sums of an optional tally in one array; KeyError if it was not requested."""
        part = self._tally_part(tally)
        if part is None:
            raise KeyError(tally)
        return part.read(self._clock)

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return copies of all data needed to continue bitwise identically."""
        return {key: np.array(value) for key, value in self._checkpoint_data().items()}

    def restore(self, checkpoint: dict[str, np.ndarray]) -> None:
        """Continue bitwise identically from a checkpoint of the same scene and engine. Settings that do not
        change results may differ. Raises SceneError if an array is missing in the checkpoint; in this case
        nothing changes.
        """
        required = self._required_arrays(checkpoint)
        check_parts(checkpoint, required)
        for key, array in self._arrays().items():
            if key in required:
                array[...] = checkpoint[key]
        for key in self.numbers:
            setattr(self, f"_{key}", checkpoint[key].item())
        self._go_on(checkpoint)

    def _arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays, by name, that change during a run and are stored without conversion."""
        return arrays_of(self._parts)

    def _checkpoint_data(self) -> dict[str, Any]:
        """Return all data of a checkpoint."""
        return {**{key: getattr(self, f"_{key}") for key in self.numbers}, **self._arrays()}

    def _required_arrays(self, checkpoint: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Return arrays with the shapes that `restore` requires; SceneError for a damaged checkpoint."""
        return self.checkpoint()

    @abstractmethod
    def _go_on(self, checkpoint: dict[str, np.ndarray]) -> None:
        """Compute all data that follow from restored arrays and numbers of a checkpoint."""
