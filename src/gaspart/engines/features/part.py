"""The part of a run that belongs to one feature of its scene.

A module of this package has all that the engines need of a feature: what the kernels' model has of it, None
where it is absent, and a `Part`. An engine goes through the parts of a scene and does not name them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.state.state import State

if TYPE_CHECKING:
    from gaspart.kernels.model import Model, Particles, Tally


class Part:
    """A feature in a run. Each method is for what a feature may have, and does nothing by default.

    arrays: those that a run changes, by their names in a checkpoint; sums: likewise those (threads, ...) that
    several threads add to, of which a checkpoint has the sum; times: those of `arrays` that are times on the
    clocks of the epoch; scheduled (1,): the time of the next event that it has scheduled; gained: the square
    of the largest speed that it can give a particle.
    """

    gained = 0.0

    def __init__(
        self,
        arrays: dict[str, np.ndarray],
        times: Iterable[np.ndarray] = (),
        scheduled: np.ndarray | None = None,
        sums: dict[str, np.ndarray] | None = None,
    ) -> None:
        self.sums = sums or {}
        self.arrays, self._times, self._scheduled = arrays, times, scheduled

    @property
    def next(self) -> float:
        """The time of the next scheduled event on the clocks of the epoch; infinite if there is none."""
        return math.inf if self._scheduled is None else float(self._scheduled[0])

    @property
    def at_rest(self) -> bool:
        """Whether it has stopped all particles, for good."""
        return False

    @property
    def stored(self) -> float:
        """The energy that particles keep in it and that contacts may turn into motion."""
        return 0.0

    @property
    def given(self) -> float:
        """The energy that it has given by scheduled events since the last `reset`."""
        return 0.0

    def set_clock(self, clock: float) -> None:
        """Begin at this time on the clocks of the epoch."""

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Set all that depends on the `length` of an epoch of the clocks that starts at the time `start`.
        Returns the model for it."""
        return model

    def close_epoch(self, length: float) -> None:
        """Count what depends on the flights of an epoch of this `length`, before all particles are moved to
        its end."""

    def end_epoch(self, length: float, start: float) -> None:
        """Let the clocks count from zero again after an epoch of this `length`, which is the time `start`; or
        from another start, so much later, within an epoch."""
        for times in self._times:
            times -= length

    def apply_event(self, particles: Particles, model: Model, tally: Tally, start: float) -> bool:
        """Let the event happen that is scheduled for the time `next` of an epoch with this `start`. Returns
        whether all events must be predicted anew."""
        raise NotImplementedError

    def reset(self, clock: float) -> None:
        """Begin to count from zero at this time on the clocks of the epoch."""
        for sums in self.sums.values():
            sums[...] = 0

    def counts(self, clock: float) -> dict[str, Any]:
        """Its counters from the last `reset` until this time on the clocks of the epoch, by the fields
        of `state.tally.Tally`."""
        return {}

    def write(self, state: State, clock: float) -> None:
        """Write what the particles and the scene have of it, at this time on the clocks of the epoch, into a
        state."""


class TallyPart(Part):
    """An optional tally in a run (`state.optional_tallies`).

    name: that of the tally; kernel: what the kernels add to, in an entry of their own tally that has this
    name.
    """

    def __init__(
        self,
        name: str,
        kernel: Any,
        arrays: dict[str, np.ndarray],
        sums: dict[str, np.ndarray] | None = None,
    ) -> None:
        super().__init__(arrays, sums=sums)
        self.name, self.kernel = name, kernel

    def read(self, clock: float) -> np.ndarray:
        """All its sums from the last `reset` until this time on the clocks of the epoch, in one array."""
        raise NotImplementedError


def arrays_of(parts: Iterable[Part]) -> dict[str, np.ndarray]:
    """The arrays of several parts, by name."""
    return {key: array for part in parts for key, array in part.arrays.items()}


def sums_of(parts: Iterable[Part]) -> dict[str, np.ndarray]:
    """The arrays of several parts that threads add to, by name."""
    return {key: array for part in parts for key, array in part.sums.items()}


def write_parts(parts: Iterable[Part], state: State, clock: float = 0.0) -> None:
    """Write what several parts have into a state. Energies of vibrations add up."""
    if state.vibrations is not None:
        state.vibrations = np.zeros(state.count)
    for part in parts:
        part.write(state, clock)
