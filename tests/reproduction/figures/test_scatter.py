"""The scatter of made-up claims, whose uncertainties are right or wrong."""

import numpy as np
import pytest
from reproduction.claims.data import claim
from reproduction.figures.drawn import draw

from gaspart.reproduction import claims
from gaspart.reproduction.claims import UNVERIFIED, Estimate
from gaspart.reproduction.figures import scatter


def measured(folder, scale=1.0, bias=0.0, shift=0.0, figures=16):
    """Ten values of each figure, whose deviations scatter by `scale` about `bias`, those of the first figure
    about `shift` beyond; and what is not to be counted."""
    paths, rng = [], np.random.default_rng(7)
    for k in range(figures):
        middle = bias + shift * (k == 0)
        found = [claim(1.0 + 0.01 * (middle + scale * z), text=f"Z at {z}") for z in rng.standard_normal(10)]
        found.append(claim(1.2, expected=Estimate(1.0, 0.1), text="with an allowance"))
        found.append(claim(9.0, no_verdict=UNVERIFIED, text="recalled"))
        found.append(claim(1.0, error=np.nan, text="not measured"))
        paths.append(folder / f"figure_{k}.csv")
        claims.write(paths[-1], f"figure_{k}", found)
    return scatter.measure(paths, {})


@pytest.mark.parametrize(
    ("changes", "verdicts"),
    [
        ({}, ["agrees", "agrees", "agrees"]),
        ({"scale": 0.6}, ["disagrees", "disagrees", "agrees"]),
        ({"scale": 1.5}, ["disagrees", "disagrees", "agrees"]),
        ({"bias": 0.9, "scale": 0.45}, ["agrees", "disagrees", "disagrees"]),
        ({"bias": 0.5}, ["agrees", "agrees", "disagrees"]),
        ({"figures": 1}, ["agrees", "agrees", "inconclusive"]),
    ],
)
def test_only_deviations_as_large_as_stated_agree(tmp_path, changes, verdicts):
    ds = measured(tmp_path, **changes)
    figures = changes.get("figures", 16)
    assert ds["number"].values.tolist() == [10] * figures and ds.sizes["claim"] == 11 * figures
    assert int(ds["scattered"].sum()) == int(ds["counts"].sum()) == 10 * figures
    assert claims.judge(list(scatter.claims(ds))) == verdicts


def test_the_mean_allows_for_values_of_one_figure_that_deviate_together(tmp_path):
    """All values of one figure of 16 are 8 standard deviations high: independent ones would differ."""
    ds = measured(tmp_path, shift=8.0)
    mean = list(scatter.claims(ds))[-1].measured
    assert mean.value == pytest.approx(float(ds["deviation"].values[ds["scattered"].values].mean()))
    assert mean.value > 3.0 / np.sqrt(160.0) and mean.deviation < 2.0


def test_a_run_without_claims_has_nothing_to_state(tmp_path):
    claims.write(tmp_path / "empty.csv", "empty", [])
    ds = scatter.measure([tmp_path / "empty.csv"], {})
    assert ds.sizes["claim"] == 0 and list(scatter.claims(ds)) == []
    assert len(draw(scatter.draw, ds).axes) == 2
