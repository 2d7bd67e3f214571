"""The archive of the smoke run: a valid RO-Crate, verified elsewhere, in which every change is found."""

import csv
import hashlib
import io
import json
import re
import shutil
import subprocess
import zipfile
from urllib.parse import unquote

import pytest
from crates import faults
from workspace import PARTS, ROOT, SMOKE, Workspace

from gaspart.cli import main
from gaspart.reproduction.archive import tables
from gaspart.reproduction.archive.metadata import METADATA
from gaspart.reproduction.archive.writing import MANIFEST
from gaspart.reproduction.start import start

pytestmark = pytest.mark.workflow

BESIDE = ["CITATION.cff", "LICENSE", "README.md", "environment.txt", "pyproject.toml"]
TABLE = "results/smoke/tables/claims.csv"


@pytest.fixture(scope="module")
def project(smoke):
    """The folder in which the smoke workflow has run, with what else a copy of the project has."""
    for name in BESIDE:
        shutil.copy(ROOT / name, smoke.path)
    return smoke.path


@pytest.fixture(scope="module")
def archive(project, tmp_path_factory):
    """The archive of the smoke run."""
    path = tmp_path_factory.mktemp("archive") / "smoke.zip"
    assert main(["archive", str(project / "results/smoke"), "-o", str(path)]) == 0
    return path


@pytest.fixture
def unpacked(archive, tmp_path):
    """A folder into which the archive was unpacked, which a test may change."""
    folder = tmp_path / "unpacked"
    with zipfile.ZipFile(archive) as file:
        file.extractall(folder)
    return folder


def flip(path, place=1000):
    """Change one byte of a file."""
    data = bytearray(path.read_bytes())
    data[place] ^= 1
    path.write_bytes(data)


def state(folder, name):
    """Let the manifest of an unpacked archive state a file as it is, as if it had always been so."""
    new = hashlib.sha256((folder / name).read_bytes()).hexdigest()
    manifest = (folder / MANIFEST).read_text()
    (folder / MANIFEST).write_text(
        re.sub(rf"^\w+  {re.escape(name)}$", f"{new}  {name}", manifest, flags=re.M)
    )


def change(folder, name, column, change):
    """Change a column of a table in an unpacked archive, and its manifest too."""
    rows = list(csv.DictReader(io.StringIO((folder / name).read_text())))
    for row in rows:
        row[column] = change(row[column])
    (folder / name).write_text(tables.text_of([tuple(row.values()) for row in rows], tuple(rows[0])))
    state(folder, name)


def lines(capsys, *words):
    """The exit code of a command line, and what it prints."""
    code = main([str(word) for word in words])
    said = capsys.readouterr()
    return code, (said.out + said.err).splitlines()


def test_the_archive_is_valid_and_small(archive, tmp_path):
    found = faults(archive, tmp_path)
    assert [message for message, severity in found.items() if severity == "REQUIRED"] == []
    # What CITATION.cff does not have: an address of the project, of its authors, and of a publisher.
    assert all(re.search("url|URL|URI|publisher", message) for message in found), found
    assert archive.stat().st_size < 30e6


def test_the_metadata_state_the_citation_and_the_digests_of_the_manifest(archive):
    with zipfile.ZipFile(archive) as file:
        graph = {unquote(one["@id"]): one for one in json.loads(file.read(METADATA))["@graph"]}
        manifest = dict(line.split("  ")[::-1] for line in file.read(MANIFEST).decode().splitlines())
        names = {name for name in file.namelist() if not name.endswith("/")}
    root = graph["./"]
    assert root["name"].startswith("gaspart: hard-sphere and hard-disc gases") and "smoke" in root["name"]
    assert root["license"]["@id"] == "https://spdx.org/licenses/BSD-3-Clause"
    assert graph[root["creator"]["@id"]] == {
        "@id": "#creator-1",
        "@type": "Organization",
        "name": "the gaspart authors",
    }
    assert names == manifest.keys() | {MANIFEST}
    described = {name: one["sha256"] for name, one in graph.items() if "sha256" in one}
    assert described.items() <= manifest.items()
    undescribed = manifest.keys() - described.keys() - {METADATA}
    assert {name.partition("/")[0] for name in undescribed} == {"config", "profiles", "src", "workflow"}
    run = graph["#run"]
    assert run["instrument"]["@id"] == root["mainEntity"]["@id"] == "workflow/Snakefile"
    assert {unquote(one["@id"]) for one in run["result"]} == {
        name for name in manifest if name.startswith("results/")
    }
    assert run["startTime"] < run["endTime"]


def test_sha256sum_verifies_it_too(unpacked):
    command = ["sha256sum", "--check", "--quiet", MANIFEST]
    assert subprocess.run(command, cwd=unpacked, capture_output=True).returncode == 0
    flip(unpacked / TABLE)
    assert subprocess.run(command, cwd=unpacked, capture_output=True).returncode == 1


def test_the_tables_state_every_claim_trajectory_and_job(archive, project):
    def rows(name):
        with zipfile.ZipFile(archive) as file:
            return list(csv.DictReader(io.StringIO(file.read(name).decode())))

    found = {path.relative_to(project) for path in project.glob("results/smoke/points/*/*/replica-*.nc")}
    stated = {row["path"]: row for row in rows(tables.POINTS)}
    assert {str(path) for path in found} <= stated.keys()
    some = stated[str(next(iter(found)))]
    assert some["sha256"] == hashlib.sha256((project / some["path"]).read_bytes()).hexdigest()
    assert len(rows(tables.CLAIMS)) == len(rows(TABLE)) > 30
    jobs = rows(tables.JOBS)
    assert {"simulate", "compute", "figure", "report", "warm"} <= {one["rule"] for one in jobs}
    assert all(float(one["cpu_seconds"]) >= 0.0 and one["ended"].endswith("+00:00") for one in jobs)
    with zipfile.ZipFile(archive) as file:
        machine = json.loads(file.read(tables.RUN))["machine"]
    assert machine["processor"] and machine["packages"]["snakemake"]


def test_what_the_report_shows_is_in_the_archive(unpacked):
    page = (unpacked / "results/smoke/report.html").read_text()
    files = set(re.findall(r'(?:src|srcset|href|poster)="([^"#:]+)"', page))
    assert len(files) > 30
    assert not [file for file in files if not (unpacked / "results/smoke" / file).exists()]
    captions = [path.read_text() for path in (unpacked / "results/smoke/captions").glob("*.rst")]
    assert captions and not [caption for caption in captions if "{{" in caption]
    assert sum("not measured" not in caption for caption in captions) > len(captions) / 2


def test_it_is_verified_in_another_folder(archive, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    code, said = lines(capsys, "verify", archive, "--rerun", 3)
    assert code == 0, said
    assert [line.split()[1] for line in said] == ["files:", "run:", "claims:", "points:", *["rerun:"] * 3]
    assert all("the same bits in" in line for line in said[-3:])
    assert list(tmp_path.iterdir()) == []


def test_changed_missing_and_added_files_are_found(unpacked, tmp_path, capsys):
    assert lines(capsys, "verify", unpacked)[0] == 0
    flip(unpacked / TABLE)
    (unpacked / "results/smoke/figures/reversibility.png").unlink()
    (unpacked / "results/smoke/figures/heating.png").touch()
    packed = shutil.make_archive(str(tmp_path / "packed"), "zip", unpacked)
    for path in (unpacked, packed):
        code, said = lines(capsys, "verify", path, "--rerun", 3)
        assert code == 1 and len(said) == 1
        assert f"changed or damaged: {TABLE}" in said[0]
        assert "missing: results/smoke/figures/reversibility.png" in said[0]
        assert "not of the archive: results/smoke/figures/heating.png" in said[0]


def test_claims_of_other_data_are_found_though_the_manifest_agrees(unpacked, capsys):
    name = "results/smoke/measurements/virial_discs.nc"
    shutil.copy(unpacked / "results/smoke/measurements/reversibility.nc", unpacked / name)
    state(unpacked, name)
    code, said = lines(capsys, "verify", unpacked)
    assert code == 1
    assert [line for line in said if line.startswith("WRONG")] == [
        "WRONG claims: made of other data: those of virial_discs"
    ]


def test_points_of_other_digests_are_found_though_the_manifest_agrees(unpacked, capsys):
    change(unpacked, tables.POINTS, "sha256", lambda value: value[::-1])
    code, said = lines(capsys, "verify", unpacked)
    assert code == 1
    assert [line.split(":")[0] for line in said if line.startswith("WRONG")] == [
        "WRONG claims",
        "WRONG points",
    ]


def test_other_bits_of_a_rerun_are_found(unpacked, capsys):
    """As of another config, whose seeds differ."""
    config = unpacked / tables.CONFIG
    text = config.read_text()
    config.write_text(re.sub(r"^seed: \d+", "seed: 77", text, flags=re.M))
    assert config.read_text() != text
    state(unpacked, tables.CONFIG)
    code, said = lines(capsys, "verify", unpacked, "--rerun", 1)
    assert code == 1
    assert len([line for line in said if line.startswith("WRONG rerun: ")]) == 1, said
    assert ": other bits in replica 0" in said[-1]


def test_trajectories_are_included_on_request(project, tmp_path, capsys):
    path = tmp_path / "all.zip"
    assert main(["archive", str(project / "results/smoke"), "-o", str(path), "--trajectories"]) == 0
    said = capsys.readouterr().out
    count = int(re.search(r"with (\d+) trajectories", said)[1])
    with zipfile.ZipFile(path) as file:
        names = [name for name in file.namelist() if re.search(r"/replica-\d+\.nc$", name)]
        points = tables.rows_of(file.read(tables.POINTS).decode())
    assert len(names) == count > 20
    code, said = lines(capsys, "verify", path)
    assert code == 0 and said[-1] == f"ok    points: {len(points)} files"


def refused(capsys, project, *options):
    code, said = lines(capsys, "archive", *options, "-o", project.parent / "refused.zip")
    assert code == 2 and len(said) == 1 and not (project.parent / "refused.zip").exists(), said
    return said[0]


@pytest.mark.thorough
def test_another_clone_starts_from_a_deposit(project, tmp_path, capsys, monkeypatch):
    """Timings have the same bits: they are copied, and not made."""
    deposit = tmp_path / "deposit.zip"
    assert main(["archive", str(project / "results/smoke"), "-o", str(deposit), "--trajectories"]) == 0
    clone = Workspace(tmp_path / "clone")
    for part in PARTS:
        shutil.copytree(project / part, clone.path / part)
    config = str(clone.path / "config/smoke.yaml")
    flip(shutil.copy(deposit, tmp_path / "damaged.zip"), deposit.stat().st_size // 2)
    capsys.readouterr()
    assert start(tmp_path / "damaged.zip", config) == 1 and not (clone.path / "results").exists()
    assert capsys.readouterr().err.count("\n") == 1
    restore = clone.edit("config/config.yaml", "seed: 2010", "seed: 2011")
    assert start(deposit, config) == 0
    told = capsys.readouterr().err
    restore()
    assert re.search(r"^deposit.zip: \d+ points are used.*; \d+ are made, as it has none of", told)
    with monkeypatch.context() as other:
        other.setattr("gaspart.trajectory.provenance.versions", lambda: {"gaspart_version": "9.0"})
        assert start(deposit, config) == 0
    told = capsys.readouterr().err
    assert re.search(r"points are used, made by gaspart \S+ \(this is 9.0\)\n$", told)
    assert start(deposit, config) == 0
    assert re.fullmatch(r"deposit.zip: \d+ points are used\n", capsys.readouterr().err)
    claims = [f"results/smoke/claims/{figure}.csv" for figure in ("virial_discs", "ideal_boxes")]
    assert "warm" not in clone.plan(*SMOKE, "--", *claims)
    done = clone.snakemake("--cores", "2", *SMOKE, "--", *claims)
    assert done.returncode == 0, done.stdout[-3000:]
    made = [path.relative_to(clone.path) for path in clone.path.glob("results/smoke/points/[a-z]*/*.nc")]
    assert made and all(
        (clone.path / name).read_bytes() == (project / name).read_bytes() for name in [*made, *claims]
    )


def test_a_run_that_is_not_complete_is_refused(project, capsys):
    results, missing = project / "results/smoke", "results/smoke/figures/reversibility.png"
    (project / missing).rename(project / "aside")
    try:
        said = refused(capsys, project, results)
        assert f"is not complete: {missing} is missing; run the workflow to its end" in said
    finally:
        (project / "aside").rename(project / missing)


def test_trajectories_of_other_settings_are_refused(project, capsys):
    other = project / "other.yaml"
    config = (project / "config/smoke.yaml").read_text()
    other.write_text(f"seed: 77\n{config}")
    try:
        said = refused(capsys, project, project / "results/smoke")
        assert "run = 'smoke': is the run of 2 configs" in said and "(--config FILE)" in said
        said = refused(capsys, project, project / "results/smoke", "--config", project / "config/config.yaml")
        assert "run = None: must be smoke, as" in said
        said = refused(capsys, project, project / "results/smoke", "--config", other)
        assert "was not made by the point" in said
    finally:
        other.unlink()
