"""docs/adding-a-figure.md, followed word by word: new figures are drawn and their claims evaluated."""

import csv
import re

import pytest
from workspace import ROOT, SMOKE, copy_of_project

pytestmark = [pytest.mark.workflow, pytest.mark.thorough]

BLOCK = re.compile(r'^```\w+ title="(?P<path>[^"]+)"\n(?P<text>.*?)^```$', re.M | re.S)
OF_PACKAGE = 3
"""Files of the new figure, beside the stored data and the line in the changes."""


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    """A copy of the project in which the page has been followed."""
    copy = copy_of_project(tmp_path_factory.mktemp("a new figure"))
    blocks = list(BLOCK.finditer((ROOT / "docs/adding-a-figure.md").read_text(encoding="utf-8")))
    assert len(blocks) == 2 + OF_PACKAGE
    for block in blocks:
        file = copy.path / block["path"]
        assert not file.exists() and file.parent.exists()
        file.write_text(block["text"], encoding="utf-8")
    return copy


def verdicts(workspace, results, figure, *options):
    """The verdicts of a figure's claims, after it has been made."""
    targets = [f"{results}/figures/{figure}.png", f"{results}/claims/{figure}.csv"]
    result = workspace.snakemake("--cores", "2", *targets, *options)
    assert result.returncode == 0, result.stdout[-20_000:]
    assert (workspace.path / targets[0]).read_bytes().startswith(b"\x89PNG")
    with (workspace.path / targets[1]).open(newline="") as file:
        return [claim["verdict"] for claim in csv.DictReader(file) if claim["kind"] != "family"]


def test_a_figure_of_the_package_is_drawn_and_its_claims_evaluated(workspace):
    assert verdicts(workspace, "results/smoke", "free_path", *SMOKE) == ["agrees"] * 2


def test_a_figure_of_a_module_beside_the_config_is_made_and_made_again_if_the_module_changes(workspace):
    options = ("--configfile", "moments.yaml")
    assert verdicts(workspace, "results", "fast_particles", *options) == ["agrees"] * 2
    undo = workspace.edit("speed_moments.py", '"number of particles"', '"N"')
    plan = workspace.plan("results/figures/fast_particles.png", *options)
    undo()
    assert plan == {"figure": 1}
    (workspace.path / "speed_moments.py").rename(workspace.path / "away.py")
    result = workspace.snakemake("--dry-run", "--cores", "2", *options)
    assert result.returncode == 2
    assert "figures.fast_particles.module = 'speed_moments.py': must have the figure" in result.stdout
