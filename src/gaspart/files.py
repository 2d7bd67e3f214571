"""Writer of all results: complete files, which replace no files of other kinds."""

from __future__ import annotations

import errno
import hashlib
import os
import re
import secrets
import socket
import stat
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from gaspart.errors import SceneError
from gaspart.interruption import scratch_file
from gaspart.system import NO_LINK, OPEN_AS_IT_IS, is_own, is_running, rename_to_new

_SPECIAL_FILES = {stat.S_IFIFO: "a pipe", stat.S_IFSOCK: "a socket", stat.S_IFLNK: "a link"}
_SCRATCH = re.compile(r"\.gaspart-[0-9a-f]{12}-(\d+)-[0-9a-f]{8}\.partial")
"""Name of a scratch file, with the number of the process that writes it."""

OVERWRITE = "overwrite it (overwrite=True)"
"""Remedy in the message about a file that exists; the command line has its own option for it."""


@dataclass(frozen=True)
class FileKind:
    """Kind of result: its name in messages, and a test of a file's content."""

    name: str
    recognises: Callable[[Path], bool]


def begins_with(*beginnings: bytes, at: int = 0) -> Callable[[Path], bool]:
    """Return a test whether a file has one of some byte strings at a position.

    beginnings : byte strings
    at : offset from the start of the file
    """

    def recognises(path: Path) -> bool:
        with open_regular(path) as file:
            file.seek(at)
            return file.read(max(map(len, beginnings))).startswith(beginnings)

    return recognises


def output_path(path: str | Path) -> Path:
    """Return `path` as the path of a file to be written.

    Raises SceneError if it names no file ("", "a/", ".").
    """
    text = os.fspath(path)
    if os.path.basename(text) in ("", ".", "..") or "\0" in text:
        raise SceneError("path", text, "must be the name of a file")
    return Path(text)


def open_regular(path: str | Path, follow: bool = True) -> BinaryIO:
    """Open a file to read; this function opens all input.

    Raises OSError for a folder, pipe, socket or device, because reading could block or never end, and without
    `follow` for a link; ValueError for a name that contains a NUL.
    """
    _require_regular(os.stat(path, follow_symlinks=follow), path)  # before: some devices act when opened
    flags = OPEN_AS_IT_IS | (0 if follow else NO_LINK)
    file = open(path, "rb", opener=lambda name, mode: os.open(name, mode | flags))  # noqa: SIM115
    try:
        _require_regular(os.fstat(file.fileno()), path)
    except OSError:
        file.close()
        raise
    return file


def _require_regular(status: os.stat_result, path: str | Path) -> None:
    """Raise OSError for what is no regular file."""
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(status.st_mode):
        kind = _SPECIAL_FILES.get(stat.S_IFMT(status.st_mode), "a device")
        raise OSError(errno.EINVAL, f"it is {kind}, not a regular file", str(path))


def resolve_path(path: str | Path) -> Path:
    """Return the absolute path without links, for any path.

    `Path.resolve` fails for links in a circle.
    """
    try:
        return Path(os.path.realpath(path))
    except ValueError:  # a NUL in it, which opening refuses
        return Path(path)


def is_same_file(path: str | Path, other: str | Path) -> bool:
    """Return True if two names are names of one file, also through links and other spellings.

    The result is False if a file does not exist.
    """
    try:
        return os.path.samefile(path, other)
    except (OSError, ValueError):
        return False


def may_replace(path: Path, kind: FileKind | None, overwrite: bool) -> bool:
    """Return True if there is a file at `path` that a result may replace.

    Returns False without a file. Raises SceneError for a folder, link or device, a file of another kind
    (None: any kind), and, without `overwrite`, any file. An empty file is of every kind. May raise OSError.
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
    """Rename `scratch` to `path`, atomically, if `may_replace` still allows it. May raise OSError."""
    while True:
        if may_replace(path, kind, overwrite):
            return os.replace(scratch, path)
        with suppress(FileExistsError):  # another process wrote it meanwhile: apply `may_replace` to it
            return rename_to_new(scratch, path)


def remove_own(path: Path, kind: FileKind) -> None:
    """Remove a file of this kind, by its content, and the remainders of a killed process.

    No other file is removed, and no link or folder. May raise OSError.
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
    """Provide a scratch file to write to, and rename it to `path` atomically on success.

    `may_replace` is applied before the work and again at its end. The scratch file is in the folder of `path`
    and has a unique name. It is removed if writing fails; after a kill the next attempt removes it.

    Raises SceneError as `output_path` and `may_replace` do, and for a missing folder, a full disk and the
    like.
    """
    path = output_path(path)
    try:
        may_replace(path, kind, overwrite)
        with scratch_beside(path) as scratch:
            yield scratch
            with scratch.open("r+b") as file:  # Windows syncs no file that is open to read only
                os.fsync(file.fileno())
            place(scratch, path, kind, overwrite)
    except OSError as error:
        reason = error.strerror or "its writer has stopped"
        raise SceneError("path", str(path), f"cannot be written: {reason}") from None
    except UnicodeEncodeError:  # raised by a library that accepts UTF-8 names only
        rule = "cannot be written: the name of its folder must be UTF-8"
        raise SceneError("path", str(path), rule) from None


def whole_file(path: str | Path) -> AbstractContextManager[Path]:
    """Perform `writing` for an output of the workflow, which may replace any file."""
    return writing(path, overwrite=True)


@contextmanager
def scratch_beside(path: Path) -> Iterator[Path]:
    """Make a new file next to `path` for this process, and remove it at the end."""
    _remove_remainders(path)
    scratch = path.with_name(f"{_beginning(path)}{os.getpid()}-{secrets.token_hex(4)}.partial")
    with scratch_file(scratch):
        os.close(os.open(scratch, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
        try:
            yield scratch
        finally:
            scratch.unlink(missing_ok=True)


def _beginning(path: Path) -> str:
    """Return the beginning of the names of scratch files for `path` on this machine."""
    of = hashlib.sha256(os.fsencode(path.name) + socket.gethostname().encode()).hexdigest()[:12]
    return f".gaspart-{of}-"


def _remove_remainders(path: Path) -> None:
    """Remove the scratch files that killed processes of this user have left for `path`."""
    for old in path.parent.glob(f"{_beginning(path)}*.partial"):
        with suppress(OSError):
            if is_remainder(old):
                old.unlink()


def is_remainder(path: Path) -> bool:
    """Return True for a scratch file that an ended process of this user has left."""
    name = _SCRATCH.fullmatch(path.name)
    if name is None or is_running(int(name[1])):
        return False
    status = path.lstat()
    return stat.S_ISREG(status.st_mode) and status.st_nlink == 1 and is_own(status)


def _is_lock(path: Path) -> bool:
    """Return True for a lock of filelock where a file system has no locks.

    The name begins with the number of a process.
    """
    with open_regular(path) as file:
        return file.read(1).isdigit()


_LOCK = FileKind("a lock", _is_lock)


@contextmanager
def only_process(path: Path, wait: bool = False) -> Iterator[None]:
    """Hold the lock of a path, so that no other process has it within the block.

    The lock is the file `path`.lock, which the system releases when the process ends, however it does. Raises
    BlockingIOError while another process has the lock, unless `wait` is set; SceneError for a file of that
    name that is no lock. May raise OSError.
    """
    from filelock import FileLock, Timeout  # 0.3 s

    file = path.with_name(f"{path.name}.lock")
    may_replace(file, _LOCK, overwrite=True)
    lock = FileLock(file)
    try:
        lock.acquire(blocking=wait)
    except Timeout:
        raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN), str(file)) from None
    with scratch_file(file):
        try:
            yield
        finally:
            with suppress(OSError):  # Windows removes no open file, but when it is released
                file.unlink()  # before the release: no other process may hold it then
            lock.release()
