"""The frames of a trajectory file, behind its header.

They are appended as they come, and the number of frames in the header is raised when a frame is complete, so
that a file cut short at any moment is a readable one. A checksum (CRC-32) at the end of each frame, which
depends on the header and on the frame's place too, detects damage.
"""

from __future__ import annotations

import os
import struct
import weakref
import zlib
from collections.abc import Iterator
from typing import BinaryIO

import numpy as np

from gaspart.system import read_at, write_at
from gaspart.trajectory.amber import FRAME_COUNT_AT, MAGIC, WORD, Layout, frame_bytes

_CHUNK = 1 << 24  # bytes that are read at once


def frame_count(file: BinaryIO) -> int:
    """The number of complete frames that a file's header states."""
    file.seek(FRAME_COUNT_AT)
    return struct.unpack(">I", file.read(WORD))[0]


def _frame_checksum(frame: bytes | memoryview, number: int, header_checksum: int) -> bytes:
    """The last word of a frame: the checksum of what comes before it."""
    start = zlib.crc32(struct.pack(">I", number), header_checksum)
    return struct.pack(">I", zlib.crc32(frame[:-WORD], start))


def damaged_frame(file: int, header: bytes, numbers: range) -> int | None:
    """The first of some frames that is damaged or cut short, None if all are correct; `file`: a descriptor.

    It reads them: a CRC-32 takes about as long as copying them from memory.
    """
    size, header_checksum = frame_bytes(header), zlib.crc32(header)
    at_once = max(1, _CHUNK // size)
    for first in range(numbers.start, numbers.stop, at_once):
        wanted = min(at_once, numbers.stop - first)
        data = memoryview(read_at(file, wanted * size, len(header) + first * size))
        for n in range(wanted):
            frame = data[n * size : (n + 1) * size]
            if len(frame) < size or frame[-WORD:] != _frame_checksum(frame, first + n, header_checksum):
                return first + n
    return None


def frames_of(file: BinaryIO, header: bytes, count: int) -> Iterator[memoryview]:
    """The first frames of an open file, as they are in it."""
    size = frame_bytes(header)
    for n in range(count):
        yield memoryview(bytearray(read_at(file.fileno(), size, len(header) + n * size)))


class CheckedFrames:
    """Which frames of an open trajectory are known to be undamaged: each is checked once, before use."""

    def __init__(self, file: BinaryIO, header: bytes, frames: int) -> None:
        self._header, self._checked = header, np.zeros(frames, dtype=bool)
        self._file = os.dup(file.fileno())
        self.close = weakref.finalize(self, os.close, self._file)

    def damaged(self, numbers: np.ndarray) -> int | None:
        """The first of these frames that is damaged; None if there is none. May raise OSError."""
        new = np.zeros_like(self._checked)
        new[numbers] = True
        edges = np.flatnonzero(np.diff((new & ~self._checked).astype(np.int8), prepend=0, append=0))
        for first, last in edges.reshape(-1, 2).tolist():
            frame = damaged_frame(self._file, self._header, range(first, last))
            if frame is not None:
                return frame
            self._checked[first:last] = True
        return None


class Frames:
    """The frames of an unbuffered open file, of which the first `kept` are kept and the others removed.

    With `kept` = 0 the header is written too. Every method may raise OSError.
    """

    def __init__(self, file: BinaryIO, layout: Layout, header: bytes, kept: int = 0) -> None:
        self._file, self._frame = file, np.zeros((), layout.frame)
        self.header, self.count = header, kept
        self._header_checksum = zlib.crc32(header)
        if kept == 0:
            self._begin(header)
        else:
            self._count_frames()
        file.truncate(len(header) + kept * layout.frame.itemsize)
        file.seek(0, os.SEEK_END)

    def _begin(self, header: bytes) -> None:
        """Write the header, its first word last: if that is present, the header is complete."""
        self._file.truncate(0)
        self._file.seek(0)
        try:
            self._write(bytes(len(MAGIC)) + header[len(MAGIC) :])
        except OSError:
            self._file.truncate(0)
            raise
        write_at(self._file.fileno(), header[: len(MAGIC)], 0)

    def append(self, values: dict[str, np.ndarray | float]) -> None:
        """Write one frame: a value for every variable of the layout, vectors of 2 or 3 components."""
        for name in self._frame.dtype.names[:-1]:
            given = np.asarray(values[name])
            there = self._frame[name]
            components = there[..., : given.shape[-1]] if given.ndim else there  # 2D leaves z = 0
            components[...] = given
        self.append_bytes(self._frame.reshape(1).view(np.uint8).data)

    def append_bytes(self, data: memoryview) -> None:
        """Write one frame as it is in a file, with the checksum that belongs to its header and place."""
        data[-WORD:] = _frame_checksum(data, self.count, self._header_checksum)
        self._write(data)
        self.count += 1
        self._count_frames()

    def _write(self, data: bytes | memoryview) -> None:
        unwritten = memoryview(data).cast("B")
        while unwritten:
            unwritten = unwritten[self._file.write(unwritten) :]

    def _count_frames(self) -> None:
        write_at(self._file.fileno(), struct.pack(">I", self.count), FRAME_COUNT_AT)

    def sync(self) -> None:
        """Return when all data are on the disk."""
        os.fsync(self._file.fileno())
