"""A scene in progress: what every engine gives, and what all share, checkpoints and optional tallies."""

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
    """A scene in progress under an engine.

    numbers: the attributes that are plain numbers, by their names in a checkpoint, which have no underscore.
    """

    numbers: ClassVar[tuple[str, ...]]
    _parts: list[Part]
    _clock = 0.0

    @property
    @abstractmethod
    def time(self) -> float:
        """The time reached."""

    @property
    @abstractmethod
    def state(self) -> State:
        """All particles now; a copy."""

    @property
    @abstractmethod
    def tally(self) -> Tally:
        """Counters and sums since the last `reset_tally`; a copy."""

    @property
    @abstractmethod
    def dissipated(self) -> float:
        """The energy that contacts and thermal walls have taken since time 0, less what kicks have given."""

    @property
    @abstractmethod
    def exchanged(self) -> float:
        """The sum of what contacts and each face have taken or given since time 0, each counted positive."""

    @abstractmethod
    def advance(
        self,
        until: float,
        max_events: int | None = None,
        log: EventLog | None = None,
        max_work: int | None = None,
    ) -> None:
        """Advance to the time `until`, or by so many events or so much work, and record events in `log`.

        Raises SceneError for a limit that the engine does not have, and SimulationError, with the state kept,
        for a run that cannot go on.
        """

    @abstractmethod
    def reset_tally(self) -> None:
        """Begin to count from zero."""

    def _tally_part(self, name: str) -> TallyPart | None:
        """The part of the optional tally of this name; None if it was not asked for."""
        parts = (part for part in self._parts if isinstance(part, TallyPart))
        return next((part for part in parts if part.name == name), None)

    def sums_of(self, tally: str) -> np.ndarray:
        """The sums of an optional tally, in one array. Raises KeyError if it was not asked for."""
        part = self._tally_part(tally)
        if part is None:
            raise KeyError(tally)
        return part.read(self._clock)

    def checkpoint(self) -> dict[str, np.ndarray]:
        """All that a continuation to the same bits needs; copies."""
        return {key: np.array(value) for key, value in self._kept().items()}

    def restore(self, checkpoint: dict[str, np.ndarray]) -> None:
        """Go on from a checkpoint of the same scene and engine, to the same bits whatever the settings that
        change none. Raises SceneError, with nothing changed, for one that lacks an array."""
        needed = self._needed(checkpoint)
        check_parts(checkpoint, needed)
        for key, array in self._arrays().items():
            if key in needed:
                array[...] = checkpoint[key]
        for key in self.numbers:
            setattr(self, f"_{key}", checkpoint[key].item())
        self._go_on(checkpoint)

    def _arrays(self) -> dict[str, np.ndarray]:
        """The arrays that a run changes and that a checkpoint has as they are, by name."""
        return arrays_of(self._parts)

    def _kept(self) -> dict[str, Any]:
        """All of a checkpoint."""
        return {**{key: getattr(self, f"_{key}") for key in self.numbers}, **self._arrays()}

    def _needed(self, checkpoint: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """The arrays that `restore` needs of this checkpoint, of their shapes. Raises SceneError."""
        return self.checkpoint()

    @abstractmethod
    def _go_on(self, checkpoint: dict[str, np.ndarray]) -> None:
        """Make what follows from a checkpoint besides its arrays and numbers, which are in place."""
