"""What both engines need around their kernels."""

from __future__ import annotations

import numpy as np

_ROOM = 4096  # events that the record holds before it is emptied


def masses_for_kernel(masses: np.ndarray) -> tuple[float, np.ndarray | None]:
    """(unit, array): equal masses are left out of the kernel altogether, and their sums scaled by `unit`."""
    if len(masses) == 0:
        return 1.0, None
    return (float(masses[0]), None) if (masses == masses[0]).all() else (1.0, masses)


def aligned(shape: tuple[int, ...], dtype) -> np.ndarray:
    """An array of zeros that starts on a cache line."""
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    buffer = np.zeros(size + 64, dtype=np.uint8)
    start = -buffer.ctypes.data % 64
    return buffer[start : start + size].view(dtype).reshape(shape)


class EventLog:
    """Events as they happened: bodies, and their positions and velocities just after."""

    def __init__(self, dimension: int):
        from gaspart.engines.layout import Record

        self._dimension = dimension
        self._parts: list[tuple[np.ndarray, ...]] = []
        self.room = Record(
            filled=np.zeros(1, dtype=np.int64),
            time=np.empty(_ROOM),
            bodies=np.empty((_ROOM, 2), dtype=np.int64),
            positions=np.empty((_ROOM, 2, dimension)),
            velocities=np.empty((_ROOM, 2, dimension)),
        )

    def take(self, start: float) -> None:
        """Empty the kernel's record, whose times count from `start`."""
        n = int(self.room.filled[0])
        self.room.filled[0] = 0
        if n:
            time, *others = (array[:n].copy() for array in self.room[1:])
            self._parts.append((start + time, *others))

    @property
    def events(self) -> dict[str, np.ndarray]:
        """time (M,), bodies (M, 2), positions and velocities (M, 2, d).

        The second of `bodies` is -1 - face for a hit at a wall, and its position and velocity are NaN.
        """
        keys = ("time", "bodies", "positions", "velocities")
        empty = tuple(array[:0] for array in self.room[1:])
        return dict(zip(keys, map(np.concatenate, zip(*(self._parts or [empty]), strict=True)), strict=True))
