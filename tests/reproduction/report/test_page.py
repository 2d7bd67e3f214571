"""What the page is filled with."""

from pathlib import Path

import numpy as np
from PIL import Image

from gaspart.reproduction.families.registry import chapter, families, titles
from gaspart.reproduction.report.page import (
    CHAPTERS,
    Section,
    address,
    by_chapter,
    films,
    findings,
    headline,
    picture,
)

ROW = {"figure": "cooling", "claim": "rate of cooling, discs", "measured": 0.93, "uncertainty": 0.02}


def claim(kind, verdict):
    return {"kind": kind, "verdict": verdict}


def test_every_family_is_in_a_chapter_of_the_page():
    assert {chapter(family) for family in titles()} == set(CHAPTERS)
    figures = families() | {"mine": "own"}
    sections = [Section(figure, family, None, [], [], "", []) for figure, family in figures.items()]
    found = by_chapter(sections)
    assert list(found) == list(CHAPTERS)
    assert sorted(one.name for own in found.values() for one in own) == sorted(figures)


def test_findings_state_the_measured_number_of_their_figure():
    chosen = [
        {"figure": "cooling", "text": "It cools at {{rate of cooling}}."},
        {"figure": "absent", "text": "No figure of this config."},
    ]
    (finding,) = findings(chosen, [ROW, ROW | {"figure": "other"}])
    assert finding == {"figure": "cooling", "text": "<p>It cools at 0.93(2).</p>"}


def test_the_first_screen_counts_kinds_apart_and_names_what_disagrees():
    rows = [claim("test", "agrees"), claim("test", "disagrees"), claim("family", "disagrees")]
    found = headline(rows)
    assert found["kinds"] == {"test": {"agrees": 1, "disagrees": 1}, "family": {"disagrees": 1}}
    assert sum(sum(verdicts.values()) for verdicts in found["kinds"].values()) == len(rows)
    assert found["disagree"] == rows[1:]


def test_the_template_identifies_sources_before_it_cites_them():
    text = (Path(__file__).parents[3] / "workflow/report/report.html.j2").read_text(encoding="utf-8")
    assert 'selectattr("is_source")' in text
    assert text.index('id="sources"') < text.index('id="findings"') < text.index("| cite }}")


def test_pictures_lie_beside_the_page_or_are_in_it(tmp_path):
    path = tmp_path / "figures" / "one.png"
    (path.parent / "journal").mkdir(parents=True)
    Image.fromarray(np.zeros((60, 100, 3), dtype=np.uint8)).save(path, dpi=(144, 144))
    column = Image.fromarray(np.zeros((300, 150, 3), dtype=np.uint8))
    column.save(path.parent / "journal/one.png", dpi=(288, 288))
    beside, within = picture(path, False), picture(path, True)
    assert (beside.large, beside.small) == ("figures/one.svg", "figures/one.png")
    assert beside.narrow == "figures/journal/one.png"
    assert beside.size == within.size == (100, 60)
    assert beside.narrow_size == within.narrow_size == (75, 150)
    assert within.large.startswith("data:image/webp;base64,") and within.narrow != within.large
    for name in ("film", "other"):
        (tmp_path / f"{name}.mp4").write_bytes(name.encode())
    assert address(tmp_path / "film.mp4", True) == "data:video/mp4;base64,ZmlsbQ=="
    paths = [tmp_path / "film.mp4", tmp_path / "other.mp4"]
    assert list(films(paths, False)) == ["film", "other"]
    assert films(paths, True) == {"film": "data:video/mp4;base64,ZmlsbQ=="}
