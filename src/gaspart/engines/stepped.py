"""The skeleton of engines that make steps: particles by slots, tallies by threads, whole numbers of steps."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import DTypeLike

from gaspart.engines.dynamics import Dynamics
from gaspart.engines.event_log import EventLog
from gaspart.engines.features.part import sums_of, write_parts
from gaspart.errors import SceneError
from gaspart.kernels.physics.running_sum import net
from gaspart.scene.scene import Scene
from gaspart.state.state import State
from gaspart.state.tally import Tally

_MOST_STEPS = 2.0**53  # above, float64 does not distinguish their numbers
_PLACED = ("slots", "positions", "velocities", "images")


class SteppedDynamics(Dynamics):
    """A scene under way by steps. A *slot* is a particle's present place in memory.

    time_step: the length of a step; reference: a state of the same particles, whose time is that of the
    start; unit_mass: that of the sums of energies. An engine has `_parts` too, and puts the particles into
    their slots before the first step.
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
        """Put the particles into their slots: (N,) which particle is in each; the others (N, d)."""

    @property
    @abstractmethod
    def _slots(self) -> np.ndarray:
        """(N,) which particle is in each slot."""

    @property
    @abstractmethod
    def _positions(self) -> np.ndarray:
        """(d, N) by slot."""

    @property
    @abstractmethod
    def _velocities(self) -> np.ndarray:
        """(d, N) by slot."""

    @property
    @abstractmethod
    def _images(self) -> np.ndarray:
        """(d, N) by particle."""

    @abstractmethod
    def _advance_to(self, step: int) -> None:
        """Make all steps up to this one, at least one, and count them. Raises SimulationError."""

    @abstractmethod
    def _sums(self) -> dict[str, np.ndarray]:
        """The arrays (threads, ...) that count, by their names in a checkpoint."""

    @abstractmethod
    def _counts(self) -> dict[str, Any]:
        """The values of these sums, by the fields of `Tally`; without time, steps and the energy of faces."""

    @property
    @abstractmethod
    def _loss(self) -> np.ndarray:
        """(K, 2) parts of the energy that contacts have taken since the tally began, in units of the unit
        mass."""

    @property
    @abstractmethod
    def _heat(self) -> np.ndarray:
        """(2d, 2) what each face was given by particles that left it at its temperature, likewise."""

    @property
    def _given(self) -> np.ndarray:
        """(1, 2) the energy that kicks have given, likewise."""
        return np.zeros((1, 2))

    @property
    def _progress(self) -> float:
        """The number of steps made, with parts of one."""
        return self._steps

    def _by_particle(self, values: np.ndarray, dtype: DTypeLike | None = None) -> np.ndarray:
        """(N, d) of the particles in their own order, from (d, N) by slot."""
        found = np.empty(values.shape[::-1], dtype or values.dtype)
        found[self._slots] = values.T
        return found

    @property
    def time(self) -> float:
        """The time reached, at the end of a step."""
        return self._start + self._progress * self.time_step

    def advance(
        self,
        until: float,
        max_events: int | None = None,
        log: EventLog | None = None,
        max_work: int | None = None,
    ) -> None:
        """Step to the last whole step not after `until` (to within 1e-9 of a step).

        Raises SceneError for what only the event-driven engine can do, count or record events, and for a time
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
        """The energy that contacts and thermal walls have taken since time 0, less what kicks have given."""
        return float(self._lost[0]) + net(self._loss, self._heat, -self._given) * self._unit_mass

    @property
    def exchanged(self) -> float:
        """The sum of what contacts and each face have taken or given since time 0, each counted positive."""
        gross = net(self._loss) + float(np.abs(self._heat.sum(axis=1)).sum())
        return float(self._lost[1]) + gross * self._unit_mass + abs(net(self._given)) * self._unit_mass

    @property
    def state(self) -> State:
        """All particles at the present time, in float64 whatever the precision."""
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
        """The arrays (threads, ...) that count, those of parts too."""
        return {**self._sums(), **sums_of(self._parts)}

    def _joined(self, sums: np.ndarray) -> np.ndarray:
        """The sum over threads, whatever their number, of an array (threads, ...) that counts."""
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
        """Put the particles where they were; what this counts is overwritten."""
        self._place(*(checkpoint[key] for key in _PLACED))
