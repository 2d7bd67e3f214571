"""Copies of the project, in folders whose names have a space."""

import pytest
from workspace import SMOKE, copy_of_project, keep_figures

FEW = [
    "virial_discs",  # simulate
    "speed_relaxation",  # with a film
    "ideal_boxes",  # measure_cost
    "fill_failures",  # fill
    "densest_fill",  # pack
    "speed_accuracy",  # compare
    "reversibility",  # echo
    "claims_scatter",
]
"""A figure for each kind of job; a test compares them."""


@pytest.fixture(scope="session")
def fresh(tmp_path_factory):
    """A copy in which nothing was run."""
    return copy_of_project(tmp_path_factory.mktemp("a fresh clone"))


@pytest.fixture(scope="session")
def few(tmp_path_factory):
    """The same with few figures, which Snakemake plans in less time."""
    workspace = copy_of_project(tmp_path_factory.mktemp("a small clone"))
    keep_figures(workspace.path, FEW)
    return workspace


@pytest.fixture(
    scope="session", params=["few figures", pytest.param("all figures", marks=pytest.mark.thorough)]
)
def smoke(request, tmp_path_factory):
    """A copy in which the smoke workflow has run to its end.

    It has made what it makes on request too: the report in one file, and a figure for a journal.
    """
    workspace = copy_of_project(tmp_path_factory.mktemp("a smoke clone"))
    if request.param == "few figures":
        keep_figures(workspace.path, FEW)
    requested = ("report-in-one-file.html", "figures/journal/virial_discs.pdf")
    targets = ("all", *(f"results/smoke/{name}" for name in requested))
    result = workspace.snakemake("--cores", "2", *SMOKE, "--", *targets)
    assert result.returncode == 0, result.stdout[-20_000:]
    return workspace
