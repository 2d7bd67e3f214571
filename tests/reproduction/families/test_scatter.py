"""The scatter of made-up claims, whose uncertainties are right or wrong."""

from __future__ import annotations

import numpy as np
import pytest
from reproduction.claims.data import claim
from reproduction.families.drawn import draw

from gaspart.reproduction import claims
from gaspart.reproduction.claims import UNVERIFIED, Estimate
from gaspart.reproduction.families.scatter.claims import claims_scatter as claims_of
from gaspart.reproduction.families.scatter.figure import claims_scatter as drawn
from gaspart.reproduction.families.scatter.measure import claims_scatter

FIGURES = [f"figure_{n}" for n in range(16)]


def tables(folder, scale=1.0, bias=0.0, shift=0.0):
    """Ten values of each of 16 figures, whose deviations scatter by `scale` about `bias`, those of the first
    figure about `shift` beyond; and what is not to be counted."""
    paths = []
    rng = np.random.default_rng(7)
    for name in FIGURES:
        middle = bias + shift * (name == FIGURES[0])
        found = [
            claim(1.0 + 0.01 * (middle + scale * z), text=f"Z at {n}")
            for n, z in enumerate(rng.standard_normal(10))
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
        ({}, ["agrees", "agrees", "agrees"]),
        ({"scale": 0.6}, ["disagrees", "disagrees", "agrees"]),
        ({"scale": 1.5}, ["disagrees", "disagrees", "agrees"]),
        ({"bias": 0.9, "scale": 0.45}, ["agrees", "disagrees", "disagrees"]),
        ({"bias": 0.5}, ["agrees", "agrees", "disagrees"]),
    ],
)
def test_only_deviations_as_large_as_stated_agree(tmp_path, changes, verdicts):
    ds = claims_scatter(tables(tmp_path, **changes), {})
    assert ds["number"].values.tolist() == [10] * 16
    assert ds.sizes["claim"] == 176 and int(ds["scattered"].sum()) == 160
    assert int(ds["counts"].sum()) == 160
    assert claims.judge(claims_of(ds)) == verdicts


def test_the_mean_allows_for_values_of_one_figure_that_deviate_together(tmp_path):
    """All values of one figure of 16 are 8 standard deviations high: independent ones would differ."""
    ds = claims_scatter(tables(tmp_path, shift=8.0), {})
    mean = claims_of(ds)[-1].measured
    assert mean.value == pytest.approx(float(ds["deviation"].values[ds["scattered"].values].mean()))
    assert mean.value > 3.0 / np.sqrt(160.0)
    assert mean.deviation < 2.0


def test_one_figure_has_no_error_of_the_mean(tmp_path):
    mean = claims_of(claims_scatter(tables(tmp_path)[:1], {}))[-1]
    assert claims.judge([mean]) == ["inconclusive"]


def test_a_run_without_claims_has_nothing_to_state(tmp_path):
    path = tmp_path / "empty.csv"
    claims.write(path, "empty", [])
    ds = claims_scatter([path], {})
    assert ds.sizes["claim"] == 0 and claims_of(ds) == []
    assert len(draw(drawn, ds).axes) == 2


def test_each_figure_has_a_row_of_its_deviations(tmp_path):
    ds = claims_scatter(tables(tmp_path), {})
    upper, lower = draw(drawn, ds).axes
    assert [text.get_text() for text in lower.get_yticklabels()] == FIGURES
    assert "160" in upper.get_legend().get_texts()[1].get_text()
