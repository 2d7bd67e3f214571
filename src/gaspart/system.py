"""Differences between Linux and macOS.

Other modules use this module, and otherwise only functions that exist on both systems. The code was not run
on macOS.
"""

from __future__ import annotations

import ctypes
import errno
import os
import resource
import sys
from pathlib import Path

TYPE_CHECKING = False
if TYPE_CHECKING:  # this module is imported before signals are handled, so it must not import slowly
    from typing import IO

_HERE, _NO_REPLACE = -100, 1
"""AT_FDCWD and RENAME_NOREPLACE of Linux's renameat2."""


def memory() -> int | None:
    """Return the memory of this machine in bytes; None if it is unknown."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (ValueError, OSError):
        return None


def largest_memory() -> float:
    """Return the peak memory of this process in bytes."""
    unit = 1 if sys.platform == "darwin" else 1024
    return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)


def user() -> str:
    """Return a short name of this user, for a folder next to other users' folders."""
    return str(os.getuid())


def is_own(status: os.stat_result) -> bool:
    """Return True if a file belongs to this user."""
    return status.st_uid == os.geteuid()


def is_private(status: os.stat_result) -> bool:
    """Return True if a file or folder belongs to this user, and no other user may write to it."""
    return is_own(status) and not status.st_mode & 0o022


def is_running(process: int) -> bool:
    """Return True if a process with this number exists."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        return True
    return True


def python_with_this_package(code: str) -> list[str]:
    """Return arguments of the interpreter that run code with this copy of the package. Nothing is imported
    from the working folder (-P), where a user's file may have the name of a module.
    """
    folder = str(Path(__file__).parents[1])
    found = f"import sys; sys.path.insert(0, {folder!r}); import gaspart; del sys.path[0]"
    return ["-P", "-c", f"{found}; {code}"]


def descriptor_path(file: IO[bytes]) -> str:
    """Return an ASCII path of an open file, for libraries that accept only UTF-8 names. If the system has no
    such path, return the path of the file itself.
    """
    path = f"/proc/self/fd/{file.fileno()}"
    return path if os.path.exists(path) else str(file.name)


def path_for_others(file: IO[bytes]) -> str:
    """Return a path with which another process can open a file that this process has open. The path remains
    valid if the file is renamed or removed. If the system has no such path, return the name of the file.
    """
    path = f"/proc/{os.getpid()}/fd/{file.fileno()}"
    return path if os.path.exists(path) else str(file.name)


def rename_to_new(old: Path, new: Path) -> None:
    """Rename a file or folder without replacing an existing one. Raises FileExistsError if the path
    exists.
    """
    rename = getattr(ctypes.CDLL(None, use_errno=True), "renameat2", None)
    if rename and rename(_HERE, os.fsencode(old), _HERE, os.fsencode(new), _NO_REPLACE) == 0:
        return
    code = ctypes.get_errno() if rename else errno.ENOSYS
    if code not in (errno.ENOSYS, errno.EINVAL, errno.EOPNOTSUPP):
        raise OSError(code, os.strerror(code), str(new))
    # Not supported by this file system or C library: a new, empty file or folder is replaced instead.
    if old.is_dir():
        new.mkdir()
    else:
        os.close(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
    os.replace(old, new)
