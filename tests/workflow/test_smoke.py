"""The small workflow, all of it: figures, claims with verdicts, the report, and the physics bit for bit."""

import csv
import json
from pathlib import Path

import pytest
from browser import CHROMIUM, found_by
from digests import digests

from gaspart.claims import KINDS, VERDICTS
from gaspart.experiments.registry import families
from gaspart.yaml_text import read_yaml

pytestmark = pytest.mark.workflow

ROOT = Path(__file__).parents[2]
FIGURES = list(read_yaml(ROOT / "config/config.yaml")["figures"])


def test_every_figure_of_the_table_is_in_the_config():
    assert set(FIGURES) == set(families())


@pytest.mark.parametrize("figure", FIGURES)
def test_every_figure_is_drawn_twice_and_has_a_claim_with_a_verdict(smoke, figure):
    results = smoke.path / "results"
    png = (results / f"figures/{figure}.png").read_bytes()
    assert png.startswith(b"\x89PNG")
    assert len(png) > 5_000
    assert "<svg" in (results / f"figures/{figure}.svg").read_text()
    with (results / "tables/claims.csv").open(newline="") as file:
        claims = [row for row in csv.DictReader(file) if row["figure"] == figure]
    assert claims
    for claim in claims:
        assert claim["verdict"] in VERDICTS
        assert claim["kind"] in KINDS
        assert claim["why"] or claim["verdict"] in ("agrees", "reproduced", "disagrees")
        assert claim["fails_if"]


def test_the_report_holds_every_figure_and_needs_no_other_file(smoke):
    page = (smoke.path / "results/report.html").read_text()
    for figure in FIGURES:
        assert f'<section id="{figure}">' in page
    assert 'src="data:image/svg+xml;base64,' in page
    assert "http://" not in page.split("</style>")[1].split("data:image")[0]
    assert 'name="viewport"' in page


CLICKS = """
const table = document.querySelector("table.sortable"), rows = () => [...table.tBodies[0].rows];
const heads = [...table.querySelectorAll("th button")];
const deviations = () => rows().map(row => row.cells[heads.findIndex(
  head => head.textContent === "deviation")].dataset.value).filter(text => text !== "").map(Number);
const deviation = heads.find(head => head.textContent === "deviation");
const before = rows().length;
deviation.click(); const up = deviations();
deviation.click(); const down = deviations();
const agrees = [...document.querySelectorAll("#filter button")].find(one => one.dataset.verdict === "agrees");
agrees.click();
return {
  before, up, down, after: rows().length, width: document.documentElement.scrollWidth,
  shown: rows().filter(row => !row.hidden).map(row => row.dataset.verdict),
  images: [...document.images].map(image => image.naturalWidth),
  films: document.querySelectorAll("video").length,
  font: Math.min(...[...document.querySelectorAll("p, td, figcaption")].map(
    one => parseFloat(getComputedStyle(one).fontSize))),
  broken: [...document.querySelectorAll('a[href^="#"]')].filter(
    link => !document.getElementById(link.hash.slice(1))).length,
};
"""


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here to click through the report with")
@pytest.mark.parametrize("width", [390, 1280])
def test_the_report_reads_and_clicks_on_a_phone_and_on_a_desk(smoke, tmp_path, width):
    found = found_by(CLICKS, smoke.path / "results/report.html", tmp_path, width)
    with (smoke.path / "results/tables/claims.csv").open(newline="") as file:
        claims = list(csv.DictReader(file))
    assert found["before"] == found["after"] == len(claims)
    assert found["up"] == sorted(found["up"]) and found["down"] == sorted(found["up"], reverse=True)
    assert found["up"][0] < found["up"][-1]
    assert found["shown"] == ["agrees"] * sum(row["verdict"] == "agrees" for row in claims)
    assert len(found["images"]) == len(FIGURES) and min(found["images"]) > 0
    assert found["films"] == len(list((smoke.path / "results/animations").iterdir()))
    assert found["width"] <= width and found["font"] >= 12.0
    assert found["broken"] == 0


def test_films_are_made(smoke):
    (film,) = (smoke.path / "results/animations").iterdir()
    assert film.name == "relaxation.mp4" and film.stat().st_size > 5_000


def test_nothing_half_written_is_left(smoke):
    assert not list((smoke.path / "results").rglob("*.partial"))


def test_the_simulations_are_these_bits(smoke):
    """Made anew by: python tests/workflow/digests.py results/smoke/points > tests/workflow/digests.json"""
    known = json.loads((Path(__file__).parent / "digests.json").read_text())
    assert digests(smoke.path / "results/smoke/points") == known
