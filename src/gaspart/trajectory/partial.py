"""The file of a trajectory while it is being written: its name, what it is, and its lock."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from gaspart.errors import SceneError
from gaspart.files import FileKind, may_replace, open_regular
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
    """The partial file, open to read and write, without a buffer, locked by this process.

    Raises SceneError for a file that gaspart did not write, for a link, and for a file with a second name:
    what is written to it would change what the user has under that name.
    """
    with suppress(FileNotFoundError):  # another process has finished it just now
        may_replace(partial, UNFINISHED, overwrite=True)
    descriptor = os.open(partial, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
    with open(descriptor, "r+b", buffering=0) as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            ours = os.stat(partial).st_ino == os.fstat(file.fileno()).st_ino
        except (BlockingIOError, FileNotFoundError):
            ours = False
        if not ours:
            raise SceneError("path", str(partial), "is being written by another process")
        may_replace(partial, UNFINISHED, overwrite=True)  # again: it may have appeared before it was opened
        if os.fstat(file.fileno()).st_nlink > 1:
            rule = "is a file with a second name (a hard link), which would change too; copy it instead"
            raise SceneError("path", str(partial), rule)
        try:
            yield file
        finally:
            if os.fstat(file.fileno()).st_size == 0:
                partial.unlink(missing_ok=True)
