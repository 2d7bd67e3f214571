"""Interface of a scene in progress, and what all engines share: checkpoints and optional tallies."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np

from gaspart.engines.checkpoint_identity import check_parts
from gaspart.engines.event_log import EventLog
from gaspart.engines.features.part import Part, TallyPart, arrays_of
from gaspart.state.state import State
from gaspart.state.tally import Tally


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
        return {key: np.array(value) for key, value in self._checkpoint_data().items()}

    def restore(self, checkpoint: dict[str, np.ndarray]) -> None:
        """Continue from a checkpoint of the same scene and engine, to the same bits.

        Settings that change no bit may differ. Raises SceneError, with nothing changed, for a checkpoint that
        lacks an array.
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
        """Return the arrays, by name, that a run changes and that a checkpoint stores unchanged."""
        return arrays_of(self._parts)

    def _checkpoint_data(self) -> dict[str, Any]:
        """Return all data of a checkpoint."""
        return {**{key: getattr(self, f"_{key}") for key in self.numbers}, **self._arrays()}

    def _required_arrays(self, checkpoint: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Return arrays of the shapes that `restore` needs from this checkpoint.

        Raises SceneError for a damaged checkpoint.
        """
        return self.checkpoint()

    @abstractmethod
    def _go_on(self, checkpoint: dict[str, np.ndarray]) -> None:
        """Restore everything that follows from the arrays and numbers of a checkpoint.

        The arrays and numbers are already in place.
        """
