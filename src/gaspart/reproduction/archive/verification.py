"""Verification of an archive: digests of its files, data of its claims, and points simulated again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from gaspart.errors import SceneError
from gaspart.inspection.verdict import Check
from gaspart.reproduction.archive import tables
from gaspart.reproduction.archive.digests import joint_digest
from gaspart.reproduction.archive.rerun import chosen, rerun
from gaspart.reproduction.archive.stored import Stored, opened_archive
from gaspart.reproduction.archive.writing import MANIFEST

_JUDGED = ("figure", "claim", "verdict")
_NAMED = 3
"""How many files a message names."""


def verify(path: str | Path, points: int = 0) -> Iterator[Check]:
    """Recompute the digests of an archive, a zip file or an unpacked one, and simulate points again.

    points: how many of the points that have trajectories, drawn at random. Gives a check for the archive as
    a whole, its files, its claims, and each of these points. If files are damaged, nothing that follows from
    them is checked.

    Raises SceneError for what is no archive, and as simulations do.
    """
    with opened_archive(path) as stored:
        stated = stored.manifest()
        files = _files(stored, stated)
        yield files
        if not files.passed:
            return
        yield from _tables(stored, stated)
        if points:
            with TemporaryDirectory(prefix="gaspart-") as folder:
                for point in chosen(stored, Path(folder), points):
                    yield rerun(stored, point, Path(folder))


def _files(stored: Stored, stated: Mapping[str, str]) -> Check:
    """Whether the files are those of the manifest, with their digests."""
    missing = sorted(stated.keys() - stored.names)
    unknown = sorted(stored.names - stated.keys() - {MANIFEST})
    changed = [name for name in sorted(stated.keys() & stored.names) if stored.digest(name) != stated[name]]
    found = {"missing": missing, "changed or damaged": changed, "not of the archive": unknown}
    faults = [f"{what}: {_shown(names)}" for what, names in found.items() if names]
    return Check("files", not faults, "; ".join(faults) or f"{len(stated)} have the digests of {MANIFEST}")


def _shown(names: list[str]) -> str:
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return ", ".join(names[:_NAMED]) + more


def _tables(stored: Stored, stated: Mapping[str, str]) -> Iterator[Check]:
    """The checks of what the tables state. Raises SceneError for tables that `gaspart archive` cannot have
    written, though they have their digests."""
    try:
        yield _stated(stored)
        yield _claims(stored, stated)
        yield _points(stored)
    except SceneError as error:
        rule = f"has tables that cannot be read, though they have their digests: it {error.rule}"
        raise stored.refused(rule) from None
    except KeyError as error:
        raise stored.refused(f"has claims made of a file that it does not list: {error.args[0]}") from None


def _stated(stored: Stored) -> Check:
    """Which run it is; no fault can be in it."""
    run = stored.summary()
    revision = f", revision {run['revision']}" if run["revision"] else ""
    return Check("run", True, f"{run['title']}; gaspart {run['gaspart']}{revision}; {run['archived'][:10]}")


def _claims(stored: Stored, stated: Mapping[str, str]) -> Check:
    """Whether each claim of the results is listed, with the digests of the data that are in the archive."""
    run, points = stored.summary(), stored.rows(tables.POINTS, tables.PointFile._fields)
    listed = stored.rows(tables.CLAIMS, tables.ClaimData._fields)
    judged = stored.rows(f"{run['results']}/tables/claims.csv", _JUDGED)
    named = [tuple(row[key] for key in _JUDGED) for row in listed]
    if named != [tuple(row[key] for key in _JUDGED) for row in judged]:
        return Check("claims", False, f"{tables.CLAIMS} and the results list different claims")
    known = dict(stated) | {row["path"]: row["sha256"] for row in points}
    wrong = []
    inputs = {data: _inputs(stored, data) for data in dict.fromkeys(row["data"] for row in listed)}
    joint = {data: joint_digest(paths, known) for data, paths in inputs.items()}
    for row in listed:
        if row["data_sha256"] != stated.get(row["data"]) or row["inputs_sha256"] != joint[row["data"]]:
            wrong.append(row["figure"])
    if wrong:
        return Check("claims", False, f"made of other data: those of {_shown(sorted({*wrong}))}")
    return Check("claims", True, f"{len(listed)}, made of {len(joint)} measurements with these digests")


def _inputs(stored: Stored, name: str) -> list[str]:
    """The points, or tables of claims, of which a measurement in an archive is made."""
    with TemporaryDirectory(prefix="gaspart-") as folder:
        copy = Path(folder, "measurement.nc")
        stored.copy(name, copy)
        try:
            return tables.inputs_of(copy)
        except (OSError, RuntimeError, AttributeError, ValueError) as error:
            raise stored.refused(f"has a measurement that cannot be read, {name}: {error}") from None


def _points(stored: Stored) -> Check:
    """Whether the points in the archive have the digests that its table states."""
    listed = stored.rows(tables.POINTS, tables.PointFile._fields)
    rows = [row for row in listed if row["path"] in stored.names]
    wrong = [row["path"] for row in rows if stored.digest(row["path"]) != row["sha256"]]
    text = f"other digests than in {tables.POINTS}: {_shown(wrong)}" if wrong else f"{len(rows)} files"
    return Check("points", not wrong, text)
