"""The events of a run as they happened."""

from __future__ import annotations

import numpy as np

_ROOM = 4096  # capacity of the record, in events


class EventLog:
    """Events as they happened: particles, and their positions, velocities and, if wanted, spins just
    after."""

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
        """The first events in the kernel's record; of spins in 2D the component normal to the plane."""
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
        """time (M,), particles (M, 2), positions and velocities (M, 2, d), and spins (M, 2) or (M, 2, 3).

        The second of `particles` is -1 - face for a hit at a wall, and the values of the second are NaN.
        """
        parts = zip(*(self._parts or [self._copy(0)]), strict=True)
        return dict(zip(self._keys, map(np.concatenate, parts), strict=True))
