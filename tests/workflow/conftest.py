"""Copies of the project, in folders whose names have a space."""

import pytest
from workspace import SMOKE, copy_of_project


@pytest.fixture(scope="session")
def fresh(tmp_path_factory):
    """A copy in which nothing was run."""
    return copy_of_project(tmp_path_factory.mktemp("a fresh clone"))


@pytest.fixture(scope="session")
def smoke(tmp_path_factory):
    """A copy in which the smoke workflow has run to its end, and has made what it makes on request too: the
    report in one file, and a figure for a journal."""
    workspace = copy_of_project(tmp_path_factory.mktemp("a smoke clone"))
    requested = ("report-in-one-file.html", "figures/journal/virial_discs.pdf")
    targets = ("all", *(f"results/smoke/{name}" for name in requested))
    result = workspace.snakemake("--cores", "2", *SMOKE, "--", *targets)
    assert result.returncode == 0, result.stdout[-20_000:]
    return workspace
