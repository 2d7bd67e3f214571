"""Points of a deposit, from which the workflow goes on.

They are kept beside the points. There the job of a point finds what it would make, compares it, and links it.
"""

from __future__ import annotations

import csv
import json
import os
import shutil
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from gaspart.errors import SceneError
from gaspart.reproduction.archive import tables
from gaspart.reproduction.archive.stored import verify
from gaspart.reproduction.config import open_config, raise_efforts, write_efforts
from gaspart.reproduction.jobs.data import kept_path
from gaspart.reproduction.points.modules import stamp
from gaspart.reproduction.points.point import TRAJECTORIES, Point
from gaspart.reproduction.points.points import all_points, effort_of
from gaspart.reproduction.points.trust import require_own
from gaspart.trajectory import provenance
from gaspart.yaml_text import read_yaml

_SCRIPTS = Path("workflow/scripts")


def start(archive: str | Path, config: str | Path) -> int:
    """Verify an archive, take its points for the runs of a config, and print a line; return the exit code."""
    try:
        lines = [str(check) for check in verify(archive) if not check.passed]
        code = len(lines) > 0
        lines = lines or [_take(Path(archive).resolve(), config)]
    except SceneError as error:
        lines, code = [f"gaspart: {error}"], True
    print("\n".join(lines), file=sys.stderr)
    return int(code)


def _take(archive: Path, config: str | Path) -> str:
    """Move the points of a verified archive that the config has too to its folder; return a line."""
    with open_config(config) as (own, _):
        folder = Path(own["points"])
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(dir=folder, prefix=".from-") as scratch:
            there = Path(scratch)
            shutil.unpack_archive(archive, there, "zip")
            summary = json.loads((there / tables.RUN).read_text(encoding="utf-8"))
            if not summary["trajectories_included"]:
                rule = "has no trajectories: gaspart archive --trajectories includes them"
                raise SceneError("archive", str(archive), rule)
            deposited = read_yaml(there / tables.CONFIG)
            efforts = {name: effort_of(deposited, name) for name in deposited["experiments"]}
            raise_efforts(own, efforts)
            points = _needed(own)
            root = there / str(_root(there))
            used = [point for point in points if _place(replace(point, root=str(root)), Path(point.path))]
        names = {point.experiment for point in used}
        write_efforts(folder, {name: effort_of(own, name) for name in names})
        left = [point for point in points if point not in used]
        others = {stamp(point, _SCRIPTS) for point in left}
        for path in {stamp(point, _SCRIPTS) for point in used} - others:  # no kernel is needed
            Path(path).parent.mkdir(parents=True, exist_ok=True)
            Path(path).touch()
    return _describe(archive, summary, used, left)


def _needed(config: dict[str, Any]) -> list[Point]:
    """Return the points of all figures, and the first of each film's experiment."""
    every = all_points(config)
    names = {name for block in config["figures"].values() for name in block.get("experiments", ())}
    films = {block["experiment"] for block in config.get("animations", {}).values()} - names
    found = [point for name in every if name in names for point in every[name].values()]
    return found + [next(iter(every[name].values())) for name in sorted(films)]


def _root(there: Path) -> Path:
    """Return the folder of the points in an unpacked archive."""
    row = next(_rows(there / tables.POINTS))
    return Path(row["path"]).parents[2 if row["job"] == TRAJECTORIES else 1]


def _rows(path: Path) -> Iterator[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        yield from csv.DictReader(file)


def _place(point: Point, target: Path) -> bool:
    """Keep the files of a point for its job, if they are its own; return True if they are there."""
    files = [Path(path) for path in (point.replica_paths if point.job == TRAJECTORIES else [point.path])]
    if target.exists():
        return True
    if not all(file.is_file() for file in files):
        return False
    try:
        require_own(point)
    except SceneError:
        return False
    kept = kept_path(target)
    kept.parent.mkdir(parents=True, exist_ok=True)
    if kept.is_dir():
        shutil.rmtree(kept)
    os.replace(point.path, kept)
    return True


def _describe(archive: Path, summary: Mapping[str, Any], used: list[Point], left: list[Point]) -> str:
    """Return the numbers of points that are used, and made, with the reason."""
    own = provenance.versions()["gaspart_version"]
    version = "" if summary["gaspart"] == own else f", made by gaspart {summary['gaspart']} (this is {own})"
    line = f"{archive.name}: {len(used)} points are used{version}"
    if not left:
        return line
    some = ", ".join(sorted({point.experiment for point in left})[:3])
    return f"{line}; {len(left)} are made, as it has none of their scene, engine, seed and length: {some}"
