"""Base of engines with time steps: particles in slots, counters for each thread."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import DTypeLike

from gaspart.engines.dynamics import Dynamics, EventLog
from gaspart.engines.features.part import sums_of, write_parts
from gaspart.errors import SceneError
from gaspart.kernels.physics.running_sum import net
from gaspart.scene.scene import Scene
from gaspart.state.state import State
from gaspart.state.tally import Tally

_MOST_STEPS = 2.0**53  # above this number of steps, float64 does not distinguish consecutive integers
_PLACED = ("slots", "positions", "velocities", "images")


class SteppedDynamics(Dynamics):
    """Running scene under an engine with time steps. A *slot* is the place of a particle's data in memory,
    which may change during a run. A subclass also sets `_parts`, and places the particles into their slots
    before the first step.

    time_step : length of a step
    reference : initial state of the particles
    unit_mass : unit of mass in which sums of energies are expressed
    """

    numbers: ClassVar[tuple[str, ...]] = ("steps", "since")

    def __init__(
        self, scene: Scene, reference: State, time_step: float, threads: int, unit_mass: float = 1.0
    ) -> None:
        self.time_step = time_step
        self._scene, self._reference, self._unit_mass = scene, reference, unit_mass
        self._threads = threads if threads > 1 else None
        self._lost = np.zeros(2)  # net and absolute energy before the last reset
        self._start, self._steps, self._since = reference.time, 0, 0

    @abstractmethod
    def _place(
        self, slots: np.ndarray, positions: np.ndarray, velocities: np.ndarray, images: np.ndarray
    ) -> None:
        """Place particles, by number (N,) in each slot, with positions, velocities and images (N, d)."""

    @property
    @abstractmethod
    def _slots(self) -> np.ndarray:
        """Particle number in each slot, shape (N,)."""

    @property
    @abstractmethod
    def _positions(self) -> np.ndarray:
        """Positions in the order of slots, shape (d, N)."""

    @property
    @abstractmethod
    def _velocities(self) -> np.ndarray:
        """Velocities in the order of slots, shape (d, N)."""

    @property
    @abstractmethod
    def _images(self) -> np.ndarray:
        """Numbers of crossings of periodic faces in the order of particles, shape (d, N)."""

    @abstractmethod
    def _advance_to(self, step: int) -> None:
        """Perform and count at least one step, up to this number; SimulationError if the run cannot
        continue.
        """

    @abstractmethod
    def _sums(self) -> dict[str, np.ndarray]:
        """Return the arrays (threads, ...) of counters, by their names in a checkpoint."""

    @abstractmethod
    def _counts(self) -> dict[str, Any]:
        """Return the counters, except time, steps and energy of faces, by their fields in `Tally`."""

    @property
    @abstractmethod
    def _loss(self) -> np.ndarray:
        """Energy removed by contacts since the last reset, as terms (K, 2) in units with `unit_mass`."""

    @property
    @abstractmethod
    def _heat(self) -> np.ndarray:
        """Energy given to each face by drawn velocities, as terms (2d, 2) in the unit of `_loss`."""

    @property
    def _given(self) -> np.ndarray:
        """Energy added by kicks, shape (1, 2), in the unit of `_loss`."""
        return np.zeros((1, 2))

    @property
    def _progress(self) -> float:
        """Number of completed steps, including the completed fraction of a step."""
        return self._steps

    def _by_particle(self, values: np.ndarray, dtype: DTypeLike | None = None) -> np.ndarray:
        """Convert values (d, N), ordered by slots, to values (N, d), ordered by particles."""
        result = np.empty(values.shape[::-1], dtype or values.dtype)
        result[self._slots] = values.T
        return result

    @property
    def time(self) -> float:
        return self._start + self._progress * self.time_step

    def advance(
        self,
        until: float,
        max_events: int | None = None,
        log: EventLog | None = None,
        max_work: int | None = None,
    ) -> None:
        """Advance to the last step that ends by `until`, with a tolerance of 1e-9 steps. Raises SceneError
        for a time beyond 2^53 steps. Raises it also for a limit or a record of events, which require the
        event-driven engine. Raises SimulationError if the particles are too fast for a step.
        """
        limits = {
            "max_events": max_events,
            "max_work": max_work,
            "record_events": None if log is None else True,
        }
        for key, value in limits.items():
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
        self._lost[:] = self.dissipated, self.exchanged
        for sums in self._sums().values():
            sums[...] = 0
        for part in self._parts:
            part.reset(self._clock)
        self._since = self._steps

    @property
    def dissipated(self) -> float:
        return float(self._lost[0]) + net(self._loss, self._heat, -self._given) * self._unit_mass

    @property
    def exchanged(self) -> float:
        gross = net(self._loss) + float(np.abs(self._heat.sum(axis=1)).sum())
        return float(self._lost[1]) + gross * self._unit_mass + abs(net(self._given)) * self._unit_mass

    @property
    def state(self) -> State:
        """State of all particles at the present time, in float64 even if the engine uses float32."""
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
        """Return all arrays (threads, ...) of counters, including the arrays of parts."""
        return {**self._sums(), **sums_of(self._parts)}

    def _sum_threads(self, sums: np.ndarray) -> np.ndarray:
        """Return the sum over threads of an array (threads, ...) of counters."""
        return np.asarray(sums.sum(axis=0))

    def _checkpoint_data(self) -> dict[str, Any]:
        return {
            **super()._checkpoint_data(),
            **{key: self._sum_threads(sums) for key, sums in self._all_sums().items()},
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
        """Place the particles into the slots of a checkpoint. Counters of this work are overwritten."""
        self._place(*(checkpoint[key] for key in _PLACED))
