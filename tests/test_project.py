"""The project's files agree: one version, and dependencies that are locked within their bounds."""

import csv
import os
import re
import shutil
import subprocess
import tomllib
from itertools import chain
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

import gaspart as gp

ROOT = Path(__file__).parents[1]


def project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_the_version_is_stated_once_and_the_citation_repeats_it():
    assert "version" not in project() and project()["dynamic"] == ["version"]
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert str(citation["version"]) == gp.__version__


def requirements(*extras):
    """The dependencies, and those of the extras; an extra may name others, as `gaspart[film]`."""
    found = [Requirement(listed) for listed in project()["dependencies"]]
    for extra in extras:
        listed = [Requirement(text) for text in project()["optional-dependencies"][extra]]
        found += [one for one in listed if one.name != "gaspart"]
        found += requirements(*chain(*(one.extras for one in listed if one.name == "gaspart")))
    return found


@pytest.mark.parametrize(("name", "extras"), [("environment", ("make",)), ("environment-dev", None)])
def test_every_dependency_has_a_lower_bound_that_the_locked_version_satisfies(name, extras):
    lock = (ROOT / f"{name}.txt").read_text(encoding="utf-8")
    for requirement in requirements(*(extras or project()["optional-dependencies"])):
        assert ">=" in {bound.operator for bound in requirement.specifier}, requirement
        name = re.escape(requirement.name.lower())
        locked = re.findall(rf"^{name}(?:\[[\w,]+\])?==([^ ;]+)", lock, re.MULTILINE)
        assert locked and all(requirement.specifier.contains(version) for version in locked), requirement


def test_both_environments_have_the_same_versions():
    names = "environment.txt", "environment-dev.txt"
    locks = [(ROOT / name).read_text(encoding="utf-8") for name in names]
    small, large = (set(re.findall(r"^[\w.-]+==[^ \\]+", lock, re.MULTILINE)) for lock in locks)
    assert len(small) > 50 and small < large


def test_what_a_message_says_to_install_is_an_extra():
    texts = [path.read_text(encoding="utf-8") for path in (ROOT / "src").rglob("*.py")]
    calls = [call for text in texts for call in re.findall(r'optional\("(\w+)[\w.]*", "(\w+)"', text)]
    provided = {"freud": "freud-analysis", "gsd": "gsd", "imageio_ffmpeg": "imageio-ffmpeg"}
    provided |= {"rocrate": "rocrate"}
    assert {module for module, _ in calls} == set(provided)
    core = {requirement.name for requirement in requirements()}
    for module, extra in calls:
        names = {requirement.name for requirement in requirements(extra)} - core
        assert names == {provided[module]}, (module, extra)


def test_the_packages_of_the_referees_are_locked():
    folder = ROOT / "tests/referees"
    lines = (folder / "environment.in").read_text(encoding="utf-8").splitlines()
    wanted = [Requirement(line) for line in lines if not line.startswith("#")]
    lock = (folder / "environment.txt").read_text(encoding="utf-8")
    for requirement in wanted:
        name = re.escape(requirement.name.lower())
        locked = re.findall(rf"^{name}==([^ ;]+)", lock, re.MULTILINE)
        assert locked and all(requirement.specifier.contains(version) for version in locked), requirement


def test_every_referee_has_found_the_runs_right_and_the_planted_error():
    with (ROOT / "docs/referees.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert rows
    for row in rows:
        assert float(row["distance"]) <= float(row["allowed"]) < float(row["planted"]), row


def test_the_conda_environment_has_every_dependency_at_its_locked_version():
    listed = yaml.safe_load((ROOT / "workflow/envs/gaspart.yaml").read_text(encoding="utf-8"))["dependencies"]
    versions = dict(line.split("=") for line in listed)
    lock = (ROOT / "environment.txt").read_text(encoding="utf-8")
    packages = {requirement.name.lower() for requirement in requirements("workflow")}
    for name in packages - {"snakemake", "snakemake-executor-plugin-slurm"}:
        locked = re.search(rf"^{re.escape(name)}==([^ ;]+)", lock, re.MULTILINE)[1]
        assert locked.startswith(versions[CONDA.get(name, name)]), name


CONDA = {"matplotlib": "matplotlib-base", "freud-analysis": "freud"}
"""Names of packages that are others in conda-forge."""


def test_the_conda_recipe_has_the_dependencies_and_the_version():
    recipe = yaml.safe_load((ROOT / "release/recipe.yaml").read_text(encoding="utf-8"))
    stated = dict(line.split() for line in recipe["requirements"]["run"])
    assert stated.pop("python") == project()["requires-python"]
    needed = {CONDA.get(one.name, one.name.lower()): one.specifier for one in requirements()}
    assert {name: SpecifierSet(bounds) for name, bounds in stated.items()} == needed
    assert recipe["context"]["version"] == gp.__version__
    assert recipe["about"]["license"] == project()["license"]


CASES = [
    ("setup", ".venv"),
    ("distclean", ".venv"),
    ("referees", ".venv-referees"),
    ("distclean", ".venv-referees"),
]


@pytest.mark.parametrize(("target", "environment"), CASES)
@pytest.mark.parametrize("made", [None, "made_by_make", "environment.stamp"])
def test_make_removes_no_environment_but_its_own(tmp_path, target, environment, made):
    """`venv --clear` and `rm -rf` would delete what a user keeps in an environment of the same name."""
    files = ("environment.txt", "environment-dev.txt", "pyproject.toml", "tests/referees/environment.txt")
    for name in ("Makefile", *files):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    kept = tmp_path / environment / "thesis.csv"
    kept.parent.mkdir()
    kept.write_text("data")
    if made:
        (kept.parent / made).touch()
        os.utime(kept.parent / made, (0.0, 0.0))  # older than environment.txt
    stub = tmp_path / "python"  # makes no environment, but clears the folder as venv does
    stub.write_text('#!/bin/sh\ntest "$2" != venv || rm -rf "$4"\ntest "$2" != venv\n')
    stub.chmod(0o755)
    goal = ".venv-referees/environment.stamp" if target == "referees" else target
    command = ["make", goal, f"PYTHON={stub}"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert kept.exists() == (made is None), done.stdout + done.stderr
    if made is None:
        assert done.returncode == 2
        text = "exists and was not made by make, which would replace it; move it away"
        assert f"make: {environment} {text}" in done.stderr
