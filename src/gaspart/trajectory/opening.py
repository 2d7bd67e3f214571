"""Files of a run: the trajectory, its name and lock while it is written, and the checkpoint."""

from __future__ import annotations

import hashlib
import os
import struct
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from gaspart.errors import SceneError
from gaspart.files import FileKind, may_replace, only_process, open_regular, place, remove_own, scratch_beside
from gaspart.scene.scene import Scene
from gaspart.system import descriptor_path
from gaspart.trajectory import amber
from gaspart.trajectory.amber import CheckedFrames, damaged_frame, frame_count

if TYPE_CHECKING:
    import netCDF4

PARTIAL = ".partial"
"""Suffix of the file name of a trajectory during the run."""


def partial_path(path: Path) -> Path:
    """Return the path of a trajectory during the run. Raises SceneError for a path without a name."""
    if not path.name:
        raise SceneError("path", str(path), "must be the name of a file")
    return path.with_name(path.name + PARTIAL)


def is_blank(path: Path) -> bool:
    """Return True if nothing has been written to the file yet."""
    with open_regular(path) as file:
        return amber.is_blank(file)


def _is_trajectory(path: Path) -> bool:
    with open_regular(path) as file:
        head = file.read(4096)
    return head.startswith(b"CDF") and b"AMBER" in head and b"gaspart" in head


TRAJECTORY = FileKind("a trajectory written by gaspart", _is_trajectory)
UNFINISHED = FileKind("an unfinished trajectory", lambda path: is_blank(path) or _is_trajectory(path))


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Convert OSError in this context to SceneError, for example for a full disk."""
    try:
        yield
    except OSError as error:
        rule = f"cannot be written: {error.strerror}; what was written before is kept"
        raise SceneError("path", str(path), rule) from None


@contextmanager
def open_locked(partial: Path) -> Iterator[BinaryIO]:
    """Open the partial file for unbuffered reading and writing, and lock it. The lock lasts to the end of the
    block, even if the file is closed earlier, for example before it is renamed. Raises SceneError for a file
    that gaspart did not write, and for a link. SceneError is also raised for a file with a second name (hard
    link), because changes would appear under the second name, too.
    """
    with suppress(FileNotFoundError):  # another process has just finished it
        may_replace(partial, UNFINISHED, overwrite=True)
    with _alone(partial), open(partial, "r+b", buffering=0, opener=_open_or_create) as file:
        # checked again: the file may have appeared in the meantime
        may_replace(partial, UNFINISHED, overwrite=True)
        if os.fstat(file.fileno()).st_nlink > 1:
            rule = "is a file with a second name (a hard link), which would change too; copy it instead"
            raise SceneError("path", str(partial), rule)
        try:
            yield file
        finally:
            file.close()
            with suppress(FileNotFoundError):  # the file was renamed
                if not partial.lstat().st_size:
                    partial.unlink()


@contextmanager
def _alone(partial: Path) -> Iterator[None]:
    """Hold the lock of a partial file in the `with` block; SceneError if another process has it."""
    try:
        with only_process(partial):
            yield
    except BlockingIOError:
        raise SceneError("path", str(partial), "is being written by another process") from None


def _open_or_create(path: str, flags: int) -> int:
    """Open a file, or create it if it does not exist; links are rejected."""
    return os.open(path, flags | os.O_CREAT | os.O_NOFOLLOW, 0o666)


def replica_path(path: Path, number: int) -> Path:
    """Return the file of a replica of the run at a path: `run-1.nc`, `run-2.nc` ... for `run.nc`."""
    return path.with_name(f"{path.stem}-{number}{path.suffix}")


# Opening the file of a trajectory. Its header and its number of frames are compared with its size.


def run_path(value: object) -> Path:
    """Return an argument of a user as the path of a trajectory; SceneError if it is no path."""
    if isinstance(value, str | os.PathLike):
        return Path(value)
    raise not_a_trajectory(value)


def not_a_trajectory(value: object) -> SceneError:
    """Return the error for a value that is not a trajectory."""
    rule = "must be the path of a trajectory, which gaspart.run writes"
    if isinstance(value, Scene):
        rule = "this is a scene: run it first, gaspart.run(scene, duration=..., path=...)"
    return SceneError("trajectory", f"a {type(value).__name__}", rule)


@contextmanager
def open_verified(path: Path) -> Iterator[tuple[BinaryIO, bytes, int]]:
    """Open a trajectory; return the file, its header and its number of frames. Raises SceneError for a file
    of another kind, a truncated file, or a damaged header.
    """
    try:
        with open_regular(path) as file:
            if path.suffix == PARTIAL and amber.is_blank(file):
                raise ValueError("nothing was written to it yet; start the run again with `gaspart run`")
            header, frames = amber.stored_header(file), frame_count(file)
            expected = len(header) + frames * amber.frame_bytes(header)
            # read last, because another replica may append frames meanwhile
            size = os.fstat(file.fileno()).st_size
            if size < expected:
                rule = f"is truncated: {size} bytes, where {frames} frames need {expected}"
                raise ValueError(rule)
            if size > expected and path.suffix != PARTIAL:  # a partial file may end inside a frame
                rule = f"is damaged: {size} bytes, where {frames} frames need {expected}"
                raise ValueError(rule)
            yield file, header, frames
    except OSError as error:
        rule = f"cannot be read: {error.strerror}"
        if not path.exists() and (first := replica_path(path, 1)).exists():
            rule = f"is a run of several replicas; name one of them, as {first.name}"
        raise SceneError("file", str(path), rule) from None
    except ValueError as error:
        if isinstance(error, SceneError):
            raise
        rule = str(error)
        if path.suffix in (".yaml", ".yml"):
            rule = f"must be a trajectory; run a scene first: gaspart run {path.name} -o {path.stem}.nc"
        raise SceneError("file", str(path), rule) from None


def open_netcdf(path: Path) -> netCDF4.Dataset:
    """Open a trajectory as a netCDF4.Dataset, which the caller closes; SceneError as `open_verified`."""
    return open_checked(path)[0]


def open_checked(path: Path) -> tuple[netCDF4.Dataset, CheckedFrames]:
    """Open a trajectory like `open_netcdf`, with the record of its checked frames, which the caller closes
    too.
    """
    with open_verified(path) as (file, header, frames):
        return open_descriptor(file), CheckedFrames(file, header, frames)


def open_descriptor(file: BinaryIO) -> netCDF4.Dataset:
    """Return an open file as a netCDF4.Dataset."""
    import netCDF4

    return netCDF4.Dataset(descriptor_path(file))


@contextmanager
def open_netcdf_file(path: Path) -> Iterator[netCDF4.Dataset]:
    """Open a trajectory like `open_netcdf`; it is closed at the end of the block."""
    with open_netcdf(path) as file:
        yield file


def check_frames(path: Path, numbers: range | None = None) -> None:
    """Verify the checksums of some or all frames of a trajectory. Raises SceneError if a frame is damaged."""
    with open_verified(path) as (file, header, frames):
        selection = range(frames) if numbers is None else range(numbers.start, min(numbers.stop, frames))
        damaged = damaged_frame(file.fileno(), header, selection)
        if damaged is not None:
            raise ValueError(damage(damaged))


def damage(frame: int) -> str:
    """Return the message about a frame whose checksum is wrong."""
    return f"frame {frame} is damaged: its checksum does not match"


# Checkpoint: file with the float64 state of a run, written completely or not at all.


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
    silently by less exact data. `otherwise`: words for the message that state what the user can do without
    the checkpoint.
    """
    try:
        return _checkpoint(checkpoint_path(path), header)
    except SceneError as error:
        raise SceneError(error.key, error.value, f"{error.rule}; {otherwise}, move it away") from None


def _checkpoint(path: Path, header: bytes) -> Checkpoint | None:
    """Read a checkpoint like `read_checkpoint`; SceneError if damaged, of another run or no checkpoint."""
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
    """Compute the checksum of a file, or of its first `size` bytes, after which the next read starts."""
    remaining = file.seek(0, os.SEEK_END) if size is None else size
    file.seek(0)
    value = 0
    while remaining > 0 and (data := file.read(min(remaining, 1 << 20))):
        value, remaining = zlib.crc32(data, value), remaining - len(data)
    return value
