"""Points of an archive simulated again: the same bits, or not."""

from __future__ import annotations

import random
import warnings
from pathlib import Path

from gaspart.errors import SceneError
from gaspart.inspection.verdict import Check
from gaspart.kernels.compile.loading import load_numba
from gaspart.reproduction.archive import tables
from gaspart.reproduction.archive.digests import digest_of_numbers
from gaspart.reproduction.archive.scenes import scene_files
from gaspart.reproduction.archive.stored import Stored
from gaspart.reproduction.config import checked
from gaspart.reproduction.jobs.simulate import recipes, record
from gaspart.reproduction.points.point import TRAJECTORIES, Point
from gaspart.trajectory import provenance
from gaspart.yaml_text import parse_yaml, write_yaml


def chosen(stored: Stored, folder: Path, count: int) -> list[Point]:
    """So many points of an archive that have trajectories, drawn at random, or all if there are fewer.

    They are planned anew from the archive's config and scenes, which are written to `folder`. Raises
    SceneError for a config that cannot be planned.
    """
    _write_config(stored, folder)
    with checked(folder / "config/config.yaml") as (_, planned):
        points = {(one.experiment, one.name): one for each in planned.values() for one in each.values()}
    rows = stored.rows(tables.POINTS, tables.PointFile._fields)
    listed = list(
        dict.fromkeys((row["experiment"], row["point"]) for row in rows if row["job"] == TRAJECTORIES)
    )
    drawn = random.sample(listed, min(count, len(listed)))
    missing = [f"{experiment}/{name}" for experiment, name in drawn if (experiment, name) not in points]
    if missing:
        raise SceneError("archive", str(stored.path), f"has a point that its config has not: {missing[0]}")
    return [points[one] for one in drawn]


def _write_config(stored: Stored, folder: Path) -> None:
    """Write the config and the scene files that it names. Raises SceneError for one that is not in the
    archive: a config of a stranger must not have files of this machine read."""
    config = parse_yaml(stored.text(tables.CONFIG), tables.CONFIG)
    for name in scene_files(config):
        if name not in stored.names:
            raise stored.refused(f"has a config with a scene that is not in the archive: {name}")
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        stored.copy(name, target)
    (folder / "config").mkdir(exist_ok=True)
    write_yaml(folder / "config/config.yaml", config)


def rerun(stored: Stored, point: Point, folder: Path) -> Check:
    """Simulate all replicas of a point, and compare the bits of their numbers with the archive's digests."""
    load_numba(ours=True)
    rows = stored.rows(tables.POINTS, tables.PointFile._fields)
    known = {
        row["replica"]: row["numbers_sha256"]
        for row in rows
        if (row["experiment"], row["point"]) == (point.experiment, point.name)
    }
    other = []
    for replica, recipe in enumerate(recipes(**point.arguments)):
        made = folder / "again.nc"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of coarse settings, which the config has on purpose
            record(recipe, made, True)
        if digest_of_numbers(made) != known.get(str(replica)):
            other.append(str(replica))
        made.unlink()
    name = f"{point.experiment}/{point.name}"
    if not other:
        return Check("rerun", True, f"{name}: the same bits in {_counted(point.replicas)}")
    return Check("rerun", False, f"{name}: other bits in replica {', '.join(other)}{_differing(stored)}")


def _counted(count: int) -> str:
    return "1 trajectory" if count == 1 else f"{count} trajectories"


def _differing(stored: Stored) -> str:
    """How this program differs from that of the archive."""
    run = stored.summary()
    then = {"gaspart": run["gaspart"], "revision": run["revision"]}
    now = {"gaspart": provenance.versions()["gaspart_version"], "revision": provenance.git_revision()}
    differing = [
        f"{key} {then[key] or 'none'}, here {now[key] or 'none'}" for key in then if then[key] != now[key]
    ]
    return f" (archive: {'; '.join(differing)})" if differing else ""
