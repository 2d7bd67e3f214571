"""Opening the file of a trajectory, with its header and its number of frames checked against its size."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from gaspart.errors import SceneError
from gaspart.files import open_regular
from gaspart.scene.scene import Scene
from gaspart.system import descriptor_path
from gaspart.trajectory import amber
from gaspart.trajectory.frames import CheckedFrames, damaged_frame, frame_count
from gaspart.trajectory.partial import PARTIAL, replica_path

if TYPE_CHECKING:
    import netCDF4


def run_path(given: object) -> Path:
    """The path of a trajectory that a user gives. Raises SceneError for other things."""
    if isinstance(given, str | os.PathLike):
        return Path(given)
    raise no_run(given)


def no_run(given: object) -> SceneError:
    """The error of what is no trajectory."""
    rule = "must be the path of a trajectory, which gaspart.run writes"
    if isinstance(given, Scene):
        rule = "this is a scene: run it first, gaspart.run(scene, duration=..., path=...)"
    return SceneError("trajectory", f"a {type(given).__name__}", rule)


@contextmanager
def checked(path: Path) -> Iterator[tuple[BinaryIO, bytes, int]]:
    """A trajectory of gaspart: the file, its header and its number of frames, which are checked against it.

    Raises SceneError for a file of another kind, truncated, or damaged in its header.
    """
    try:
        with open_regular(path) as file:
            status = os.fstat(file.fileno())
            if path.suffix == PARTIAL and amber.is_blank(file):
                raise ValueError("nothing was written to it yet; start the run again with `gaspart run`")
            header, frames = amber.stored_header(file), frame_count(file)
            needed = len(header) + frames * amber.frame_bytes(header)
            if status.st_size < needed:
                rule = f"is truncated: {status.st_size} bytes, where {frames} frames need {needed}"
                raise ValueError(rule)
            if status.st_size > needed and path.suffix != PARTIAL:  # that one may end within a frame
                rule = f"is damaged: {status.st_size} bytes, where {frames} frames need {needed}"
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
    """A trajectory of gaspart as a netCDF4.Dataset, to be closed by the caller.

    Raises SceneError for a file of another kind, truncated, or damaged in its header.
    """
    return open_checked(path)[0]


def open_checked(path: Path) -> tuple[netCDF4.Dataset, CheckedFrames]:
    """A trajectory as `open_netcdf` opens it, and the record of which of its frames were checked; the caller
    closes both."""
    with checked(path) as (file, header, frames):
        return open_descriptor(file), CheckedFrames(file, header, frames)


def open_descriptor(file: BinaryIO) -> netCDF4.Dataset:
    """An open file as a netCDF4.Dataset."""
    import netCDF4

    return netCDF4.Dataset(descriptor_path(file))


@contextmanager
def opened(path: Path) -> Iterator[netCDF4.Dataset]:
    """A trajectory as `open_netcdf` opens it, closed after the block."""
    with open_netcdf(path) as file:
        yield file


def check_frames(path: Path, numbers: range | None = None) -> None:
    """Read some frames of a trajectory, or all. SceneError if one is damaged."""
    with checked(path) as (file, header, frames):
        wanted = range(frames) if numbers is None else range(numbers.start, min(numbers.stop, frames))
        damaged = damaged_frame(file.fileno(), header, wanted)
        if damaged is not None:
            raise ValueError(damage(damaged))


def damage(frame: int) -> str:
    """The message about a frame whose checksum is wrong."""
    return f"frame {frame} is damaged: its checksum does not match"
