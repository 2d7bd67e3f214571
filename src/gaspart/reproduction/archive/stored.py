"""An archive to be read: a zip file, or the folder into which it was unpacked.

The archive may come from a stranger. All names, kinds and sizes are checked before any content is read. Only
files inside the archive are opened.
"""

from __future__ import annotations

import io
import json
import os
import random
import shutil
import stat
import struct
import time
import warnings
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from gaspart.errors import SceneError
from gaspart.files import open_regular
from gaspart.inspection.verdict import Check
from gaspart.interruption import scratch_folder
from gaspart.kernels.compile.cache import load_numba
from gaspart.reproduction.archive import tables
from gaspart.reproduction.archive.contents import scene_files
from gaspart.reproduction.archive.limits import (
    MOST_BYTES,
    MOST_FILES,
    check_directory,
    check_layout,
    check_names,
    check_size,
    digest,
    digest_of_numbers,
    joint_digest,
)
from gaspart.reproduction.archive.tables import RUN, rows_of
from gaspart.reproduction.archive.writing import MANIFEST
from gaspart.reproduction.config import open_config
from gaspart.reproduction.jobs.simulate import recipes, record
from gaspart.reproduction.points.point import TRAJECTORIES, Point
from gaspart.trajectory import provenance
from gaspart.yaml_text import parse_yaml, write_yaml

DAMAGE = (
    *(zipfile.BadZipFile, zlib.error, struct.error, EOFError),
    *(OSError, RuntimeError, ValueError, OverflowError, MemoryError),
)
"""Errors that may occur when a damaged file of an archive is read."""
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_DIGITS = 64


@dataclass(frozen=True)
class Stored:
    """Archive: its path, the names of its files, and a function that opens a file."""

    path: Path
    names: frozenset[str]
    opener: Callable[[str], IO[bytes]]

    def make_error(self, rule: str) -> SceneError:
        """Return the error about this archive."""
        return SceneError("archive", str(self.path), rule)

    @contextmanager
    def open(self, name: str) -> Iterator[IO[bytes]]:
        """Open a file of the archive.

        Raises SceneError if the file is missing or damaged.
        """
        if name not in self.names:
            raise self.make_error(f"has no file {name}")
        try:
            with self.opener(name) as file:
                yield file
        except SceneError:
            raise
        except DAMAGE as error:
            raise self.make_error(f"has a damaged {name}: {_reason(error)}") from None

    def text(self, name: str, most: int = MOST_BYTES) -> str:
        """Read a file of at most `most` bytes as text.

        Raises SceneError if that fails.
        """
        with self.open(name) as file:
            content = file.read(most + 1)
            if len(content) > most:
                raise self.make_error(f"has a {name} of more than {most} bytes")
            return content.decode()

    def copy(self, name: str, target: Path) -> None:
        """Copy a file of the archive to the path `target`.

        Raises SceneError if that fails.
        """
        with self.open(name) as source, target.open("xb") as file:
            shutil.copyfileobj(source, file)

    def rows(self, name: str, columns: Sequence[str] = ()) -> list[dict[str, str]]:
        """Return the rows of a table that has at least these columns.

        Raises SceneError for another table.
        """
        text = self.text(name)
        try:
            return rows_of(text, columns)
        except ValueError as error:
            raise self.make_error(f"has a table that cannot be read, {name}: {error}") from None

    def digest(self, name: str) -> str:
        """Return the digest of a file; "" if it cannot be read."""
        try:
            with self.open(name) as file:
                return digest(file)
        except SceneError:
            return ""

    def summary(self) -> dict[str, Any]:
        """Return the content of `run.json`.

        Raises SceneError if a text that `verify` needs is missing.
        """
        text = self.text(RUN, 1 << 20)
        try:
            content = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise self.make_error(f"has a {RUN} that cannot be read: {error}") from None
        for key in ("title", "results", "gaspart", "revision", "archived"):
            if not (isinstance(content, dict) and isinstance(content.get(key), str)):
                raise self.make_error(f"has a {RUN} that does not state {key}, a text")
        return dict(content)

    def manifest(self) -> dict[str, str]:
        """Return {path: digest} from the manifest.

        Raises SceneError for a manifest of another form.
        """
        digests: dict[str, str] = {}
        for line in io.StringIO(self.text(MANIFEST)):
            value, gap, name = line.removesuffix("\n").partition("  ")
            if not gap or len(value) != _DIGITS or name in digests:
                raise self.make_error(f"has a {MANIFEST} that cannot be read")
            digests[name] = value
        return digests


def _reason(error: BaseException) -> str:
    return getattr(error, "strerror", None) or str(error) or type(error).__name__


@contextmanager
def opened_archive(path: str | Path) -> Iterator[Stored]:
    """Open an archive within the `with` block.

    Raises SceneError for a file that cannot be read, or that is no archive of gaspart. An archive has no
    equal names, no names that lead out of it, no unprintable names, no links, and no contents of unreasonable
    size.
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


def _require_manifest(stored: Stored) -> Stored:
    if MANIFEST not in stored.names:
        raise stored.make_error(f"is no archive of gaspart: it has no {MANIFEST}")
    stored.text(MANIFEST)
    return stored


def _zip_file(path: Path, source: IO[bytes]) -> Stored:
    size = os.fstat(source.fileno()).st_size
    check_directory(path, source)
    try:
        file = zipfile.ZipFile(source)
        check_layout(path, source, file)
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
    return _require_manifest(Stored(path, names, file.open))


def _check_entry(path: Path, entry: zipfile.ZipInfo) -> None:
    """Reject entries that `gaspart archive` does not write.

    Rejected are links and other special files, other compression methods, folders with contents, and names
    that programs interpret differently.
    """
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
    """Return an unpacked archive.

    A folder without a manifest is rejected before any other file is read.
    """
    if not (path / MANIFEST).is_file():
        raise SceneError("archive", str(path), f"is no archive of gaspart: it has no {MANIFEST}")
    names, stated, there = [], 0, 0
    for parent, folders, files in os.walk(path):
        for file in (Path(parent, name) for name in folders + files):
            status, name = file.lstat(), str(file.relative_to(path))
            if stat.S_ISDIR(status.st_mode):
                continue
            if not stat.S_ISREG(status.st_mode):
                raise SceneError("archive", str(path), f"has what is no regular file: {name}")
            names.append(name)
            stated, there = stated + status.st_size, there + 512 * status.st_blocks
            if len(names) > MOST_FILES:
                raise SceneError("archive", str(path), f"has more than {MOST_FILES} files")
    check_names(path, names)
    check_size(path, stated, there)
    return _require_manifest(
        Stored(path, frozenset(names), lambda name: open_regular(path / name, follow=False))
    )


# Points of an archive are simulated again, to compare their bits.


def chosen(stored: Stored, folder: Path, count: int) -> list[Point]:
    """Return `count` random points of an archive that have trajectories.

    If there are fewer such points, all are returned. The points are planned again from the archive's config
    and scenes, which are written to `folder`. Raises SceneError if the config cannot be planned.
    """
    _write_config(stored, folder)
    with open_config(folder / "config/config.yaml") as (_, planned):
        points = {
            (point.experiment, point.name): point for each in planned.values() for point in each.values()
        }
    rows = stored.rows(tables.POINTS, tables.PointFile._fields)
    listed = [*{(row["experiment"], row["point"]): None for row in rows if row["job"] == TRAJECTORIES}]
    drawn = random.sample(listed, min(count, len(listed)))
    missing = [f"{experiment}/{name}" for experiment, name in drawn if (experiment, name) not in points]
    if missing:
        raise SceneError("archive", str(stored.path), f"has a point that its config has not: {missing[0]}")
    return [points[key] for key in drawn]


def _write_config(stored: Stored, folder: Path) -> None:
    """Write the config of an archive, and the scene files that it names, to a folder.

    Raises SceneError for a scene file that is not in the archive: the config of a stranger must not read
    files of this machine.
    """
    config = parse_yaml(stored.text(tables.CONFIG), tables.CONFIG)
    for name in scene_files(config):
        if name not in stored.names:
            raise stored.make_error(f"has a config with a scene that is not in the archive: {name}")
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        stored.copy(name, target)
    (folder / "config").mkdir(exist_ok=True)
    # Only points are planned. A figure may have a module, and no code of a stranger is run.
    write_yaml(folder / "config/config.yaml", config | {"figures": {}, "animations": {}})


_LONGEST_RUN = 3600.0
"""Time of a trajectory, in seconds, after which it is not simulated further."""
_MOST_WRITTEN, _MOST_PARTICLES = 10**10, 10**7
"""Largest trajectory that is simulated again, in bytes and in particles."""


def rerun(stored: Stored, point: Point, folder: Path) -> Check:
    """Simulate all replicas of a point, and compare their digests with the archive's digests.

    Raises SceneError for a trajectory beyond the limits, which a stranger may have planned.
    """
    load_numba(ours=True)
    name = f"{point.experiment}/{point.name}"
    rows = stored.rows(tables.POINTS, tables.PointFile._fields)
    digests = {
        row["replica"]: row["numbers_sha256"]
        for row in rows
        if (row["experiment"], row["point"]) == (point.experiment, point.name)
    }
    other = []
    for replica, recipe in enumerate(recipes(**point.arguments)):
        output = folder / "again.nc"
        bytes_written = recipe.frames * recipe.layout.frame.itemsize
        if bytes_written > _MOST_WRITTEN or recipe.scene.count > _MOST_PARTICLES:
            size = f"{bytes_written:.3g} bytes of {recipe.scene.count} particles"
            most = f"{_MOST_WRITTEN:.0e} bytes and {_MOST_PARTICLES:.0e} particles"
            raise stored.make_error(f"has a point {name} of {size}; simulated are at most {most}")
        started = time.monotonic()

        def stop(*reached: float, started: float = started) -> None:
            if time.monotonic() - started > _LONGEST_RUN:
                rule = f"{_LONGEST_RUN:g} s: nothing is known of its bits"
                raise stored.make_error(f"has a point {name} with a trajectory that takes more than {rule}")

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # warnings of coarse settings, which the config has on purpose
            record(recipe, output, True, stop)
        if digest_of_numbers(output) != digests.get(str(replica)):
            other.append(str(replica))
        output.unlink()
    if not other:
        return Check("rerun", True, f"{name}: the same bits in each of its {point.replicas} trajectories")
    then = stored.summary()
    now = {"gaspart": provenance.versions()["gaspart_version"], "revision": provenance.git_revision()}
    differing = [
        f"{key} {then[key] or 'none'}, here {now[key] or 'none'}" for key in now if then[key] != now[key]
    ]
    difference = f" (archive: {'; '.join(differing)})" if differing else ""
    return Check("rerun", False, f"{name}: other bits in replica {', '.join(other)}{difference}")


# Verification of an archive: digests of its files, data of its claims, and points simulated again.


_JUDGED = ("figure", "claim", "verdict")
_NAMED = 3
"""Maximum number of files that a message lists."""


def verify(path: str | Path, points: int = 0) -> Iterator[Check]:
    """Recompute the digests of an archive, and simulate some of its points again.

    The archive is a zip file or an unpacked folder. The number `points` of points with trajectories are drawn
    at random. The function yields a check for the complete archive, its files, its claims, and each of these
    points. If files are damaged, checks that depend on them are left out.

    Raises SceneError if the file is no archive, or if a simulation raises it.
    """
    with opened_archive(path) as stored:
        stated = stored.manifest()
        files = _files(stored, stated)
        yield files
        if not files.passed:
            return
        yield from _tables(stored, stated)
        if points:
            with scratch_folder() as folder:
                for point in chosen(stored, folder, points):
                    yield rerun(stored, point, folder)


def _files(stored: Stored, stated: Mapping[str, str]) -> Check:
    """Check that the archive has the files of the manifest, with the same digests."""
    missing = sorted(stated.keys() - stored.names)
    unknown = sorted(stored.names - stated.keys() - {MANIFEST})
    changed = [name for name in sorted(stated.keys() & stored.names) if stored.digest(name) != stated[name]]
    faulty = {"missing": missing, "changed or damaged": changed, "not of the archive": unknown}
    faults = [f"{kind}: {_join_names(names)}" for kind, names in faulty.items() if names]
    return Check("files", not faults, "; ".join(faults) or f"{len(stated)} have the digests of {MANIFEST}")


def _join_names(names: list[str]) -> str:
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return ", ".join(names[:_NAMED]) + more


def _tables(stored: Stored, stated: Mapping[str, str]) -> Iterator[Check]:
    """Yield the checks of the tables.

    Raises SceneError if `gaspart archive` cannot have written a table, even if its digest is correct.
    """
    try:
        run = stored.summary()
        revision = f", revision {run['revision']}" if run["revision"] else ""
        about = f"{run['title']}; gaspart {run['gaspart']}{revision}; {run['archived'][:10]}"
        yield Check("run", True, about)  # this cannot fail
        yield _claims(stored, stated)
        yield _points(stored)
    except SceneError as error:
        rule = f"has tables that cannot be read, though they have their digests: it {error.rule}"
        raise stored.make_error(rule) from None
    except KeyError as error:
        raise stored.make_error(f"has claims made of a file that it does not list: {error.args[0]}") from None


def _claims(stored: Stored, stated: Mapping[str, str]) -> Check:
    """Check that each claim of the results is listed, with the digests of its data.

    The archive contains the data.
    """
    run, points = stored.summary(), stored.rows(tables.POINTS, tables.PointFile._fields)
    listed = stored.rows(tables.CLAIMS, tables.ClaimData._fields)
    judged = stored.rows(f"{run['results']}/tables/claims.csv", _JUDGED)
    named = [tuple(row[key] for key in _JUDGED) for row in listed]
    if named != [tuple(row[key] for key in _JUDGED) for row in judged]:
        return Check("claims", False, f"{tables.CLAIMS} and the results list different claims")
    digests = dict(stated) | {row["path"]: row["sha256"] for row in points}
    joint = {data: joint_digest(_inputs(stored, data), digests) for data in {row["data"] for row in listed}}
    wrong = {
        row["figure"]
        for row in listed
        if row["data_sha256"] != stated.get(row["data"]) or row["inputs_sha256"] != joint[row["data"]]
    }
    if wrong:
        return Check("claims", False, f"made of other data: those of {_join_names(sorted(wrong))}")
    return Check("claims", True, f"{len(listed)}, made of {len(joint)} measurements with these digests")


def _inputs(stored: Stored, name: str) -> list[str]:
    """Return the points, or tables of claims, from which a measurement in an archive is made."""
    with scratch_folder() as folder:
        copy = folder / "measurement.nc"
        stored.copy(name, copy)
        try:
            return tables.inputs_of(copy)
        except (OSError, RuntimeError, AttributeError, ValueError) as error:
            raise stored.make_error(f"has a measurement that cannot be read, {name}: {error}") from None


def _points(stored: Stored) -> Check:
    """Check that the points in the archive have the digests that the table of points states."""
    listed = stored.rows(tables.POINTS, tables.PointFile._fields)
    rows = [row for row in listed if row["path"] in stored.names]
    wrong = [row["path"] for row in rows if stored.digest(row["path"]) != row["sha256"]]
    text = f"other digests than in {tables.POINTS}: {_join_names(wrong)}" if wrong else f"{len(rows)} files"
    return Check("points", not wrong, text)
