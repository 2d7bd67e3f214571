"""An archive that is read: a zip file, or the folder into which one was unpacked."""

from __future__ import annotations

import json
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from gaspart.errors import SceneError
from gaspart.reproduction.archive.digests import digest
from gaspart.reproduction.archive.tables import RUN, rows_of
from gaspart.reproduction.archive.writing import MANIFEST

DAMAGE = (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, UnicodeDecodeError)
"""What reading a damaged file of an archive may raise."""


@dataclass(frozen=True)
class Stored:
    """An archive: where it is, the names of its files, and how one is opened."""

    path: Path
    names: frozenset[str]
    open: Callable[[str], IO[bytes]]

    def text(self, name: str) -> str:
        """A file as text. Raises KeyError or FileNotFoundError if it is missing, and DAMAGE."""
        with self.open(name) as file:
            return file.read().decode()

    def rows(self, name: str) -> list[dict[str, str]]:
        """The rows of a table."""
        return rows_of(self.text(name))

    def digest(self, name: str) -> str:
        """The digest of a file; "" if it cannot be read."""
        try:
            with self.open(name) as file:
                return digest(file)
        except DAMAGE:
            return ""

    def summary(self) -> dict[str, Any]:
        """What `run.json` states."""
        return json.loads(self.text(RUN))

    def manifest(self) -> dict[str, str]:
        """{path: digest} as the manifest states them. Raises SceneError for another text."""
        found = {}
        for line in self.text(MANIFEST).splitlines():
            value, gap, name = line.partition("  ")
            if not gap or len(value) != 64:
                raise SceneError("archive", str(self.path), f"has a {MANIFEST} that cannot be read")
            found[name] = value
        return found


@contextmanager
def opened_archive(path: str | Path) -> Iterator[Stored]:
    """An archive, open within the `with` block.

    Raises SceneError for a file that cannot be read, or that is no archive of gaspart.
    """
    path = Path(path)
    if path.is_dir():
        yield _checked(Stored(path, _names_below(path), lambda name: (path / name).open("rb")))
        return
    try:
        file = zipfile.ZipFile(path)
    except OSError as error:
        raise SceneError("archive", str(path), f"cannot be read: {error.strerror or error}") from None
    except zipfile.BadZipFile:
        raise SceneError("archive", str(path), "is no zip file, or one that is cut short") from None
    with file:
        names = frozenset(name for name in file.namelist() if not name.endswith("/"))
        yield _checked(Stored(path, names, file.open))


def _checked(stored: Stored) -> Stored:
    if MANIFEST not in stored.names:
        rule = f"is no archive of gaspart: it has no {MANIFEST}"
        raise SceneError("archive", str(stored.path), rule)
    try:
        stored.text(MANIFEST)
    except DAMAGE:
        raise SceneError("archive", str(stored.path), f"has a damaged {MANIFEST}") from None
    return stored


def _names_below(folder: Path) -> frozenset[str]:
    return frozenset(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())
