"""An archive to be read: a zip file, or the folder into which it was unpacked.

The archive may come from a stranger: only files inside it are opened, and no code of it is run.
"""

from __future__ import annotations

import csv
import json
import os
import random
import struct
import warnings
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from gaspart.errors import SceneError
from gaspart.files import open_regular
from gaspart.inspection.verdict import Check
from gaspart.interruption import scratch_folder
from gaspart.kernels.compile.cache import load_numba
from gaspart.reproduction.archive import tables
from gaspart.reproduction.archive.contents import leads_out, scene_files
from gaspart.reproduction.archive.digests import digest, digest_of_numbers, joint_digest
from gaspart.reproduction.archive.writing import MANIFEST
from gaspart.reproduction.config import open_config
from gaspart.reproduction.jobs.simulate import recipes, record
from gaspart.reproduction.points.point import TRAJECTORIES, Point
from gaspart.trajectory import provenance
from gaspart.yaml_text import parse_yaml, write_yaml

DAMAGE = (zipfile.BadZipFile, zlib.error, struct.error, EOFError, OSError, RuntimeError, ValueError)
"""Errors that may occur when a damaged file of an archive is read."""
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

    def read(self, name: str) -> bytes:
        """Return a file of the archive; raise SceneError if it is missing or damaged."""
        if name not in self.names:
            raise self.make_error(f"has no file {name}")
        try:
            with self.opener(name) as file:
                return file.read()
        except DAMAGE as error:
            raise self.make_error(f"has a damaged {name}: {_reason(error)}") from None

    def text(self, name: str) -> str:
        """Return a file of the archive as text; raise SceneError as `read`."""
        try:
            return self.read(name).decode()
        except UnicodeDecodeError as error:
            raise self.make_error(f"has a damaged {name}: {error}") from None

    def rows(self, name: str) -> list[dict[str, str]]:
        """Return the rows of a table."""
        return tables.rows_of(self.text(name))

    def digest(self, name: str) -> str:
        """Return the digest of a file; "" if it cannot be read."""
        try:
            with self.opener(name) as file:
                return digest(file)
        except DAMAGE:
            return ""

    def summary(self) -> dict[str, Any]:
        """Return the content of `run.json`."""
        return dict(json.loads(self.text(tables.RUN)))

    def manifest(self) -> dict[str, str]:
        """Return {path: digest} from the manifest; raise SceneError for a manifest of another form."""
        digests: dict[str, str] = {}
        for line in self.text(MANIFEST).split("\n")[:-1]:
            value, gap, name = line.partition("  ")
            if not gap or len(value) != _DIGITS or name in digests:
                raise self.make_error(f"has a {MANIFEST} that cannot be read")
            digests[name] = value
        return digests


def _reason(error: BaseException) -> str:
    return getattr(error, "strerror", None) or str(error) or type(error).__name__


@contextmanager
def opened_archive(path: str | Path) -> Iterator[Stored]:
    """Open an archive within the `with` block. Raises SceneError for a file that is no readable archive of
    gaspart, or has names that lead out of it.
    """
    path = Path(path)
    with ExitStack() as stack:
        try:
            stored = _folder(path) if path.is_dir() else _zip_file(path, stack)
        except zipfile.BadZipFile:
            raise SceneError("archive", str(path), "is no zip file, or one that is cut short") from None
        except DAMAGE as error:
            raise SceneError("archive", str(path), f"cannot be read: {_reason(error)}") from None
        if MANIFEST not in stored.names:
            raise stored.make_error(f"is no archive of gaspart: it has no {MANIFEST}")
        if wrong := sorted(filter(leads_out, stored.names)):
            raise stored.make_error(f"has a name that leads out of it: {wrong[0]}")
        yield stored


def _zip_file(path: Path, stack: ExitStack) -> Stored:
    file = stack.enter_context(zipfile.ZipFile(stack.enter_context(open_regular(path))))
    return Stored(path, frozenset(name for name in file.namelist() if not name.endswith("/")), file.open)


def _folder(path: Path) -> Stored:
    """Return an unpacked archive; a folder without a manifest is not searched."""
    there = os.walk(path) if (path / MANIFEST).is_file() else ()
    names = (Path(parent, name).relative_to(path).as_posix() for parent, _, files in there for name in files)
    return Stored(path, frozenset(names), lambda name: open_regular(path / name, follow=False))


# Points of an archive are simulated again, to compare their bits.


def chosen(stored: Stored, folder: Path, count: int) -> list[Point]:
    """Return `count` random points of an archive that have trajectories, or all if there are fewer. The
    points are planned again from the archive's config and scenes, which are written to `folder`. Raises
    SceneError if the config cannot be planned.
    """
    _write_config(stored, folder)
    listed = {(row["experiment"], row["point"]) for row in stored.rows(tables.POINTS)}
    with open_config(folder / "config/config.yaml") as (_, planned):
        points = [point for each in planned.values() for point in each.values()]
    points = [point for point in points if point.job == TRAJECTORIES]
    points = [point for point in points if (point.experiment, point.name) in listed]
    return random.sample(points, min(count, len(points)))


def _write_config(stored: Stored, folder: Path) -> None:
    """Write the config of an archive, and the scene files that it names, to a folder. Raises SceneError for a
    scene file that is not in the archive: the config of a stranger must not read files of this machine.
    """
    config = parse_yaml(stored.text(tables.CONFIG), tables.CONFIG)
    for name in scene_files(config):
        if name not in stored.names:
            raise stored.make_error(f"has a config with a scene that is not in the archive: {name}")
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(stored.read(name))
    (folder / "config").mkdir(exist_ok=True)
    # Only points are planned. A figure may have a module, and no code of a stranger is run.
    write_yaml(folder / "config/config.yaml", config | {"figures": {}, "animations": {}})


def rerun(stored: Stored, point: Point, folder: Path) -> Check:
    """Simulate all replicas of a point, and compare their digests with the archive's digests."""
    load_numba(ours=True)
    name = f"{point.experiment}/{point.name}"
    digests = {
        row["replica"]: row["numbers_sha256"]
        for row in stored.rows(tables.POINTS)
        if (row["experiment"], row["point"]) == (point.experiment, point.name)
    }
    other = []
    for replica, recipe in enumerate(recipes(**point.arguments)):
        output = folder / "again.nc"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # warnings of coarse settings, which the config has on purpose
            record(recipe, output, True)
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
    """Recompute the digests of an archive, and simulate some of its points again. The function yields a check
    for the files, the run, its claims and points, and for each of `points` points with trajectories, drawn at
    random. If files are damaged, checks that depend on them are left out. Raises SceneError if the file is no
    archive, or if a simulation raises it.
    """
    with opened_archive(path) as stored:
        stated = stored.manifest()
        files = _files(stored, stated)
        yield files
        if not files.passed:
            return
        try:
            checks = _tables(stored, stated)
        except (*DAMAGE, csv.Error, LookupError, TypeError, AttributeError) as error:
            rule = "has tables that cannot be read, though they have their digests"
            raise stored.make_error(f"{rule}: {error}") from None
        yield from checks
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


def _tables(stored: Stored, stated: Mapping[str, str]) -> list[Check]:
    """Return the checks of the tables; may raise any error for tables in another form."""
    run, points = stored.summary(), stored.rows(tables.POINTS)
    revision = f", revision {run['revision']}" if run["revision"] else ""
    about = f"{run['title']}; gaspart {run['gaspart']}{revision}; {run['archived'][:10]}"
    return [Check("run", True, about), _claims(stored, stated, run, points), _points(stored, points)]


def _claims(stored: Stored, stated: Mapping[str, str], run: Mapping, points: list[dict]) -> Check:
    """Check that each claim of the results is listed, with the digests of its data in the archive."""
    listed = stored.rows(tables.CLAIMS)
    judged = stored.rows(f"{run['results']}/tables/claims.csv")
    named = [tuple(row[key] for key in _JUDGED) for row in listed]
    if named != [tuple(row[key] for key in _JUDGED) for row in judged]:
        return Check("claims", False, f"{tables.CLAIMS} and the results list different claims")
    digests = dict(stated) | {row["path"]: row["sha256"] for row in points}
    data = {row["data"] for row in listed}
    joint = {name: joint_digest(tables.inputs_of(stored.read(name)), digests) for name in data}
    wrong = {
        row["figure"]
        for row in listed
        if row["data_sha256"] != stated.get(row["data"]) or row["inputs_sha256"] != joint[row["data"]]
    }
    if wrong:
        return Check("claims", False, f"made of other data: those of {_join_names(sorted(wrong))}")
    return Check("claims", True, f"{len(listed)}, made of {len(joint)} measurements with these digests")


def _points(stored: Stored, points: list[dict]) -> Check:
    """Check that the points in the archive have the digests that the table of points states."""
    rows = [row for row in points if row["path"] in stored.names]
    wrong = [row["path"] for row in rows if stored.digest(row["path"]) != row["sha256"]]
    text = f"other digests than in {tables.POINTS}: {_join_names(wrong)}" if wrong else f"{len(rows)} files"
    return Check("points", not wrong, text)
