"""The scatter of made-up claims, whose uncertainties are right or wrong."""

import numpy as np
import pytest
from reproduction.claims.data import claim
from reproduction.families.drawn import draw

from gaspart.reproduction import claims
from gaspart.reproduction.claims import UNVERIFIED, Estimate
from gaspart.reproduction.families.scatter.claims import claims_scatter as claims_of
from gaspart.reproduction.families.scatter.figure import claims_scatter as drawn
from gaspart.reproduction.families.scatter.measure import claims_scatter


def tables(folder, scale=1.0, bias=0.0):
    """Two figures of 80 values each, whose deviations scatter by `scale`; and what is not to be counted."""
    paths = []
    rng = np.random.default_rng(7)
    for name in ("first", "second"):
        found = [
            claim(1.0 + 0.01 * (bias + scale * z), text=f"Z at {n}")
            for n, z in enumerate(rng.standard_normal(80))
        ]
        found.append(claim(1.2, expected=Estimate(1.0, 0.1), text="with an allowance"))
        found.append(claim(9.0, no_verdict=UNVERIFIED, text="recalled"))
        found.append(claim(1.0, error=np.nan, text="not measured"))
        paths.append(folder / f"{name}.csv")
        claims.write(paths[-1], name, found)
    return paths


@pytest.mark.parametrize(
    ("changes", "verdicts"),
    [
        ({}, ["agrees", "agrees"]),
        ({"scale": 0.6}, ["disagrees", "disagrees"]),
        ({"scale": 1.5}, ["disagrees", "disagrees"]),
        ({"bias": 0.9, "scale": 0.45}, ["agrees", "disagrees"]),
    ],
)
def test_only_deviations_as_large_as_stated_agree(tmp_path, changes, verdicts):
    ds = claims_scatter(tables(tmp_path, **changes), {})
    assert ds["number"].values.tolist() == [80, 80]
    assert ds.sizes["claim"] == 162 and int(ds["scattered"].sum()) == 160
    assert int(ds["counts"].sum()) == 160
    assert claims.judge(claims_of(ds)) == verdicts


def test_a_run_without_claims_has_nothing_to_state(tmp_path):
    path = tmp_path / "empty.csv"
    claims.write(path, "empty", [])
    ds = claims_scatter([path], {})
    assert ds.sizes["claim"] == 0 and claims_of(ds) == []
    assert len(draw(drawn, ds).axes) == 2


def test_each_figure_has_a_row_of_its_deviations(tmp_path):
    ds = claims_scatter(tables(tmp_path), {})
    upper, lower = draw(drawn, ds).axes
    assert [text.get_text() for text in lower.get_yticklabels()] == ["first", "second"]
    assert "160" in upper.get_legend().get_texts()[1].get_text()
