"""Interface of a scene in progress, and what all engines share: checkpoints and optional tallies."""

from __future__ import annotations

import hashlib
import json
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import DTypeLike

from gaspart import __version__
from gaspart.engines.engine import Engine, engine_to_dict
from gaspart.engines.features.part import Part, TallyPart, arrays_of, sums_of, write_parts
from gaspart.errors import SceneError
from gaspart.kernels.physics.sums import net
from gaspart.scene.scene import Scene
from gaspart.state.state import State
from gaspart.state.tally import Tally

# Record of the events of a run.


_ROOM = 4096  # capacity of the record, in events


class EventLog:
    """Record of events: particles, and positions, velocities and optionally spins just after them."""

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
        """Copy the first events of the kernel's record; in 2D, spins normal to the plane."""
        found = {key: getattr(self.room, key)[:count] for key in self._keys}
        if "spins" in found and self._dimension == 2:
            found["spins"] = found["spins"][..., 2]
        return tuple(array.copy() for array in found.values())

    def take(self, start: float) -> None:
        """Empty the kernel's record, whose times count from `start`."""
        n = int(self.room.filled[0])
        self.room.filled[0] = 0
        if n:
            time, *others = self._copy(n)
            self._parts.append((start + time, *others))

    @property
    def events(self) -> dict[str, np.ndarray]:
        """Recorded events, as arrays by name.

        time : (M,)
        particles : (M, 2); the second entry is -1 - face for a hit at a wall
        positions, velocities : (M, 2, d); the second entry is NaN for a hit at a wall
        spins : (M, 2) or (M, 2, 3)
        """
        parts = zip(*(self._parts or [self._copy(0)]), strict=True)
        return dict(zip(self._keys, map(np.concatenate, parts), strict=True))


# Identity of a checkpoint: the simulation to which it belongs, which decides whether it may be restored.


def checkpoint_identity(
    scene: Scene, engine: Engine, seed: int | tuple[int, ...], initial: State | None = None
) -> dict[str, np.ndarray]:
    """Return texts of all that the results of a simulation depend on, by checkpoint keys.

    initial : state at time 0, if it does not follow from the scene and the seed
    """
    settings = {key: x for key, x in engine_to_dict(engine).items() if key not in engine.neutral_settings}
    texts = {
        "version": __version__,
        "scene": hashlib.sha256(_text(scene.to_dict()).encode()).hexdigest(),
        "engine": _text(settings),
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
    return json.dumps(value, sort_keys=True, default=int)  # a seed may be an integer of numpy


def check_identity(checkpoint: Any, wanted: Mapping[str, np.ndarray]) -> None:
    """Raise SceneError, which names the difference, unless a checkpoint has the `wanted` identity."""
    if not isinstance(checkpoint, Mapping) or not all(key in checkpoint for key in wanted):
        raise SceneError("checkpoint", checkpoint, "must be what Simulation.checkpoint has returned")
    for key, text in wanted.items():
        if str(checkpoint[key]) != str(text):
            what = key.removeprefix("of_")
            this = "" if what == "scene" else f", which has {text}"
            rule = f"is of another {what} than this simulation{this}"
            raise SceneError("checkpoint", str(checkpoint[key]), rule)


def check_parts(parts: Mapping[str, np.ndarray], wanted: Mapping[str, np.ndarray]) -> None:
    """Raise SceneError unless a checkpoint has all `wanted` arrays.

    Each array must have the shape and the kind of number of the wanted one.
    """
    for key, array in wanted.items():
        found = parts.get(key)
        alike = isinstance(found, np.ndarray) and found.shape == np.shape(array)
        if not alike or found.dtype.kind != np.asarray(array).dtype.kind:  # type: ignore[union-attr]
            raise SceneError("checkpoint", key, "is missing or of another form: the checkpoint is damaged")


class Dynamics(ABC):
    """Scene in progress under an engine.

    numbers : names of the plain numbers in a checkpoint; the attributes have an underscore before the name
    """

    numbers: ClassVar[tuple[str, ...]]
    _parts: list[Part]
    _clock = 0.0

    @property
    @abstractmethod
    def time(self) -> float:
        """Time reached."""

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
        """Energy taken by contacts and thermal walls since time 0, minus the energy of kicks."""

    @property
    @abstractmethod
    def exchanged(self) -> float:
        """Sum of the absolute energies exchanged by contacts and by each face since time 0."""

    @abstractmethod
    def advance(
        self,
        until: float,
        max_events: int | None = None,
        log: EventLog | None = None,
        max_work: int | None = None,
    ) -> None:
        """Advance to the time `until`, or by a number of events or of work.

        Events are recorded in `log`. Raises SceneError for a limit that the engine does not have, and
        SimulationError, with the state kept, for a run that cannot continue.
        """

    @abstractmethod
    def reset_tally(self) -> None:
        """Begin to count from zero."""

    def _tally_part(self, name: str) -> TallyPart | None:
        """Return the part of an optional tally, or None if it was not requested."""
        parts = (part for part in self._parts if isinstance(part, TallyPart))
        return next((part for part in parts if part.name == name), None)

    def sums_of(self, tally: str) -> np.ndarray:
        """Return the sums of an optional tally in one array.

        Raises KeyError if the tally was not requested.
        """
        part = self._tally_part(tally)
        if part is None:
            raise KeyError(tally)
        return part.read(self._clock)

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return copies of all data needed to continue to the same bits."""
        return {key: np.array(value) for key, value in self._kept().items()}

    def restore(self, checkpoint: dict[str, np.ndarray]) -> None:
        """Continue from a checkpoint of the same scene and engine, to the same bits.

        Settings that change no bit may differ. Raises SceneError, with nothing changed, for a checkpoint that
        lacks an array.
        """
        needed = self._needed(checkpoint)
        check_parts(checkpoint, needed)
        for key, array in self._arrays().items():
            if key in needed:
                array[...] = checkpoint[key]
        for key in self.numbers:
            setattr(self, f"_{key}", checkpoint[key].item())
        self._go_on(checkpoint)

    def _arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays, by name, that a run changes and that a checkpoint stores unchanged."""
        return arrays_of(self._parts)

    def _kept(self) -> dict[str, Any]:
        """Return all data of a checkpoint."""
        return {**{key: getattr(self, f"_{key}") for key in self.numbers}, **self._arrays()}

    def _needed(self, checkpoint: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Return arrays of the shapes that `restore` needs from this checkpoint.

        Raises SceneError for a damaged checkpoint.
        """
        return self.checkpoint()

    @abstractmethod
    def _go_on(self, checkpoint: dict[str, np.ndarray]) -> None:
        """Restore everything that follows from the arrays and numbers of a checkpoint.

        The arrays and numbers are already in place.
        """


# Base of engines that make steps: particles by slots, tallies by threads, whole numbers of steps.


_MOST_STEPS = 2.0**53  # above, float64 does not distinguish their numbers
_PLACED = ("slots", "positions", "velocities", "images")


class SteppedDynamics(Dynamics):
    """Scene in progress by steps.

    A *slot* is a particle's present position in memory. An engine also sets `_parts`, and places the
    particles into their slots before the first step.

    time_step : length of a step
    reference : state of the same particles at the start time
    unit_mass : unit of mass of the sums of energies
    """

    numbers: ClassVar[tuple[str, ...]] = ("steps", "since")

    def __init__(
        self, scene: Scene, reference: State, time_step: float, threads: int, unit_mass: float = 1.0
    ) -> None:
        self.time_step = time_step
        self._scene, self._reference, self._unit_mass = scene, reference, unit_mass
        self._threads = threads if threads > 1 else None
        self._lost = np.zeros(2)  # net and gross, before the tally began
        self._start, self._steps, self._since = reference.time, 0, 0

    @abstractmethod
    def _place(
        self, slots: np.ndarray, positions: np.ndarray, velocities: np.ndarray, images: np.ndarray
    ) -> None:
        """Place the particles into their slots.

        slots : (N,), number of the particle in each slot
        positions, velocities, images : (N, d)
        """

    @property
    @abstractmethod
    def _slots(self) -> np.ndarray:
        """Number of the particle in each slot, shape (N,)."""

    @property
    @abstractmethod
    def _positions(self) -> np.ndarray:
        """Positions by slot, shape (d, N)."""

    @property
    @abstractmethod
    def _velocities(self) -> np.ndarray:
        """Velocities by slot, shape (d, N)."""

    @property
    @abstractmethod
    def _images(self) -> np.ndarray:
        """Periodic images by particle, shape (d, N)."""

    @abstractmethod
    def _advance_to(self, step: int) -> None:
        """Make all steps up to this one, at least one, and count them. Raises SimulationError."""

    @abstractmethod
    def _sums(self) -> dict[str, np.ndarray]:
        """Return the arrays (threads, ...) with counts by their names in a checkpoint."""

    @abstractmethod
    def _counts(self) -> dict[str, Any]:
        """Return the values of these sums by the fields of `Tally`.

        Time, steps and the energy of faces are left out.
        """

    @property
    @abstractmethod
    def _loss(self) -> np.ndarray:
        """Energy taken by contacts since the tally began, in parts (K, 2).

        The unit contains the unit mass.
        """

    @property
    @abstractmethod
    def _heat(self) -> np.ndarray:
        """Energy given to each face by particles that left it at its temperature, shape (2d, 2).

        The unit is the one of `_loss`.
        """

    @property
    def _given(self) -> np.ndarray:
        """Energy given by kicks, shape (1, 2), in the unit of `_loss`."""
        return np.zeros((1, 2))

    @property
    def _progress(self) -> float:
        """Number of steps made, including parts of a step."""
        return self._steps

    def _by_particle(self, values: np.ndarray, dtype: DTypeLike | None = None) -> np.ndarray:
        """Convert values (d, N) by slot to values (N, d) in the order of the particles."""
        found = np.empty(values.shape[::-1], dtype or values.dtype)
        found[self._slots] = values.T
        return found

    @property
    def time(self) -> float:
        """Time reached, at the end of a step."""
        return self._start + self._progress * self.time_step

    def advance(
        self,
        until: float,
        max_events: int | None = None,
        log: EventLog | None = None,
        max_work: int | None = None,
    ) -> None:
        """Step to the last whole step not after `until` (to within 1e-9 of a step).

        Raises SceneError for limits or records of events, which need the event-driven engine, and for a time
        that is not within 2^53 steps; SimulationError if the particles are too fast for a step.
        """
        wanted = {
            "max_events": max_events,
            "max_work": max_work,
            "record_events": None if log is None else True,
        }
        for key, value in wanted.items():
            if value is not None:
                raise SceneError(key, value, 'needs the "event" engine; this one makes whole steps only')
        steps = (until - self._start) / self.time_step
        if not steps < _MOST_STEPS:
            raise SceneError("until", until, f"must be within {_MOST_STEPS:g} steps of {self.time_step:g}")
        target = math.floor(steps * (1.0 + 4e-16) + 1e-9)
        if target <= self._steps:
            return
        if self._threads is not None:
            from numba import config, set_num_threads

            set_num_threads(min(self._threads, config.NUMBA_NUM_THREADS))
        self._advance_to(target)

    def reset_tally(self) -> None:
        """Begin to count anew."""
        self._lost[:] = self.dissipated, self.exchanged
        for sums in self._sums().values():
            sums[...] = 0
        for part in self._parts:
            part.reset(self._clock)
        self._since = self._steps

    @property
    def dissipated(self) -> float:
        """Energy taken by contacts and thermal walls since time 0, minus the energy of kicks."""
        return float(self._lost[0]) + net(self._loss, self._heat, -self._given) * self._unit_mass

    @property
    def exchanged(self) -> float:
        """Sum of the absolute energies exchanged by contacts and by each face since time 0."""
        gross = net(self._loss) + float(np.abs(self._heat.sum(axis=1)).sum())
        return float(self._lost[1]) + gross * self._unit_mass + abs(net(self._given)) * self._unit_mass

    @property
    def state(self) -> State:
        """State of all particles at the present time, in float64 for any precision."""
        state = replace(
            self._reference,
            time=self.time,
            positions=self._by_particle(self._positions, float),
            velocities=self._by_particle(self._velocities, float),
            images=self._images.T.astype(self._reference.images.dtype),
        )
        write_parts(self._parts, state)
        return state

    @property
    def tally(self) -> Tally:
        """Counters and sums since the last `reset_tally`."""
        counts: dict[str, Any] = {"steps": self._steps - self._since} | self._counts()
        for part in self._parts:
            counts |= part.counts(self._clock)
        return Tally(
            time=(self._steps - self._since) * self.time_step,
            wall_energy=self._heat.sum(axis=1) * self._unit_mass,
            dissipated_energy=net(self._loss) * self._unit_mass,
            thermostat_energy=net(self._given) * self._unit_mass,
            **counts,
        )

    def _arrays(self) -> dict[str, np.ndarray]:
        return {**super()._arrays(), "lost": self._lost}

    def _all_sums(self) -> dict[str, np.ndarray]:
        """Return the arrays (threads, ...) with counts, including the arrays of parts."""
        return {**self._sums(), **sums_of(self._parts)}

    def _joined(self, sums: np.ndarray) -> np.ndarray:
        """Return the sum over threads of an array (threads, ...) with counts."""
        return np.asarray(sums.sum(axis=0))

    def _kept(self) -> dict[str, Any]:
        return {
            **super()._kept(),
            **{key: self._joined(sums) for key, sums in self._all_sums().items()},
            "slots": self._slots,
            "positions": self._by_particle(self._positions),
            "velocities": self._by_particle(self._velocities),
            "images": self._images.T,
        }

    def _go_on(self, checkpoint: dict[str, np.ndarray]) -> None:
        self._place_again(checkpoint)
        for key, sums in self._all_sums().items():
            sums[...] = 0
            sums[0] = checkpoint[key]

    def _place_again(self, checkpoint: dict[str, np.ndarray]) -> None:
        """Place the particles in their slots of a checkpoint; counts of this are overwritten."""
        self._place(*(checkpoint[key] for key in _PLACED))
