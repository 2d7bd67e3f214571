"""Limits for archives: safe names, and sizes that are read in bounded time and memory."""

from __future__ import annotations

import hashlib
import os
import struct
from bisect import bisect_left as bisect
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import IO
from zipfile import ZipFile

from gaspart.errors import SceneError
from gaspart.trajectory.opening import open_netcdf_file

MOST_BYTES = 1 << 25
"""Maximum size of a manifest or a table, in bytes; tables of ten thousand points have a tenth of this size.
"""
MOST_ROWS = 200_000
MOST_FILES = 100_000
_DIRECTORY = 1 << 24
"""Maximum size of the list of entries at the end of a zip file, in bytes. Each entry takes about 100 bytes on
disk, and much more in memory."""
_EXPANSION, _ALWAYS = 200, 1 << 28
"""Maximum ratio of unpacked size to size on disk, and an unpacked size that is always allowed.

Tables and trajectories shrink by a factor of 10 at most. A malicious file that fills a disk, or never ends,
shrinks by a factor of a thousand.
"""
_LONGEST = 1024  # characters of a name
_LENGTHS, _DESCRIPTOR, _HAS_DESCRIPTOR = 26, 24, 8
"""Layout of the header of a zip entry.

The first number is the offset, in bytes, of the lengths of name and extra field; they end the header. The
second is the maximum size of a descriptor after the contents. The third is the flag that states that there is
a descriptor.
"""
_END, _END_64 = b"PK\x05\x06", b"PK\x06\x06"
_END_BYTES, _COMMENT = 22, (1 << 16) - 1


def name_fault(name: str) -> str:
    """Return the reason why a file of an archive cannot have this name, or ""."""
    parts = name.split("/")
    if not name.isprintable() or not name.strip():
        return "cannot be shown: it holds control characters, or bytes that are not UTF-8"
    if len(name) > _LONGEST:
        return f"has more than {_LONGEST} characters"
    if name.startswith("/") or "\\" in name or {"", ".", ".."} & {*parts}:
        return "leads out of it, or has two spellings"
    return ""


def check_names(path: Path, names: Iterable[str]) -> None:
    """Raise SceneError for names that cannot be unpacked into one folder.

    Names must not be equal, even if upper and lower case are ignored. A file must not be a folder as well. No
    name may have a `name_fault`. Names of folders end in "/".
    """
    seen: dict[str, str] = {}
    folders: set[str] = set()
    for entry in names:
        name = entry.removesuffix("/")
        if fault := name_fault(name):
            raise SceneError("archive", str(path), f"has a name that {fault}: {name}")
        key = name.casefold()
        if key in seen:
            rule = f"has two entries of one name: {name}" + (
                "" if seen[key] == name else f" and {seen[key]}, which are one file on some systems"
            )
            raise SceneError("archive", str(path), rule)
        seen[key] = name
        above = key.split("/")[: None if entry.endswith("/") else -1]
        folders.update("/".join(above[: n + 1]) for n in range(len(above)))
    for entry in names:
        if not entry.endswith("/") and entry.casefold() in folders:
            raise SceneError("archive", str(path), f"has a file that is also a folder: {entry}")


def check_size(path: Path, stated: int, there: int) -> None:
    """Raise SceneError if contents of `stated` bytes take implausibly few bytes on disk."""
    if stated > _ALWAYS + _EXPANSION * there:
        rule = f"has contents of {stated:.3g} bytes in {there:.3g}: no archive of gaspart is so compressed"
        raise SceneError("archive", str(path), rule)


def check_layout(path: Path, source: IO[bytes], file: ZipFile) -> None:
    """Raise SceneError unless the entries of a zip file lie without gaps, and nothing follows its end.

    Other programs might unpack data in the gaps. May raise struct.error for a truncated file.
    """
    at = gap = 0
    for entry in sorted(file.infolist(), key=lambda entry: entry.header_offset):
        if not at <= entry.header_offset <= at + gap:
            break
        contents = entry.header_offset + _LENGTHS + 4
        source.seek(entry.header_offset + _LENGTHS)
        at = contents + sum(struct.unpack("<HH", source.read(4))) + entry.compress_size
        gap = _DESCRIPTOR if entry.flag_bits & _HAS_DESCRIPTOR else 0
    else:
        source.seek(-_END_BYTES - len(file.comment), os.SEEK_END)
        if at <= file.start_dir <= at + gap and source.read().startswith(_END):
            return
    raise SceneError("archive", str(path), "has bytes that belong to no entry, or to two")


def check_directory(path: Path, file: IO[bytes]) -> None:
    """Raise SceneError for a zip file whose list of entries is too long.

    The reader loads the complete list into memory.
    """
    size = file.seek(0, os.SEEK_END)
    file.seek(max(0, size - _END_BYTES - _COMMENT - 56 - 20))
    tail = file.read()
    for mark, form, at in ((_END, "<I", 12), (_END_64, "<Q", 40)):
        offset = tail.find(mark)
        while offset >= 0:
            if offset + at + struct.calcsize(form) <= len(tail):
                (length,) = struct.unpack_from(form, tail, offset + at)
                if _DIRECTORY < length <= size:  # if the size exceeds the file, the zip reader reports it
                    raise SceneError("archive", str(path), "has a list of entries that is too long")
            offset = tail.find(mark, offset + 1)


# SHA-256 digests of files, of the numbers in a trajectory, and of sets of files.


_CHUNK = 1 << 20
_CHECKSUM = "checksum"
"""Variable of a trajectory that depends on the file's header, and therefore on versions and git revision."""


def digest(file: IO[bytes], copy: IO[bytes] | None = None) -> str:
    """Compute the digest of the rest of an open file.

    If `copy` is given, the rest is also written to `copy`.
    """
    total = hashlib.sha256()
    while data := file.read(_CHUNK):
        total.update(data)
        if copy is not None:
            copy.write(data)
    return total.hexdigest()


def digest_of_file(path: Path) -> str:
    """Return the digest of a file.

    May raise OSError.
    """
    with path.open("rb") as file:
        return digest(file)


def digest_of_numbers(path: Path) -> str:
    """Compute the digest of a trajectory's variables.

    Equal bits have equal digests, even if the attributes state different versions and git revisions. Each
    variable contributes its name, type, shape and bytes, in the order of the names. Raises SceneError for a
    file that is no trajectory of gaspart.
    """
    total = hashlib.sha256()
    with open_netcdf_file(path) as file:
        file.set_auto_mask(False)
        for name in sorted(file.variables.keys() - {_CHECKSUM}):
            values = file.variables[name][...]
            values = values.astype(values.dtype.newbyteorder("<"))
            total.update(f"{name} {values.dtype.str} {values.shape}\n".encode())
            total.update(values.tobytes())
    return total.hexdigest()


def joint_digest(paths: Iterable[str], digests: Mapping[str, str]) -> str:
    """Compute a joint digest of a set of files, from the lines "<digest> <path>".

    The lines are sorted by path.

    paths : files or folders; a folder represents all files of `digests` in it.
    digests : digest of each file.

    Raises KeyError for any other path.
    """
    lines: set[str] = set()
    names = sorted(digests)
    for path in paths:
        # in the order of characters, "0" follows "/"
        below = slice(bisect(names, f"{path}/"), bisect(names, f"{path}0"))
        files = [path] if path in digests else names[below]
        if not files:
            raise KeyError(path)
        lines |= {f"{name}\0{digests[name]}" for name in files}
    ordered = (line.split("\0") for line in sorted(lines))
    return hashlib.sha256("".join(f"{value}  {name}\n" for name, value in ordered).encode()).hexdigest()
