"""The file of a trajectory while it is being written: its name, what it is, and its lock."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from gaspart.errors import SceneError
from gaspart.files import FileKind, may_replace, only_process, open_regular
from gaspart.system import NO_LINK
from gaspart.trajectory import amber

PARTIAL = ".partial"
"""The suffix of a trajectory that is being written."""


def partial_path(path: Path) -> Path:
    """Where a trajectory is while it is being written. Raises SceneError for a path without a name."""
    if not path.name:
        raise SceneError("path", str(path), "must be the name of a file")
    return path.with_name(path.name + PARTIAL)


def is_blank(path: Path) -> bool:
    """Whether nothing was written to the file yet."""
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
    """Raise SceneError for OSError: a full disk, a read-only folder, and the like."""
    try:
        yield
    except OSError as error:
        rule = f"cannot be written: {error.strerror}; what was written before is kept"
        raise SceneError("path", str(path), rule) from None


@contextmanager
def locked(partial: Path) -> Iterator[BinaryIO]:
    """The partial file, open to read and write, without a buffer, locked by this process. It may be closed
    within the block, as before it is renamed; the lock stays.

    Raises SceneError for a file that gaspart did not write, for a link, and for a file with a second name:
    what is written to it would change what the user has under that name.
    """
    with suppress(FileNotFoundError):  # another process has finished it just now
        may_replace(partial, UNFINISHED, overwrite=True)
    with _alone(partial), open(partial, "r+b", buffering=0, opener=_open_or_create) as file:
        may_replace(partial, UNFINISHED, overwrite=True)  # again: it may have appeared before it was opened
        if os.fstat(file.fileno()).st_nlink > 1:
            rule = "is a file with a second name (a hard link), which would change too; copy it instead"
            raise SceneError("path", str(partial), rule)
        try:
            yield file
        finally:
            file.close()
            with suppress(FileNotFoundError):  # it was renamed
                if not partial.lstat().st_size:
                    partial.unlink()


@contextmanager
def _alone(partial: Path) -> Iterator[None]:
    """Hold the lock of a partial file. Raises SceneError if another process does."""
    try:
        with only_process(partial):
            yield
    except BlockingIOError:
        raise SceneError("path", str(partial), "is being written by another process") from None


def _open_or_create(path: str, flags: int) -> int:
    """The opener of a file that may not exist yet, and is no link."""
    return os.open(path, flags | os.O_CREAT | NO_LINK, 0o666)


def replica_path(path: Path, number: int) -> Path:
    """Return the file of a replica of the run at a path: `run-1.nc`, `run-2.nc` ... of `run.nc`."""
    return path.with_name(f"{path.stem}-{number}{path.suffix}")
