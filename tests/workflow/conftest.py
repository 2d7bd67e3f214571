"""Copies of the project, in folders whose names have a space."""

import pytest
from workspace import SMOKE, copy_of_project


@pytest.fixture(scope="session")
def fresh(tmp_path_factory):
    """A copy in which nothing was run."""
    return copy_of_project(tmp_path_factory.mktemp("a fresh clone"))


@pytest.fixture(scope="session")
def smoke(tmp_path_factory):
    """A copy in which the smoke workflow has run to its end, and has made the report in one file too."""
    workspace = copy_of_project(tmp_path_factory.mktemp("a smoke clone"))
    result = workspace.snakemake("--cores", "2", *SMOKE, "--", "all", "results/smoke/report-in-one-file.html")
    assert result.returncode == 0, result.stdout[-20_000:]
    return workspace
