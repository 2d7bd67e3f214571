"""Checkpoint: file with the float64 state of a run, written completely or not at all."""

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

from gaspart.errors import SceneError
from gaspart.files import FileKind, open_regular, place, remove_own, scratch_beside

_DIGEST, _FRAMES = "trajectory header", "trajectory frames"
_MARKS = tuple(f"{name}.npy".encode() for name in (_DIGEST, _FRAMES))
"""Names of parts in every checkpoint, which appear at its beginning and in the directory at its end."""
_NEAR = 1 << 16  # these parts are within this number of bytes from either end
_LEAST = 64  # in bytes; a shorter file does not contain the first name
_COMMENT_LENGTH, _CHECKSUM = struct.Struct("<H"), struct.Struct("<I")  # record at the end of a zip file


@dataclass(frozen=True)
class Checkpoint:
    """Contents of the checkpoint of a run."""

    frames: int
    arrays: dict[str, np.ndarray]


def checkpoint_path(path: Path) -> Path:
    """Return the path of the float64 state of an unfinished trajectory."""
    return path.with_name(path.name + ".checkpoint.npz")


def _is_checkpoint(path: Path) -> bool:
    """Return True if a file was written by `write_checkpoint`, even if it is damaged now."""
    with open_regular(path) as file:
        start = file.read(_NEAR)
        size = file.seek(0, os.SEEK_END)
        file.seek(max(0, size - _NEAR))
        end = file.read()
    if size < _LEAST:
        return start.startswith(b"PK\x03\x04"[:size])
    return any(mark in part for mark in _MARKS for part in (start, end))


CHECKPOINT = FileKind("a checkpoint written by gaspart", _is_checkpoint)


def _digest(header: bytes) -> str:
    return hashlib.sha256(header).hexdigest()


def remove_checkpoint(path: Path) -> None:
    """Remove a checkpoint that is not needed or incomplete; keep files of other kinds."""
    remove_own(path, CHECKPOINT)


def write_checkpoint(path: Path, header: bytes, frames: int, arrays: dict[str, Any]) -> None:
    """Write the checkpoint of a run, identified by the header of its trajectory. The file is a zip file of
    arrays (.npz). Its comment, at the end, is a checksum of all bytes before the comment. If the file at
    `path` is not a checkpoint, it is not replaced, and SceneError is raised. May raise OSError.
    """
    with scratch_beside(path) as new:
        with new.open("r+b") as file:
            parts: dict[str, Any] = {_DIGEST: np.array(_digest(header)), _FRAMES: np.array(frames)}
            np.savez(file, **parts, **arrays)
            file.seek(-_COMMENT_LENGTH.size, os.SEEK_END)
            file.write(_COMMENT_LENGTH.pack(_CHECKSUM.size))
            file.write(_CHECKSUM.pack(_checksum(file)))
            file.flush()
            os.fsync(file.fileno())
        place(new, path, CHECKPOINT, overwrite=True)


def read_checkpoint(path: Path, header: bytes) -> Checkpoint | None:
    """Return the checkpoint of the run with this header; None if it is missing or unusable."""
    try:
        return _checkpoint(path, header)
    except SceneError:
        return None


def kept_beside(path: Path, header: bytes, otherwise: str) -> Checkpoint | None:
    """Return the checkpoint that was stored with a trajectory, or None. `header` is the header of the
    trajectory. Raises SceneError for a checkpoint that cannot be used, because it must not be replaced
    silently by less exact data.

    otherwise : words for the message that state what the user can do without the checkpoint.
    """
    try:
        return _checkpoint(checkpoint_path(path), header)
    except SceneError as error:
        raise SceneError(error.key, error.value, f"{error.rule}; {otherwise}, move it away") from None


def _checkpoint(path: Path, header: bytes) -> Checkpoint | None:
    """Read a checkpoint like `read_checkpoint`, but raise SceneError if it is unusable. A checkpoint is
    unusable if it is damaged, or belongs to another run. A file of another kind is unusable, too.
    """
    try:
        with open_regular(path) as file:
            if not _is_intact(file):  # checked here, because zipfile and numpy raise many kinds of errors
                raise SceneError("file", str(path), "is a damaged checkpoint, or none of gaspart")
            file.seek(0)
            with np.load(file, allow_pickle=False) as parts:
                arrays = {key: parts[key] for key in parts.files}
        digest, frames = str(arrays.pop(_DIGEST)), int(arrays.pop(_FRAMES))
    except FileNotFoundError:
        return None
    except OSError as error:
        raise SceneError("file", str(path), f"cannot be read: {error.strerror}") from None
    except SceneError:
        raise
    except (ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise SceneError("file", str(path), f"is no checkpoint of gaspart: {error}") from None
    if digest != _digest(header):
        rule = "is the checkpoint of another run than the file beside it, or of one under way"
        raise SceneError("file", str(path), rule)
    return Checkpoint(frames, arrays)


def _is_intact(file: BinaryIO) -> bool:
    size = file.seek(0, os.SEEK_END)
    if size < _CHECKSUM.size:
        return False
    checksum = _checksum(file, size - _CHECKSUM.size)
    return _CHECKSUM.unpack(file.read(_CHECKSUM.size)) == (checksum,)


def _checksum(file: BinaryIO, size: int | None = None) -> int:
    """Compute the checksum of a file, or of its first `size` bytes. The next read of the file starts after
    these bytes.
    """
    remaining = file.seek(0, os.SEEK_END) if size is None else size
    file.seek(0)
    value = 0
    while remaining > 0 and (data := file.read(min(remaining, 1 << 20))):
        value, remaining = zlib.crc32(data, value), remaining - len(data)
    return value
