"""docs/adding-a-figure.md, followed word by word: the new figure is drawn and its claims are evaluated."""

import csv
import re

import pytest
from workspace import ROOT, SMOKE, copy_of_project

pytestmark = [pytest.mark.workflow, pytest.mark.thorough]

BLOCK = re.compile(r'^```\w+ title="(?P<path>[^"]+)"\n(?P<text>.*?)^```$', re.M | re.S)


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    """A copy of the project in which the page has been followed."""
    copy = copy_of_project(tmp_path_factory.mktemp("a new figure"))
    page = (ROOT / "docs/adding-a-figure.md").read_text(encoding="utf-8")
    blocks = list(BLOCK.finditer(page[page.index("## As a part of the package\n") :]))
    assert len({re.sub("/collisions/.*", "/collisions", block["path"]) for block in blocks}) == 3
    for block in blocks:
        file = copy.path / block["path"]
        assert not file.exists()
        file.parent.mkdir(exist_ok=True)
        file.write_text(block["text"], encoding="utf-8")
    return copy


def test_the_new_figure_is_drawn_and_its_claims_evaluated(workspace):
    targets = ["results/smoke/figures/free_path.png", "results/smoke/claims/free_path.csv"]
    result = workspace.snakemake("--cores", "2", *targets, *SMOKE)
    assert result.returncode == 0, result.stdout[-20_000:]
    assert (workspace.path / targets[0]).read_bytes().startswith(b"\x89PNG")
    with (workspace.path / targets[1]).open(newline="") as file:
        claims = list(csv.DictReader(file))
    assert [claim["verdict"] for claim in claims] == ["agrees"] * 3
