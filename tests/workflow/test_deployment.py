"""The workflow as a module of another one, in a folder that has nothing but a config and a Snakefile."""

import json
import re
import shutil
import subprocess
import zipfile

import pytest
from crates import faults
from digests import digests, known
from workspace import ROOT, Workspace, copy_of_project, leave_one_figure

from gaspart.cli import main
from gaspart.reproduction.archive.metadata import METADATA
from gaspart.reproduction.config import merged_with_default
from gaspart.yaml_text import parse_yaml, write_yaml

pytestmark = [pytest.mark.workflow, pytest.mark.thorough]

SNAKEFILE = f"""
configfile: "settings.yaml"

module gaspart:
    snakefile: "{ROOT / "workflow/Snakefile"}"
    config: config

use rule * from gaspart
"""
FIGURE = "wall_pressure"
KNOWN = known()
OWN = re.search(
    r"^```yaml\n(# my_gas\.yaml\n.*?)^```$",
    (ROOT / "docs/adding-a-figure.md").read_text(encoding="utf-8"),
    re.MULTILINE | re.DOTALL,
)


CITATION = """cff-version: 1.2.0
message: cite it
title: my gas
version: "1"
license: MIT
authors:
- {given-names: Ada, family-names: Example}
"""
PREFIXED = f"""
module other:
    snakefile: "{ROOT / "workflow/Snakefile"}"
    config: config
    prefix: "parts/walls"

use rule * from other as other_*
"""


def test_a_module_with_a_prefix_makes_everything_below_it_with_the_same_bits(tmp_path, capsys):
    """The project lies below the folder, where a prefix would apply to its paths too."""
    project = tmp_path / "project"
    copy_of_project(project)
    config, _ = merged_with_default(ROOT / "config/smoke.yaml")
    experiments = config["figures"][FIGURE]["experiments"]
    config |= {
        "run": None,
        "experiments": {name: config["experiments"][name] for name in experiments},
        "figures": {FIGURE: config["figures"][FIGURE]},
        "animations": {},
    }
    write_yaml(tmp_path / "settings.yaml", config)
    (tmp_path / "Snakefile").write_text((SNAKEFILE + PREFIXED).replace(str(ROOT), str(project)))
    (tmp_path / "CITATION.cff").write_text(CITATION)
    here, results = Workspace(tmp_path), tmp_path / "parts/walls/results"
    done = here.snakemake("--cores", "1", "other_all", source=project)
    assert done.returncode == 0, done.stdout[-3000:]
    assert here.plan("other_all", source=project) == {}
    assert (results / f"figures/{FIGURE}.png").read_bytes().startswith(b"\x89PNG")
    assert f"{FIGURE}," in (results / "tables/claims.csv").read_text()
    assert f"parts/walls/results/figures/{FIGURE}.png" in (results / "report.html").read_text()
    made = digests(results / "smoke/points")
    assert made and made == {name: KNOWN[name] for name in made}
    archive = tmp_path / "walls.zip"
    assert main(["archive", str(results), "-o", str(archive)]) == 0, capsys.readouterr().err
    assert main(["verify", str(archive), "--rerun", "1"]) == 0, capsys.readouterr()
    assert sorted(path.name for path in tmp_path.iterdir() if path.name[0] != ".") == [
        "CITATION.cff",
        "Snakefile",
        "parts",
        "project",
        "settings.yaml",
        "walls.zip",
    ]
    assert "report" in here.plan("report", source=project)  # of the module without a prefix


@pytest.mark.parametrize(("host", "prefix"), [("file", ""), ("hub", "parts/gas")])
def test_a_module_from_a_repository_runs(tmp_path, monkeypatch, host, prefix):
    """The files are those of the commit, not of a folder; the hub's clone is where Snakemake would put it."""
    project = copy_of_project(tmp_path / "project").path
    for line in ("init -q", "add .", "-c user.name=a -c user.email=a commit -q -m all"):
        subprocess.run(["git", *line.split()], cwd=project, check=True)
    asked = subprocess.run(
        ["git", "rev-parse", "HEAD"], cwd=project, check=True, capture_output=True, text=True
    )
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    clones = tmp_path / "cache/snakemake/snakemake/source-cache/snakemake-git-cache/github.com"
    subprocess.run(["git", "clone", "-q", "--bare", project, clones / "an/owner"], check=True)
    for name in ("src", "workflow"):
        shutil.rmtree(project / name)
    repository = project if host == "file" else "an/owner"
    source = f'git{host}("{repository}", path="workflow/Snakefile", commit="{asked.stdout.strip()}")'
    text = SNAKEFILE.replace(f'"{ROOT / "workflow/Snakefile"}"', source)
    text = text.replace("config: config", f'config: config\n    prefix: "{prefix}"') if prefix else text
    here = Workspace(tmp_path / "here")
    here.path.mkdir()
    (here.path / "Snakefile").write_text(text)
    config = {"title": "my gas", "seed": 1, "points": "results/points", **parse_yaml(OWN[1])}
    write_yaml(here.path / "settings.yaml", config)
    done = here.snakemake("--cores", "1", "all", source=tmp_path / "nowhere")
    assert done.returncode == 0, done.stdout[-3000:]
    assert (here.path / prefix / "results/figures/my_gas.png").read_bytes().startswith(b"\x89PNG")
    assert here.plan("all", source=tmp_path / "nowhere") == {}


def test_a_module_without_a_config_is_one_line(tmp_path):
    (tmp_path / "Snakefile").write_text(SNAKEFILE.replace('configfile: "settings.yaml"', ""))
    done = Workspace(tmp_path).snakemake("--dry-run", "--cores", "1", source=ROOT)
    stated = 'is empty: the Snakefile that has the module states `configfile: "..."` above it'
    assert done.returncode == 2 and done.stdout.splitlines()[-1] == f"gaspart: config = {{}}: {stated}"


def test_the_module_of_the_docs_beside_a_rule_all_of_its_own(tmp_path):
    assert OWN
    page = (ROOT / "docs/workflow.md").read_text(encoding="utf-8")
    block = re.search(r'^    configfile: "settings.yaml"\n.*?(?=^\S)', page, re.MULTILINE | re.DOTALL)[0]
    text = "\n".join(line.removeprefix("    ") for line in block.splitlines())
    (tmp_path / "Snakefile").write_text(text.replace("/path/to/gaspart", str(ROOT)))
    config = {"title": "my gas", "seed": 1, "points": "results/points", **parse_yaml(OWN[1])}
    write_yaml(tmp_path / "settings.yaml", config)
    assert Workspace(tmp_path).plan(source=ROOT)["figure"] == 1


def test_results_of_a_module_are_archived_and_verified(tmp_path, capsys):
    """A folder with a Snakefile, a config of any name, a scene file and CITATION.cff, and no more."""
    project, snakefile = tmp_path / "project", "workflow/Snakefile"
    (project / snakefile).parent.mkdir(parents=True)
    (project / snakefile).write_text(SNAKEFILE)
    config = {"title": "my gas", "seed": 1, "points": "results/points", **parse_yaml(OWN[1])}
    scene = {"container": {"lengths": [20.0, 20.0], "boundary": "periodic"}}
    write_yaml(project / "gas.yaml", scene | {"species": [{"count": 64, "radius": 0.5, "temperature": 1.0}]})
    point = {"scene": "gas.yaml", "duration": 60.0, "samples": 60, "equilibration": 5.0}
    grid = {"scene.species.0.count": [40, 60]}
    config["experiments"] = {"my_gas": {"point": point, "grid": grid}}
    figure = {"against": "scene.species.0.count", "caption": "**Of discs.**", "claims": []}
    config["figures"]["my_gas"] |= figure
    write_yaml(project / "settings.yaml", config)
    done = Workspace(project).snakemake("--cores", "1", "all", source=ROOT)
    assert done.returncode == 0, done.stdout[-3000:]
    archive = tmp_path / "archive.zip"
    command = ["archive", str(project / "results"), "-o", str(archive)]
    assert main(command) == 2
    assert "has no CITATION.cff, which an archive needs" in capsys.readouterr().err
    (project / "CITATION.cff").write_text(CITATION)
    assert main(command) == 0, capsys.readouterr().err
    assert [
        message for message, severity in faults(archive, tmp_path).items() if severity == "REQUIRED"
    ] == []
    with zipfile.ZipFile(archive) as file:
        names = set(file.namelist())
        assert json.loads(file.read(METADATA))["@graph"]
    assert {snakefile, "CITATION.cff", "settings.yaml", "gas.yaml", "results/report.html"} <= names
    capsys.readouterr()
    for place in (archive, tmp_path / "unpacked"):
        assert main(["verify", str(place), "--rerun", "1"]) == 0, capsys.readouterr()
        assert "the same bits in" in capsys.readouterr().out
        shutil.unpack_archive(archive, tmp_path / "unpacked")


def test_a_point_that_another_clone_has_simulated_comes_from_the_shared_cache(tmp_path, monkeypatch):
    (tmp_path / "shared").mkdir()
    monkeypatch.setenv("SNAKEMAKE_OUTPUT_CACHE", str(tmp_path / "shared"))
    for name in ("first", "second"):
        here = copy_of_project(tmp_path / name)
        leave_one_figure(here.path, "virial_discs")
        done = here.snakemake("--cores", "1", "--cache", "--", "results/figures/virial_discs.png")
        assert done.returncode == 0, done.stdout[-3000:]
        assert len(list((tmp_path / "shared").iterdir())) == 4
    replicas = list(here.path.glob("results/smoke/points/virial_discs/*/replica-0.nc"))
    assert len(replicas) == 4 and all(path.is_symlink() for path in replicas)
