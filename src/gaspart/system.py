"""Differences between operating systems.

The rest of the package uses this module, and otherwise only functions that Python has on all systems. The
tests simulate what Windows and macOS lack (`tests/test_system.py`); the code was not run on these systems.
"""

from __future__ import annotations

import ctypes
import errno
import math
import os
import sys
import threading
from pathlib import Path

TYPE_CHECKING = False
if TYPE_CHECKING:  # this module is imported before signals are handled: no slow imports
    from typing import IO

POSIX = os.name == "posix"
OPEN_AS_IT_IS = getattr(os, "O_NONBLOCK", 0)
"""Flag of `os.open`: return at once, also for a pipe. Windows has none."""
NO_LINK = getattr(os, "O_NOFOLLOW", 0)
"""Flag of `os.open`: refuse a link. Without it the caller's own check before has to do."""
_HERE, _NO_REPLACE = -100, 1
"""AT_FDCWD and RENAME_NOREPLACE of Linux's renameat2."""
_position = threading.Lock()


def memory() -> int | None:
    """Return the bytes of this machine's memory; None if unknown, as on Windows."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return None


def largest_memory() -> float:
    """Return the largest memory that this process has used, in bytes; nan if unknown."""
    try:
        import resource
    except ImportError:
        return math.nan
    unit = 1 if sys.platform == "darwin" else 1024
    return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)


def user() -> str:
    """Return a short name of this user, for a folder next to other users' folders."""
    if hasattr(os, "getuid"):
        return str(os.getuid())
    from getpass import getuser

    return getuser()


def is_own(status: os.stat_result) -> bool:
    """Return True if a file belongs to this user, and on Windows.

    Files on Windows have no number of a user.
    """
    return not hasattr(os, "geteuid") or status.st_uid == os.geteuid()


def is_private(status: os.stat_result) -> bool:
    """Return True if no other user may write to a file or folder, and on Windows.

    On Windows the modes of files do not show this.
    """
    return is_own(status) and not (POSIX and status.st_mode & 0o022)


def is_running(process: int) -> bool:
    """Return True if a process with this number exists, or if this cannot be known.

    On Windows it cannot be known.
    """
    if not POSIX:  # where signal 0 is Ctrl-C
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        return True
    return True


def descriptor_path(file: IO[bytes]) -> str:
    """Return a path of an open file in ASCII, for libraries that accept only UTF-8 names.

    If the system has no such path, it is the file's own.
    """
    path = f"/proc/self/fd/{file.fileno()}"
    return path if os.path.exists(path) else str(file.name)


def path_for_others(file: IO[bytes]) -> str:
    """Return a path by which another process opens a file that this process has open.

    The path is valid even if the file has been renamed or removed. If the system has no such path, the result
    is the name of the file.
    """
    path = f"/proc/{os.getpid()}/fd/{file.fileno()}"
    return path if os.path.exists(path) else str(file.name)


def read_at(descriptor: int, size: int, offset: int) -> bytes:
    """Read up to `size` bytes from `offset` on, without moving the position in the file.

    May raise OSError.
    """
    if hasattr(os, "pread"):
        return os.pread(descriptor, size, offset)
    with _position:
        before = os.lseek(descriptor, 0, os.SEEK_CUR)
        os.lseek(descriptor, offset, os.SEEK_SET)
        try:
            return os.read(descriptor, size)
        finally:
            os.lseek(descriptor, before, os.SEEK_SET)


def write_at(descriptor: int, data: bytes, offset: int) -> None:
    """Write a few bytes at `offset`, without moving the position in the file. May raise OSError."""
    if hasattr(os, "pwrite"):
        os.pwrite(descriptor, data, offset)
        return
    with _position:
        before = os.lseek(descriptor, 0, os.SEEK_CUR)
        os.lseek(descriptor, offset, os.SEEK_SET)
        try:
            os.write(descriptor, data)
        finally:
            os.lseek(descriptor, before, os.SEEK_SET)


def rename_to_new(old: Path, new: Path) -> None:
    """Rename a file or folder without replacing one. Raises FileExistsError if the path exists."""
    if not POSIX:  # where this never replaces
        os.rename(old, new)
        return
    rename = getattr(ctypes.CDLL(None, use_errno=True), "renameat2", None)
    if rename and rename(_HERE, os.fsencode(old), _HERE, os.fsencode(new), _NO_REPLACE) == 0:
        return
    code = ctypes.get_errno() if rename else errno.ENOSYS
    if code not in (errno.ENOSYS, errno.EINVAL, errno.EOPNOTSUPP):
        raise OSError(code, os.strerror(code), str(new))
    # Not supported by this file system or C library: a new, empty one is replaced instead.
    if old.is_dir():
        new.mkdir()
    else:
        os.close(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
    os.replace(old, new)
