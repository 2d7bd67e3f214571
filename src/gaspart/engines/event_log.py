"""Record of the events of a run."""

from __future__ import annotations

import numpy as np

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
        record = {key: getattr(self.room, key)[:count] for key in self._keys}
        if "spins" in record and self._dimension == 2:
            record["spins"] = record["spins"][..., 2]
        return tuple(array.copy() for array in record.values())

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
