"""The project's files agree: one version, and dependencies that are locked within their bounds."""

import re
import tomllib
from itertools import chain
from pathlib import Path

import yaml
from packaging.requirements import Requirement

import gaspart as gp

ROOT = Path(__file__).parents[1]


def project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_the_version_is_stated_once_and_the_citation_repeats_it():
    assert "version" not in project() and project()["dynamic"] == ["version"]
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert str(citation["version"]) == gp.__version__


def test_every_dependency_has_a_lower_bound_that_the_locked_version_satisfies():
    lock = (ROOT / "environment.txt").read_text(encoding="utf-8")
    for listed in chain(project()["dependencies"], *project()["optional-dependencies"].values()):
        requirement = Requirement(listed)
        assert [bound.operator for bound in requirement.specifier] == [">="], requirement
        locked = re.findall(rf"^{re.escape(requirement.name.lower())}==([^ ;]+)", lock, re.MULTILINE)
        assert locked and all(requirement.specifier.contains(version) for version in locked), requirement


def test_ci_runs_targets_that_the_makefile_has():
    workflow = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text(encoding="utf-8"))
    targets = workflow["jobs"]["make"]["strategy"]["matrix"]["target"]
    rules = re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert {"lint", "test", "smoke", "docs"} == set(targets) <= set(rules)


def test_cleaning_keeps_the_description_of_the_results():
    assert "!/results/README.md" in (ROOT / ".gitignore").read_text(encoding="utf-8").splitlines()
    assert "$(filter-out results/README.md," in (ROOT / "Makefile").read_text(encoding="utf-8")


def test_the_conda_environment_has_every_dependency_at_its_locked_version():
    names = {"matplotlib": "matplotlib-base", "freud-analysis": "freud"}
    listed = yaml.safe_load((ROOT / "workflow/envs/gaspart.yaml").read_text(encoding="utf-8"))["dependencies"]
    versions = dict(line.split("=") for line in listed)
    lock = (ROOT / "environment.txt").read_text(encoding="utf-8")
    for line in (*project()["dependencies"], "jinja2>=0", "docutils>=0"):
        name = Requirement(line).name.lower()
        locked = re.search(rf"^{re.escape(name)}==([^ ;]+)", lock, re.MULTILINE)[1]
        assert locked.startswith(versions[names.get(name, name)]), name
