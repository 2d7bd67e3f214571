"""Trajectory file: name during the run, test of its kind, lock, and opening."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from gaspart.errors import SceneError
from gaspart.files import FileKind, may_replace, only_process, open_regular
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
    """Hold the lock of a partial file during the `with` block. Raises SceneError if another process has
    locked it.
    """
    try:
        with only_process(partial):
            yield
    except BlockingIOError:
        raise SceneError("path", str(partial), "is being written by another process") from None


def _open_or_create(path: str, flags: int) -> int:
    """Open a file, or create it if it does not exist; links are rejected."""
    return os.open(path, flags | os.O_CREAT | os.O_NOFOLLOW, 0o666)


def replica_path(path: Path, number: int) -> Path:
    """Return the file of a replica of the run at a path. The replicas of `run.nc` are `run-1.nc`, `run-2.nc`
    ...
    """
    return path.with_name(f"{path.stem}-{number}{path.suffix}")


# Opening the file of a trajectory. Its header and its number of frames are compared with its size.


def run_path(value: object) -> Path:
    """Return an argument of a user as the path of a trajectory. Raises SceneError if the argument is not a
    path.
    """
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
    """Open a trajectory; return the file, its header and its number of frames. Header and number of frames
    are compared with the size of the file. Raises SceneError for a file of another kind, a truncated file, or
    a damaged header.
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
    """Open a trajectory of gaspart as a netCDF4.Dataset; the caller must close it. Raises SceneError for a
    file of another kind, a truncated file, or a damaged header.
    """
    return open_checked(path)[0]


def open_checked(path: Path) -> tuple[netCDF4.Dataset, CheckedFrames]:
    """Open a trajectory like `open_netcdf`; also return the record of its checked frames. The caller must
    close the Dataset and the record.
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
