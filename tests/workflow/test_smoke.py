"""The small workflow, all of it: figures, claims with verdicts, the report, and the physics bit for bit."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from browser import CHROMIUM, found_by
from digests import digests, known
from reproduction.figures.stored_data import stored

from gaspart.reproduction import job_time
from gaspart.reproduction.claims import CLAIM_KINDS, VERDICTS
from gaspart.reproduction.config import merged_with_default
from gaspart.reproduction.cost import budgets
from gaspart.reproduction.registry import families

pytestmark = pytest.mark.workflow

ROOT = Path(__file__).parents[2]
ALL, _ = merged_with_default(ROOT / "config/config.yaml")


def test_every_figure_of_the_table_is_in_the_config():
    assert set(ALL["figures"]) == set(families())


def jobs(config):
    """The kinds of jobs of a config's figures."""
    shown = {name for block in config["figures"].values() for name in block["experiments"]}
    return {config["experiments"][name].get("job", "simulate") for name in shown}


def test_the_run_has_each_kind_of_job(smoke):
    whole, _ = merged_with_default(ROOT / "config/smoke.yaml")
    assert jobs(smoke.config) == jobs(whole)


def test_every_figure_is_drawn_twice_and_has_a_claim_with_a_verdict(smoke):
    results = smoke.path / "results/smoke"
    for figure in smoke.figures:
        png = (results / f"figures/{figure}.png").read_bytes()
        assert png.startswith(b"\x89PNG")
        assert len(png) > 5_000
        assert "<svg" in (results / f"figures/{figure}.svg").read_text()
    with (results / "tables/claims.csv").open(newline="") as file:
        claims = list(csv.DictReader(file))
    assert {claim["figure"] for claim in claims} == set(smoke.figures)
    for claim in claims:
        assert claim["verdict"] in VERDICTS
        assert claim["kind"] in CLAIM_KINDS
        assert claim["why"] or claim["verdict"] in ("agrees", "reproduced", "disagrees")
        assert claim["fails_if"]


UNTIMED = {"simulate", "fill", "pack", "echo"}
"""Kinds of jobs of which nothing depends on the speed of the machine."""


def test_the_measured_numbers_are_those_of_the_stored_data(smoke):
    """Where measuring is meant to change, `stored_data.py` stores the data sets anew."""
    experiments, wrong, compared = smoke.config["experiments"], [], 0
    for figure in smoke.figures:
        names = smoke.config["figures"][figure]["experiments"]
        if not names or {experiments[name].get("job", "simulate") for name in names} - UNTIMED:
            continue
        compared += 1
        with xr.open_dataset(smoke.path / f"results/smoke/measurements/{figure}.nc") as found:
            wrong += [(figure, name) for name in other_numbers(stored(figure), found)]
    assert compared and not wrong


def other_numbers(right, found):
    """The variables of a data set that are not in another, or differ by more than rounding."""
    names = set(right.variables) & set(found.variables)
    for name in names:
        one, other = right[name].values, found[name].values
        if one.dtype.kind not in "fiub":
            same = one.shape == other.shape and (one == other).all()
        else:
            one, other = one.astype(float), other.astype(float)
            size = np.abs(one[np.isfinite(one)]).max(initial=0.0)
            same = one.shape == other.shape and np.allclose(one, other, 1e-5, 1e-7 * size, equal_nan=True)
        if not same:
            yield name
    yield from set(right.variables) ^ set(found.variables)


def test_the_budget_has_the_time_and_the_decided_claims_of_every_figure(smoke, monkeypatch):
    monkeypatch.chdir(smoke.path)
    found = {one.figure: one for one in budgets("config/smoke.yaml")}
    assert set(found) == set(smoke.figures)
    logs = Path("results/smoke/logs")
    names = [log.relative_to(logs).with_suffix("").parts for log in logs.rglob("*.log")]
    assert len(names) > 5 * len(found)
    used = {name: job_time.read_used(logs.parent, *name) for name in names}
    assert not [name for name, one in used.items() if not (one and one.seconds >= 0.0 and one.memory > 1.0)]
    assert sum(one.seconds > 0.0 for one in used.values()) > 0.9 * len(used)  # clocks tick every 10 ms
    with (smoke.path / "results/smoke/tables/claims.csv").open(newline="") as file:
        verdicts = {(row["figure"], row["claim"]): row["verdict"] for row in csv.DictReader(file)}
    for figure, one in found.items():
        assert one.seconds > 0.0
        assert 0.0 <= one.shared <= one.seconds
        for need in one.needs:
            assert need.verdict == verdicts[figure, need.claim]
            assert (need.multiple > 1.0) <= (need.verdict in ("inconclusive", "disagrees", "source in error"))


def test_every_figure_is_drawn_for_a_column_of_a_journal_and_is_legible(smoke):
    results = smoke.path / "results/smoke"
    for figure in smoke.figures:
        assert (results / f"figures/journal/{figure}.png").stat().st_size > 5_000
    journal = results / "figures/journal"
    assert [path.name for path in journal.glob("*.pdf")] == ["virial_discs.pdf"]  # on request
    assert (journal / "virial_discs.pdf").read_bytes().startswith(b"%PDF")
    logs = list((results / "logs/figure").iterdir())
    assert len(logs) == len(smoke.figures)
    assert not [line for log in logs for line in log.read_text().splitlines() if "not legible" in line]


def test_the_report_holds_every_figure_and_its_pictures_lie_beside_it(smoke):
    path = smoke.path / "results/smoke/report.html"
    page = path.read_text()
    for figure in smoke.figures:
        assert f'<section class="figure" id="{figure}"' in page
    files = set(re.findall(r'(?:src|srcset|href|poster)="([^"#:]+)"', page))
    assert len(files) >= 4 * len(smoke.figures)
    assert not [file for file in files if not (path.parent / file).exists()]
    assert path.stat().st_size < 1.5e6 and 'name="viewport"' in page
    shown = sum((path.parent / file).stat().st_size for file in files)
    assert shown < 1.0e6 * len(smoke.figures)  # four pictures of each


def test_the_report_in_one_file_needs_no_other(smoke):
    path = smoke.path / "results/smoke/report-in-one-file.html"
    addresses = re.findall(r'(?:src|srcset|poster)="([^"]+)"', path.read_text())
    assert len(addresses) > 2 * len(smoke.figures) and all(one.startswith("data:") for one in addresses)
    assert path.stat().st_size < 10e6


CLICKS = """
await new Promise(loaded => addEventListener("load", loaded));
const images = [...document.images];
images.forEach(image => { image.loading = "eager"; });
const seen = image => new Promise(done => { image.onload = image.onerror = done; });
await Promise.all(images.map(image => image.complete || seen(image)));
const table = document.querySelector("table.sortable"), rows = () => [...table.tBodies[0].rows];
const heads = [...table.querySelectorAll("th button")];
const deviations = () => rows().map(row => row.cells[heads.findIndex(
  head => head.textContent === "deviation")].dataset.value).filter(text => text !== "").map(Number);
const deviation = heads.find(head => head.textContent === "deviation");
const before = rows().length;
deviation.click(); const up = deviations();
deviation.click(); const down = deviations();
const choice = value => document.querySelector(`.filter button[value="${value}"]`);
choice("agrees").click();
choice("identity").click();
const both = rows().filter(row => !row.hidden).map(row => `${row.dataset.verdict} ${row.dataset.kind}`);
document.querySelector('.filter[data-key="kind"] button').click();
const dots = [...document.querySelectorAll(".overview .dot")];
const fold = document.getElementById(dots[0].hash.slice(1)).closest("details"), folded = !fold.open;
location.hash = dots[0].hash; open();
const form = document.getElementById("engines"), choices = [...form.querySelectorAll("select")];
const choose = (select, n) => { select.value = n; select.dispatchEvent(new Event("input")); };
const answers = [...choices[0].options].map((_, n) => {
  choose(choices[0], n);
  return [...choices[2].options].map((_, a) => {
    choose(choices[2], a);
    return form.querySelector("output").textContent;
  });
});
const field = form.querySelector('g[data-fraction="0"][data-accuracy="0"]');
field.dispatchEvent(new MouseEvent("click", { bubbles: true }));
return {
  answers, chosen: choices.slice(1).map(select => select.value), fields: form.querySelectorAll("g").length,
  costs: [...form.querySelectorAll("tbody tr")].map(row => row.cells[1].textContent),
  options: choices.map(select => select.options.length), first: document.querySelector("h2").id,
  both, before, up, down, after: rows().length, width: document.documentElement.scrollWidth, folded,
  unfolded: fold.open, dots: dots.length,
  shown: rows().filter(row => !row.hidden).map(row => row.dataset.verdict),
  verdicts: rows().filter(row => !row.hidden).every(row => {
    const box = row.querySelector(".verdict").getBoundingClientRect();
    return box.right <= innerWidth && box.width > 0;
  }),
  images: images.map(image => image.naturalWidth),
  references: document.querySelectorAll(".references li").length,
  posters: [...document.querySelectorAll("video")].every(film => film.poster !== ""),
  films: document.querySelectorAll(".beside video").length,
  font: Math.min(...[...document.querySelectorAll("p, td, figcaption")].map(
    one => parseFloat(getComputedStyle(one).fontSize))),
  broken: [...document.querySelectorAll('a[href^="#"]')].filter(
    link => !document.getElementById(link.getAttribute("href").slice(1))).length,
};
"""


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here to click through the report with")
@pytest.mark.parametrize(
    "smoke", [pytest.param("all figures", marks=pytest.mark.thorough)], indirect=True, scope="session"
)
@pytest.mark.parametrize("width", [390, 1400])
def test_the_report_reads_and_clicks_on_a_phone_and_on_a_desk(smoke, tmp_path, width):
    found = found_by(CLICKS, smoke.path / "results/smoke/report.html", tmp_path, width)
    with (smoke.path / "results/smoke/tables/claims.csv").open(newline="") as file:
        claims = list(csv.DictReader(file))
    assert found["before"] == found["after"] == len(claims)
    assert found["up"] == sorted(found["up"]) and found["down"] == sorted(found["up"], reverse=True)
    assert found["up"][0] < found["up"][-1]
    assert found["shown"] == ["agrees"] * sum(row["verdict"] == "agrees" for row in claims)
    exact = sum((row["verdict"], row["kind"]) == ("agrees", "identity") for row in claims)
    assert found["both"] == ["agrees identity"] * exact and exact
    assert found["verdicts"] and found["folded"] and found["unfolded"]
    assert found["dots"] == sum(row["kind"] != "family" for row in claims)
    assert len(found["images"]) >= 2 * len(smoke.figures) and min(found["images"]) > 0
    assert found["films"] == len(list((smoke.path / "results/smoke/animations").glob("*.mp4")))
    assert found["width"] <= width and found["font"] >= 12.0
    assert found["first"] == "findings" and found["chosen"] == ["0", "0"]
    assert found["fields"] == found["options"][1] * found["options"][2] and all(found["costs"])
    answers = [answer for of in found["answers"] for answer in of]
    assert len(answers) == found["options"][0] * found["options"][2] and "NaN" not in "".join(answers)
    assert any("of processor time" in answer for answer in answers)
    assert found["broken"] == 0 and found["references"] >= 30 and found["posters"]


def test_films_are_made(smoke):
    poster, film = sorted((smoke.path / "results/smoke/animations").iterdir())
    assert (poster.name, film.name) == ("relaxation.jpg", "relaxation.mp4")
    assert min(film.stat().st_size, poster.stat().st_size) > 5_000


def test_nothing_half_written_is_left(smoke):
    assert not list((smoke.path / "results").rglob("*.partial"))


def test_the_simulations_are_these_bits(smoke):
    """Written by: python tests/workflow/digests.py results/smoke/points --renew."""
    made, expected = digests(smoke.path / "results/smoke/points"), known()
    shown = {name for name in expected if name.partition("/")[0] in smoke.config["experiments"]}
    assert made == {name: expected[name] for name in shown}
