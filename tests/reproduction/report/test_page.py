"""What the page is filled with."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
import xarray as xr

from gaspart.reproduction.figures._tradeoff import ENGINES, NAMES, PARTS
from gaspart.reproduction.registry import chapter, families, titles
from gaspart.reproduction.report.explore import engines, series
from gaspart.reproduction.report.page import (
    CHAPTERS,
    LIMIT,
    Caption,
    Section,
    by_chapter,
    deviation,
    dots,
    findings,
    headline,
    split_caption,
)
from gaspart.theory.state import compressibility_factor

ROW = {"figure": "cooling", "claim": "rate of cooling, discs", "measured": 0.93, "uncertainty": 0.02}


def claim(kind, verdict, figure="cooling", uncertainty=0.1):
    text = f"{kind} of {figure}"
    return {"figure": figure, "claim": text, "kind": kind, "verdict": verdict, "uncertainty": uncertainty}


def section(name, rows=(), finding="It cools"):
    return Section(name, "granular", Caption(finding, finding, "", ""), list(rows), [], "", [])


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
    (finding,) = findings(chosen, [section("cooling", [ROW]), section("other", [ROW])])
    assert finding == {"figure": "cooling", "text": "It cools at 0.93(2)."}


def test_a_page_of_other_figures_opens_with_what_they_show():
    shown = findings([{"figure": "absent", "text": "Nothing."}], [section("one"), section("two")])
    assert shown == [{"figure": name, "text": "It cools."} for name in ("one", "two")]


def test_the_first_screen_counts_kinds_apart_and_names_what_disagrees():
    rows = [claim("test", "agrees"), claim("test", "disagrees"), claim("family", "disagrees")]
    found = headline(rows)
    assert found["kinds"] == {"test": {"agrees": 1, "disagrees": 1}, "family": {"disagrees": 1}}
    assert sum(sum(verdicts.values()) for verdicts in found["kinds"].values()) == len(rows)
    assert found["disagree"] == rows[1:]


def test_the_chance_that_true_claims_disagree_is_bounded_by_what_is_judged_together():
    """Two figures with tests, a family, and an identity with an uncertainty: four 3-sigma tests."""
    rows = [claim("test", "agrees"), claim("reproduction", "reproduced"), claim("test", "agrees", "other")]
    rows += [
        claim("family", "agrees"),
        claim("identity", "agrees"),
        claim("identity", "agrees", "other", 0.0),
    ]
    rows += [claim("test", "no verdict", "quoted")]
    assert headline(rows)["chance"] == pytest.approx(4 * 0.0027, rel=1e-3)


# The parts of a caption.


LONG = """**Discs freeze.** (a) Pressure of
discs.

*Theory.* That they do.

*Panels.* (b) *g*\\ (*r*).
"""


def test_a_caption_is_divided():
    parts = split_caption(LONG)
    assert (parts.finding, parts.plain) == ("Discs freeze", "Discs freeze")
    assert "Pressure of\ndiscs" in parts.reading and "<em>g</em>" in parts.reading
    assert "Panels" not in parts.reading and "Theory" in parts.details


def test_a_caption_begins_with_its_finding():
    with pytest.raises(ValueError, match="begins with its finding"):
        split_caption("Discs freeze.")


# Claims on the axis of deviations.


def row(sigma=math.nan, low=math.nan, high=math.nan, measured=1.0):
    return {"deviation_sigma": sigma, "lowest": low, "highest": high, "measured": measured}


@pytest.mark.parametrize(
    ("claim", "place"),
    [
        (row(-1.5), -1.5),
        (row(0.0, 0.8, 1.2, 1.1), 1.5),
        (row(2.0, -math.inf, 1.2, 1.3), 2.0),
        (row(0.0, 0.8, 1.2, math.nan), 0.0),
        (row(), 0.0),
    ],
)
def test_a_value_is_at_its_deviation_and_a_bounded_number_at_its_place(claim, place):
    assert deviation(claim) == pytest.approx(place)


def test_dots_do_not_hide_one_another_and_stay_on_the_axis():
    found = dots([row(0.1), row(0.0), row(0.05), row(99.0), row(-math.inf)])
    assert [dot.position for dot in found] == pytest.approx([0.0, 50.0, 50.5, 51.0, 100.0])
    assert [dot.level for dot in found] == [0, 0, 1, 2, 0]
    assert max(dot.level for dot in dots([row(0.0)] * 20)) == 3
    assert LIMIT > 3.0


# The data of what a reader may choose on the page.


def test_the_series_reach_the_equation_of_state_where_it_is_dilute():
    at = xr.Dataset(
        {"Z": ("packing_fraction", [1.5]), "Z_error": ("packing_fraction", [np.nan])},
        coords={"packing_fraction": [0.1]},
    )
    found = series({"first": at, "second": at}, {"first": (2, 0.65), "second": (3, 0.49)})
    assert [one["name"] for one in found] == ["discs", "spheres"]
    for dimension, one in zip((2, 3), found, strict=True):
        n = np.argmin(np.abs(np.array(one["packing_fraction"]) - 0.1))
        z = float(compressibility_factor(one["packing_fraction"][n], dimension))
        assert one["sums"][0] == [1.0] * 101
        assert one["sums"][9][n] == pytest.approx(z, rel=1e-5) == one["reference"][n]
        assert one["measured"] == [[0.1], [1.5], [None]]
        assert "NaN" not in json.dumps(one)


def test_costs_and_errors_of_all_engines_are_those_of_the_map():
    """Two observables, of which one was measured at one of two packing fractions."""
    shape = (2, 2, 3, len(ENGINES))
    cost = np.arange(1.0, 1.0 + np.prod(shape)).reshape(shape)
    cost[1, 0] = np.nan  # nothing was run
    cost[0, 0, 0, 1], cost[0, 0, 0, 2] = np.inf, np.nan  # out of reach; not run
    error = np.full((*shape, len(PARTS)), 0.00123456)
    error[0, 0, 0, 2] = np.nan
    dims = ("quantity", "fraction", "accuracy", "solver")
    dataset = xr.Dataset(
        {"cost": (dims, cost), "error": ((*dims, "part"), error)},
        coords={
            "quantity": ["Z", "D"],
            "fraction": [0.01, 0.3],
            "accuracy": [0.1, 0.01, 0.001],
            "solver": list(ENGINES),
            "part": list(PARTS),
            "count": [1000, 10000],
        },
    )
    found = engines(dataset)
    assert found["count"] == 1000 and found["accuracies"] == [0.1, 0.01, 0.001]
    assert [one["name"] for one in found["engines"]] == [NAMES[engine] for engine in ENGINES]
    z, d = found["observables"]
    assert (z["name"], z["fractions"], d["fractions"]) == ("compressibility factor Z", [0.01, 0.3], [0.3])
    assert z["cost"][0][0] == [1.0, -1.0, None, 4.0] and d["cost"] == [cost[1, 1].tolist()]
    assert z["error"][0][0][0] == [0.00123] * len(PARTS) and z["error"][0][0][2] == [None] * len(PARTS)
    assert "NaN" not in json.dumps(found) and "Infinity" not in json.dumps(found)
