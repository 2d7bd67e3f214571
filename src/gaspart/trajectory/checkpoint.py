"""The float64 state of an unfinished run, in a file that is written completely or not at all."""

from __future__ import annotations

import hashlib
import os
import struct
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

_DIGEST, _FRAMES = "trajectory header", "trajectory frames"
_COMMENT_LENGTH, _CHECKSUM = struct.Struct("<H"), struct.Struct("<I")  # the end of a zip file


@dataclass(frozen=True)
class Checkpoint:
    """frames: how many frames of the trajectory were complete; arrays: for `Simulation.restore`."""

    frames: int
    arrays: dict[str, np.ndarray]


def checkpoint_path(path: Path) -> Path:
    """Where the float64 state of an unfinished trajectory is."""
    return path.with_name(path.name + ".checkpoint.npz")


def _digest(header: bytes) -> str:
    return hashlib.sha256(header).hexdigest()


def _new(path: Path) -> Path:
    return path.with_name(path.name + ".new")


def remove_checkpoint(path: Path) -> None:
    """Remove a checkpoint that is not needed any more, and the rest of an unfinished one."""
    path.unlink(missing_ok=True)
    _new(path).unlink(missing_ok=True)


def write_checkpoint(path: Path, header: bytes, frames: int, arrays: dict[str, Any]) -> None:
    """Write the checkpoint of a run, identified by the header of its trajectory. May raise OSError.

    It is a zip file of arrays (.npz) whose comment, at the end, is a checksum of all before it.
    """
    new = _new(path)
    try:
        with new.open("w+b") as file:
            parts: dict[str, Any] = {_DIGEST: np.array(_digest(header)), _FRAMES: np.array(frames)}
            np.savez(file, **arrays, **parts)
            file.seek(-_COMMENT_LENGTH.size, os.SEEK_END)
            file.write(_COMMENT_LENGTH.pack(_CHECKSUM.size))
            file.write(_CHECKSUM.pack(_checksum(file)))
            file.flush()
            os.fsync(file.fileno())
        os.replace(new, path)
    except OSError:
        new.unlink(missing_ok=True)
        raise


def read_checkpoint(path: Path, header: bytes) -> Checkpoint | None:
    """The checkpoint of the run with this header, or None if there is none, or a damaged one."""
    try:
        if not path.is_file():
            return None
        with path.open("rb") as file:
            if not _is_intact(file):  # checked here, because zipfile and numpy raise many kinds of errors
                return None
            file.seek(0)
            with np.load(file, allow_pickle=False) as parts:
                arrays = {key: parts[key] for key in parts.files}
        digest, frames = str(arrays.pop(_DIGEST)), int(arrays.pop(_FRAMES))
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    return Checkpoint(frames, arrays) if digest == _digest(header) else None


def _is_intact(file: BinaryIO) -> bool:
    size = file.seek(0, os.SEEK_END)
    if size < _CHECKSUM.size:
        return False
    checksum = _checksum(file, size - _CHECKSUM.size)
    return _CHECKSUM.unpack(file.read(_CHECKSUM.size)) == (checksum,)


def _checksum(file: BinaryIO, size: int | None = None) -> int:
    """The checksum of a file, or of its first `size` bytes; what is read next comes after these."""
    remaining = file.seek(0, os.SEEK_END) if size is None else size
    file.seek(0)
    value = 0
    while remaining > 0 and (data := file.read(min(remaining, 1 << 20))):
        value, remaining = zlib.crc32(data, value), remaining - len(data)
    return value
