"""Writer of all results: files are complete and never replace files of other kinds."""

from __future__ import annotations

import errno
import fcntl
import hashlib
import os
import re
import secrets
import stat
import warnings
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from gaspart.errors import SceneError
from gaspart.interruption import scratch_file
from gaspart.system import is_own, is_running, rename_to_new

_SPECIAL_FILES = {stat.S_IFIFO: "a pipe", stat.S_IFSOCK: "a socket", stat.S_IFLNK: "a link"}
_SCRATCH = re.compile(r"\.gaspart-[0-9a-f]{12}-(\d+)-[0-9a-f]{8}\.partial")
"""Pattern of the name of a scratch file, which contains the number of the process that writes it."""

OVERWRITE = "overwrite it (overwrite=True)"
"""Remedy in the message about an existing file; the command line has its own option for it."""


@dataclass(frozen=True)
class FileKind:
    """Kind of result: name in messages, and a test of the content of a file."""

    name: str
    recognises: Callable[[Path], bool]


def begins_with(*beginnings: bytes, at: int = 0) -> Callable[[Path], bool]:
    """Return a test for one of several byte strings at a position in a file. `beginnings`: byte strings.
    `at`: offset from the start of the file.
    """

    def recognises(path: Path) -> bool:
        with open_regular(path) as file:
            file.seek(at)
            return file.read(max(map(len, beginnings))).startswith(beginnings)

    return recognises


def output_path(path: str | Path) -> Path:
    """Return `path` as the path of an output file. Raises SceneError if the path does not name a file ("",
    "a/", ".").
    """
    text = os.fspath(path)
    if os.path.basename(text) in ("", ".", "..") or "\0" in text:
        raise SceneError("path", text, "must be the name of a file")
    return Path(text)


def open_regular(path: str | Path, follow: bool = True) -> BinaryIO:
    """Open a file for reading; all input is opened by this function. Raises OSError for a folder, pipe,
    socket or device, because reading from it could block or never end. Unless `follow` is True, OSError is
    also raised for a link. Raises ValueError for a name that contains a NUL.
    """
    _require_regular(os.stat(path, follow_symlinks=follow), path)  # opening some devices has side effects
    flags = os.O_NONBLOCK | (0 if follow else os.O_NOFOLLOW)
    file = open(path, "rb", opener=lambda name, mode: os.open(name, mode | flags))  # noqa: SIM115
    try:
        _require_regular(os.fstat(file.fileno()), path)
    except OSError:
        file.close()
        raise
    return file


def _require_regular(status: os.stat_result, path: str | Path) -> None:
    """Raise OSError for anything that is not a regular file."""
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(status.st_mode):
        kind = _SPECIAL_FILES.get(stat.S_IFMT(status.st_mode), "a device")
        raise OSError(errno.EINVAL, f"it is {kind}, not a regular file", str(path))


def resolve_path(path: str | Path) -> Path:
    """Return the absolute path without links, for any path. `Path.resolve` fails for circular links."""
    try:
        return Path(os.path.realpath(path))
    except ValueError:  # the name contains a NUL, which `open` rejects
        return Path(path)


def is_same_file(path: str | Path, other: str | Path) -> bool:
    """Return True if two paths refer to the same file, also through links and other spellings. The result is
    False if a file does not exist.
    """
    try:
        return os.path.samefile(path, other)
    except (OSError, ValueError):
        return False


def may_replace(path: Path, kind: FileKind | None, overwrite: bool) -> bool:
    """Return True if `path` exists and a result may replace it. Return False if there is no file. Raises
    SceneError for a folder, link or device, for a file of another kind (None: any kind), and, without
    `overwrite`, for any file. An empty file counts as any kind. May raise OSError.
    """
    try:
        status = path.lstat()
    except FileNotFoundError:
        return False
    if not stat.S_ISREG(status.st_mode):
        raise SceneError("path", str(path), "must be a regular file: not a folder, a link or a device")
    if status.st_size and kind is not None and not kind.recognises(path):
        rule = f"exists and is not {kind.name}; move it away, or choose another name"
        raise SceneError("path", str(path), rule)
    if not overwrite:
        raise SceneError("path", str(path), f"exists; move it away, or {OVERWRITE}")
    return True


def place(scratch: Path, path: Path, kind: FileKind | None, overwrite: bool) -> None:
    """Rename `scratch` to `path` atomically, if `may_replace` still permits it. May raise OSError."""
    while True:
        if may_replace(path, kind, overwrite):
            return os.replace(scratch, path)
        with suppress(FileExistsError):  # another process wrote it: apply `may_replace`
            return rename_to_new(scratch, path)


def remove_own(path: Path, kind: FileKind) -> None:
    """Remove a file of this kind, identified by its content, and scratch files of killed processes. No other
    file is removed, and no link or folder. May raise OSError.
    """
    _remove_remainders(path)
    with suppress(FileNotFoundError, SceneError):
        if may_replace(path, kind, overwrite=True):
            path.unlink()


def place_folder(scratch: Path, path: Path) -> None:
    """Rename a folder to `path`, which must not exist. Raises FileExistsError, and other OSErrors."""
    rename_to_new(scratch, path)


@contextmanager
def writing(path: str | Path, kind: FileKind | None = None, overwrite: bool = False) -> Iterator[Path]:
    """Provide a scratch file, and rename it to `path` atomically on success. `may_replace` is applied before
    the block and again at its end. The scratch file is in the folder of `path` and has a unique name. It is
    removed if writing fails. After a kill, the next attempt removes it. Raises SceneError under the
    conditions of `output_path` and `may_replace`, and for a missing folder or a full disk.
    """
    path = output_path(path)
    try:
        may_replace(path, kind, overwrite)
        with scratch_beside(path) as scratch:
            yield scratch
            with scratch.open("rb") as file:
                os.fsync(file.fileno())
            place(scratch, path, kind, overwrite)
    except OSError as error:
        reason = error.strerror or "its writer has stopped"
        raise SceneError("path", str(path), f"cannot be written: {reason}") from None
    except UnicodeEncodeError:  # raised by libraries that accept only UTF-8 names
        rule = "cannot be written: the name of its folder must be UTF-8"
        raise SceneError("path", str(path), rule) from None


def whole_file(path: str | Path) -> AbstractContextManager[Path]:
    """Apply `writing` to an output of the workflow, which may replace any file."""
    return writing(path, overwrite=True)


@contextmanager
def scratch_beside(path: Path) -> Iterator[Path]:
    """Create a scratch file next to `path` for this process, and remove it at the end."""
    _remove_remainders(path)
    scratch = path.with_name(f"{_beginning(path)}{os.getpid()}-{secrets.token_hex(4)}.partial")
    with scratch_file(scratch):
        os.close(os.open(scratch, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
        try:
            yield scratch
        finally:
            scratch.unlink(missing_ok=True)


def _beginning(path: Path) -> str:
    """Return the first part of the names of scratch files for `path` on this machine."""
    of = hashlib.sha256(os.fsencode(path.name) + os.uname().nodename.encode()).hexdigest()[:12]
    return f".gaspart-{of}-"


def _remove_remainders(path: Path) -> None:
    """Remove the scratch files of killed processes of this user for `path`."""
    for old in path.parent.glob(f"{_beginning(path)}*.partial"):
        with suppress(OSError):
            if is_remainder(old):
                old.unlink()


def is_remainder(path: Path) -> bool:
    """Return True for a scratch file of a process of this user that has ended."""
    name = _SCRATCH.fullmatch(path.name)
    if name is None or is_running(int(name[1])):
        return False
    status = path.lstat()
    return stat.S_ISREG(status.st_mode) and status.st_nlink == 1 and is_own(status)


_LOCK = FileKind("a lock", lambda path: False)  # an empty file, which counts as any kind
_NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.EINVAL)
"""Errors of a file system without locks, such as some network disks."""


@contextmanager
def only_process(path: Path, wait: bool = False) -> Iterator[None]:
    """Hold the lock of a path, so that no other process holds it within the block. The lock is the file
    `path`.lock. The system releases it whenever the process ends. On a file system without locks there is a
    warning and no lock. Raises BlockingIOError if another process holds the lock, unless `wait` is set.
    Raises SceneError if a file of this name is not a lock. May raise OSError.
    """
    file = path.with_name(f"{path.name}.lock")
    may_replace(file, _LOCK, overwrite=True)
    descriptor = _lock(file, wait)
    try:
        with scratch_file(file):
            yield
    finally:
        with suppress(OSError):
            file.unlink()  # before the release: another process may then hold the lock
        os.close(descriptor)


def _lock(file: Path, wait: bool) -> int:
    """Open and lock a file, and return its descriptor."""
    while True:
        descriptor = os.open(file, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except OSError as error:
            if error.errno in _NO_LOCKS:
                rule = f"cannot be locked ({error.strerror}): do not let two processes write it"
                warnings.warn(f"gaspart: {file.with_suffix('')}: {rule}", stacklevel=4)
                return descriptor
            os.close(descriptor)
            raise
        if os.fstat(descriptor).st_nlink:
            return descriptor
        os.close(descriptor)  # its former holder has removed it
