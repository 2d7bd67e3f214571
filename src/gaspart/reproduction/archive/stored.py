"""An archive that is read: a zip file, or the folder into which one was unpacked.

It may come from a stranger. What it holds is checked by its names, kinds and sizes before anything of it is
read, and only files that are in it are ever opened.
"""

from __future__ import annotations

import io
import json
import os
import shutil
import stat
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from gaspart.errors import SceneError
from gaspart.files import open_regular
from gaspart.reproduction.archive.digests import digest
from gaspart.reproduction.archive.limits import (
    MOST_BYTES,
    MOST_FILES,
    check_directory,
    check_names,
    check_places,
    check_size,
)
from gaspart.reproduction.archive.tables import RUN, rows_of
from gaspart.reproduction.archive.writing import MANIFEST

DAMAGE = (
    *(zipfile.BadZipFile, zlib.error, struct.error, EOFError),
    *(OSError, RuntimeError, ValueError, OverflowError, MemoryError),
)
"""Errors that reading a damaged file of an archive may raise."""
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_STATED = ("title", "results", "gaspart", "revision", "archived")
_DIGITS = 64


@dataclass(frozen=True)
class Stored:
    """An archive: where it is, the names of its files, and how one of these is opened."""

    path: Path
    names: frozenset[str]
    opener: Callable[[str], IO[bytes]]

    def refused(self, rule: str) -> SceneError:
        """The error about this archive."""
        return SceneError("archive", str(self.path), rule)

    def open(self, name: str) -> IO[bytes]:
        """A file of the archive. Raises SceneError for another name, and DAMAGE."""
        if name not in self.names:
            raise self.refused(f"has no file {name}")
        return self.opener(name)

    def text(self, name: str, most: int = MOST_BYTES) -> str:
        """A file as text. Raises SceneError for one that is missing, damaged, or larger than `most` bytes."""
        try:
            with self.open(name) as file:
                content = file.read(most + 1)
            if len(content) > most:
                raise self.refused(f"has a {name} of more than {most} bytes")
            return content.decode()
        except SceneError:
            raise
        except DAMAGE as error:
            raise self.refused(f"has a damaged {name}: {_reason(error)}") from None

    def copy(self, name: str, target: Path) -> None:
        """Write a file to `target`. Raises SceneError for one that is missing or damaged."""
        try:
            with self.open(name) as source, target.open("xb") as file:
                shutil.copyfileobj(source, file)
        except SceneError:
            raise
        except DAMAGE as error:
            raise self.refused(f"has a damaged {name}: {_reason(error)}") from None

    def rows(self, name: str, columns: Sequence[str] = ()) -> list[dict[str, str]]:
        """The rows of a table that has at least these columns. Raises SceneError."""
        try:
            return rows_of(self.text(name), columns)
        except SceneError:
            raise
        except ValueError as error:
            raise self.refused(f"has a table that cannot be read, {name}: {error}") from None

    def digest(self, name: str) -> str:
        """The digest of a file; "" if it cannot be read."""
        try:
            with self.open(name) as file:
                return digest(file)
        except DAMAGE:
            return ""

    def summary(self) -> dict[str, Any]:
        """The content of `run.json`, of which `verify` uses texts. Raises SceneError for another content."""
        try:
            found = json.loads(self.text(RUN, 1 << 20))
        except RecursionError:
            raise self.refused(f"has a {RUN} that is nested too deep") from None
        except ValueError as error:
            if isinstance(error, SceneError):
                raise
            raise self.refused(f"has a {RUN} that cannot be read: {error}") from None
        for key in _STATED:
            if not (isinstance(found, dict) and isinstance(found.get(key), str)):
                raise self.refused(f"has a {RUN} that does not state {key}, a text")
        return dict(found)

    def manifest(self) -> dict[str, str]:
        """{path: digest} as the manifest states them. Raises SceneError for another text."""
        found: dict[str, str] = {}
        for line in io.StringIO(self.text(MANIFEST)):
            value, gap, name = line.removesuffix("\n").partition("  ")
            if not gap or len(value) != _DIGITS or name in found:
                raise self.refused(f"has a {MANIFEST} that cannot be read")
            found[name] = value
        return found


def _reason(error: BaseException) -> str:
    return getattr(error, "strerror", None) or str(error) or type(error).__name__


@contextmanager
def opened_archive(path: str | Path) -> Iterator[Stored]:
    """An archive, open within the `with` block.

    Raises SceneError for a file that cannot be read, or that is no archive of gaspart: one with two entries
    of one name, names that lead out of it or cannot be shown, links, or contents of unreasonable size.
    """
    path = Path(path)
    try:
        if path.is_dir():
            yield _folder(path)
            return
        source = open_regular(path)
    except (OSError, ValueError) as error:
        if isinstance(error, SceneError):
            raise
        raise SceneError("archive", str(path), f"cannot be read: {_reason(error)}") from None
    with source:
        yield _zip_file(path, source)


def _checked(stored: Stored) -> Stored:
    if MANIFEST not in stored.names:
        raise stored.refused(f"is no archive of gaspart: it has no {MANIFEST}")
    stored.text(MANIFEST)
    return stored


def _zip_file(path: Path, source: IO[bytes]) -> Stored:
    size = os.fstat(source.fileno()).st_size
    check_directory(path, source)
    try:
        file = zipfile.ZipFile(source)
        check_places(path, source, file.infolist(), file.start_dir)
    except SceneError:
        raise
    except DAMAGE:
        raise SceneError("archive", str(path), "is no zip file, or one that is cut short") from None
    entries = file.infolist()
    for entry in entries:
        _check_entry(path, entry)
    check_names(path, [entry.orig_filename for entry in entries])
    check_size(path, sum(entry.file_size for entry in entries), size)
    names = frozenset(entry.filename for entry in entries if not entry.is_dir())
    return _checked(Stored(path, names, file.open))


def _check_entry(path: Path, entry: zipfile.ZipInfo) -> None:
    """Refuse what `gaspart archive` does not write: links and the like, other compressions, folders with
    contents, and names that readers take for different ones."""
    kind = stat.S_IFMT(entry.external_attr >> 16)
    rule = ""
    if entry.is_dir():
        if entry.file_size or kind not in (0, stat.S_IFDIR):
            rule = "is a folder with contents, or a link"
    elif kind not in (0, stat.S_IFREG):
        rule = "is no regular file"
    elif entry.compress_type not in _METHODS:
        rule = f"is compressed by another method than deflate: {entry.compress_type}"
    if rule:
        raise SceneError("archive", str(path), f"has an entry, {entry.filename}, that {rule}")


def _folder(path: Path) -> Stored:
    """An unpacked archive. Only if it has a manifest is anything else in it looked at."""
    if not (path / MANIFEST).is_file():
        raise SceneError("archive", str(path), f"is no archive of gaspart: it has no {MANIFEST}")
    names, stated, there = [], 0, 0
    for name, found in _below(path, ""):
        if not stat.S_ISREG(found.st_mode):
            raise SceneError("archive", str(path), f"has what is no regular file: {name}")
        names.append(name)
        stated, there = stated + found.st_size, there + 512 * found.st_blocks
        if len(names) > MOST_FILES:
            raise SceneError("archive", str(path), f"has more than {MOST_FILES} files")
    check_names(path, names)
    check_size(path, stated, there)
    return _checked(Stored(path, frozenset(names), lambda name: open_regular(path / name, follow=False)))


def _below(folder: Path, beginning: str) -> Iterable[tuple[str, os.stat_result]]:
    """All that is in a folder and below and is no folder, by its name from `beginning` on; links are not
    followed."""
    with os.scandir(folder) as entries:
        for entry in entries:
            name = beginning + entry.name
            if entry.is_dir(follow_symlinks=False):
                yield from _below(folder / entry.name, f"{name}/")
            else:
                yield name, entry.stat(follow_symlinks=False)
