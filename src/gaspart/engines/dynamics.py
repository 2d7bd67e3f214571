"""What the dynamics of all engines share: optional tallies by parts."""

from __future__ import annotations

import numpy as np

from gaspart.engines.features.part import Part, TallyPart


class EngineDynamics:
    """A scene in progress under an engine."""

    _parts: list[Part]
    _clock = 0.0

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
