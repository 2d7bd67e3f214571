import numpy as np
import pytest
from reproduction.claims.data import judged
from reproduction.families.transport.data import growing, measured

from gaspart.reproduction.families.transport import claims as transport


@pytest.mark.parametrize("figure", ["viscosity", "conductivity"])
def test_enskogs_coefficients_agree(figure):
    found = judged(getattr(transport, figure)(measured()))
    assert len(found) == 2 + 2 + 6 + (6 if figure == "viscosity" else 0)
    assert set(found.values()) <= {"agrees", "no verdict"}


@pytest.mark.parametrize(
    ("name", "factor", "point", "text"),
    [
        ("value", 1.03, 0, "Chapman"),
        ("value", 0.97, 4, "Chapman"),
        ("value", 1.09, 1, "over Enskog's"),
        ("difference", None, 3, "Helfand"),
        ("bulk", 0.93, 1, "bulk"),
    ],
)
def test_each_claim_can_fail(name, factor, point, text):
    ds = measured()
    values = ds[name].values.copy()
    values[point] = 0.1 if factor is None else factor * values[point]
    found = judged(transport.viscosity(ds.assign({name: (ds[name].dims, values)})))
    assert "disagrees" in {verdict for claim, verdict in found.items() if text in claim}


def test_noise_is_inconclusive():
    found = judged(transport.viscosity(measured(error=0.05)))
    assert {verdict for claim, verdict in found.items() if "Chapman" in claim} == {"inconclusive"}
    assert np.isfinite(measured()["value"].values).all()


def test_growth_by_the_modes_agrees():
    found = judged(transport.logarithmic_growth(growing()))
    assert len(found) == 2 and set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("change", "verdict"), [({"growth": 0.0}, "disagrees"), ({"error": 0.6}, "inconclusive")]
)
def test_plateaus_disagree_and_noise_is_inconclusive(change, verdict):
    assert set(judged(transport.logarithmic_growth(growing(**change))).values()) == {verdict}


def test_bulk_viscosity_of_discs_has_a_verdict_in_dilute_gases_only():
    """Its integral grows with the logarithm of time."""
    found = judged(transport.viscosity(measured()))
    discs = {claim: verdict for claim, verdict in found.items() if "bulk" in claim and "discs" in claim}
    assert len(discs) > 1
    for claim, verdict in discs.items():
        assert verdict == ("agrees" if "fraction 0.01," in claim else "no verdict"), claim
