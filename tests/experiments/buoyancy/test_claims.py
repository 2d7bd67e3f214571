import pytest
from claims.data import judged
from experiments.buoyancy.data import measurement

from gaspart.experiments.buoyancy import claims as buoyancy


def test_theory_agrees_with_itself():
    found = judged(buoyancy.buoyancy(measurement()))
    assert len(found) == 4 + 2 + 2
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("name", "change", "text"),
    [
        ("fixed_count_radius", 0.4, "small discs missing, height"),
        ("fixed_missing", 1.5, "over the weight"),
        ("fixed_force_radius", 0.4, "by the force"),
        ("fixed_force_radius", -0.5, "by the force"),
        ("free_height", 5.0, "of mass 5"),
        ("free_height", 5.0, "displaces less"),
    ],
)
def test_each_claim_can_fail(name, change, text):
    ds = measurement()
    ds[name] = ds[name] + change
    found = judged(buoyancy.buoyancy(ds))
    assert "disagrees" in {verdict for claim, verdict in found.items() if text in claim}


def test_too_short_runs_are_inconclusive():
    found = judged(buoyancy.buoyancy(measurement(error=0.6)))
    assert {verdict for claim, verdict in found.items() if "radius" in claim} == {"inconclusive"}
