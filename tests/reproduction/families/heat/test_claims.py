import pytest
import xarray as xr
from reproduction.claims.data import judged
from reproduction.families.heat.data import gases, metals

from gaspart.reproduction.families.heat import claims as heat


def test_theory_agrees_with_itself():
    found = judged(heat.heat_conduction_gas(gases()))
    assert len(found) == 5 * 3 + 4 + 3
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("name", "factor", "text"),
    [
        ("imbalance", 1e8, "transferred heat"),
        ("wall_ratio", 1.02, "flux into the cold"),
        ("half_ratio", 1.02, "second over that in the first"),
        ("flux", 1.1, "flux over n (d + 1)"),
        ("flux", 1.1, "flux over that of theory"),
        ("profile_ratio", 1.03, "temperature away"),
        ("jump", 1.3, "temperature jump"),
    ],
)
def test_each_claim_can_fail(name, factor, text):
    ds = gases()
    ds[name] = ds[name] * factor
    found = judged(heat.heat_conduction_gas(ds))
    assert {verdict for claim, verdict in found.items() if text in claim} == {"disagrees"}


def test_the_shares_of_the_source_are_not_those_of_full_accommodation():
    ds = gases()
    ds["flux"] = ds["full"]
    found = judged(heat.heat_conduction_gas(ds))
    wrong = {claim for claim, verdict in found.items() if verdict == "disagrees" and "normal" in claim}
    assert len(wrong) == 2


def test_too_short_runs_are_inconclusive():
    found = judged(heat.heat_conduction_gas(gases(error=0.3)))
    assert {verdict for claim, verdict in found.items() if "transferred heat" not in claim} == {
        "inconclusive"
    }


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("share", "electrons around it"),
        ("mode_ratio", "mean energy of a mode over kT"),
        ("energy_ratio", "E / T over"),
        ("log_fluctuation", "var E"),
        ("bend", "second-order"),
        ("slope", "dE/dT"),
    ],
)
def test_each_claim_about_metals_can_fail(name, text):
    ds = metals()
    assert set(judged(heat.heat_conduction_metal(ds)).values()) == {"agrees"}
    ds[name] = ds[name] + 0.1
    found = judged(heat.heat_conduction_metal(ds))
    assert {verdict for claim, verdict in found.items() if text in claim} == {"disagrees"}


@pytest.mark.parametrize(("ratio", "verdict"), [(0.98, "disagrees"), (1.05, "agrees"), (1.12, "disagrees")])
def test_a_grid_conducts_a_little_better_than_random_scatterers(ratio, verdict):
    ds = metals()
    ds["flux"] = ds["flux"][0] * xr.where(ds["regular"], ratio, 1.0)
    found = judged(heat.heat_conduction_metal(ds))
    assert [got for claim, got in found.items() if claim.startswith("flux among")] == [verdict]


def test_the_profile_of_a_gas_disagrees_and_that_of_other_gaps_is_not_claimed():
    ds = metals()
    ds["bend"] = ds["bend"] - 0.17
    text = "second-order coefficient"
    (found,) = (verdict for claim, verdict in judged(heat.heat_conduction_metal(ds)).items() if text in claim)
    assert found == "disagrees"
    for name, value in (("gap_over_path", 5.0), ("hot", 1.5)):
        others = metals()
        others[name] = xr.where(others["hot"] > others["cold"], value, others[name])
        assert not [claim for claim in judged(heat.heat_conduction_metal(others)) if text in claim]


def test_random_scatterers_alone_are_not_compared_with_a_grid():
    ds = metals().isel(point=slice(3))
    assert not [claim for claim in judged(heat.heat_conduction_metal(ds)) if "grid" in claim]
