"""Tables on the origin of the numbers in an archive: points, claims, jobs, machine."""

from __future__ import annotations

import csv
import io
import os
import platform
from collections.abc import Iterable, Mapping
from contextlib import suppress
from datetime import UTC, datetime
from importlib.metadata import distributions
from pathlib import Path
from typing import Any, NamedTuple

from gaspart.reproduction import job_time
from gaspart.reproduction.archive.contents import Finished
from gaspart.reproduction.archive.digests import digest_of_file, digest_of_numbers, joint_digest
from gaspart.reproduction.claims import table
from gaspart.reproduction.points.point import TRAJECTORIES
from gaspart.system import memory
from gaspart.trajectory import provenance
from gaspart.trajectory.recipe import stored_revision

FOLDER = "provenance"
POINTS = f"{FOLDER}/points.csv"
CLAIMS = f"{FOLDER}/claims.csv"
JOBS = f"{FOLDER}/jobs.csv"
CONFIG = f"{FOLDER}/config.yaml"
RUN = f"{FOLDER}/run.json"


class PointFile(NamedTuple):
    """Row of `points.csv`: a file of a point; the fields of trajectories are "" for other points.
    `numbers_sha256` is the digest of the numbers without the attributes, and `revision` the git revision at
    which the trajectory was begun.
    """

    experiment: str
    point: str
    job: str
    replica: str
    path: str
    bytes: str
    sha256: str
    numbers_sha256: str
    revision: str


class ClaimData(NamedTuple):
    """Row of `claims.csv`: a claim, its measurement, and the `joint_digest` of what that is made of."""

    figure: str
    claim: str
    verdict: str
    data: str
    data_sha256: str
    inputs_sha256: str


class JobTime(NamedTuple):
    """Row of `jobs.csv`: CPU time in s, peak memory in MB, and end in UTC of a job."""

    rule: str
    job: str
    cpu_seconds: str
    largest_memory: str
    ended: str


def point_files(run: Finished) -> list[PointFile]:
    """Return the files of all points, with their digests."""
    rows = []
    for point in run.points:
        is_folder = point.job == TRAJECTORIES
        for replica, path in enumerate(point.replica_paths if is_folder else [point.path]):
            file = run.root / path
            numbers = (digest_of_numbers(file), stored_revision(file)) if is_folder else ("", "")
            named = point.experiment, point.name, point.job, str(replica) if is_folder else ""
            rows.append(PointFile(*named, path, str(file.stat().st_size), digest_of_file(file), *numbers))
    return rows


def inputs_of(measurement: bytes) -> list[str]:
    """Return the points, or tables of claims, that the file of a measurement states as its origin."""
    from netCDF4 import Dataset

    with Dataset("measurement", memory=measurement) as file:
        return str(file.getncattr("points")).splitlines()


def claim_rows(run: Finished, files: Iterable[PointFile]) -> list[ClaimData]:
    """Return all claims with the digests of their data."""
    judged = [f"{run.results}/claims/{figure}.csv" for figure in run.figures]
    digests = {file.path: file.sha256 for file in files}
    digests |= {path: digest_of_file(run.root / path) for path in judged}
    data: dict[str, tuple[str, str, str]] = {}
    for figure in run.figures:
        path = f"{run.results}/measurements/{figure}.nc"
        joint = joint_digest(inputs_of((run.root / path).read_bytes()), digests)
        data[figure] = (path, digest_of_file(run.root / path), joint)
    rows = table.read(run.root / run.results / "tables/claims.csv")
    return [ClaimData(row["figure"], row["claim"], row["verdict"], *data[row["figure"]]) for row in rows]


def job_times(run: Finished) -> list[JobTime]:
    """Return time and memory of each job, as its log states them, without points that the config lost."""
    folder = run.root / run.results / "logs"
    kept = {(point.experiment, point.name) for point in run.points}
    rows = []
    for path in sorted(folder.rglob("*.log")):
        rule, *names = path.relative_to(folder).with_suffix("").parts
        used = job_time.read_used(folder.parent, rule, *names)
        if used and (rule not in ("simulate", "compute") or tuple(names) in kept):
            ended = datetime.fromtimestamp(path.stat().st_mtime, UTC).isoformat(timespec="seconds")
            numbers = f"{used.seconds:.2f}", f"{used.memory:.1f}"
            rows.append(JobTime(rule, "/".join(names), *numbers, ended))
    return rows


def text_of(rows: Iterable[tuple], columns: tuple[str, ...]) -> str:
    """Return rows as CSV."""
    text = io.StringIO()
    written = csv.writer(text, lineterminator="\n")
    written.writerow(columns)
    written.writerows(rows)
    return text.getvalue()


def rows_of(text: str) -> list[dict[str, str]]:
    """Return the rows of a text made by `text_of`."""
    return list(csv.DictReader(io.StringIO(text, newline=""), strict=True))


def _machine() -> dict[str, Any]:
    """Return processor, memory and system of this machine, and the installed packages."""
    processor = platform.processor()
    with suppress(OSError, StopIteration):  # model of the processor, as Linux states it
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        processor = next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    packages = {package.name: package.version for package in distributions() if package.name}
    return {
        "processor": processor,
        "architecture": platform.machine(),
        "processors": os.cpu_count(),
        "memory_bytes": memory(),
        "system": platform.platform(),
        "python": platform.python_version(),
        "packages": dict(sorted(packages.items(), key=lambda item: item[0].lower())),
    }


def summary_of(run: Finished, files: Iterable[PointFile], trajectories: bool) -> Mapping[str, Any]:
    """Return the content of `run.json`: run, revisions, and the machine that wrote the archive."""
    revisions = {file.revision for file in files if file.revision}
    return {
        "title": run.config["title"],
        "results": run.results,
        "figures": len(run.figures),
        "trajectories_included": trajectories,
        "gaspart": provenance.versions()["gaspart_version"],
        "revision": provenance.git_revision(),
        "revisions_of_trajectories": sorted(revisions),
        "archived": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": _machine(),
    }
