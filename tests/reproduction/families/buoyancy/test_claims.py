import pytest
from reproduction.claims.data import judged
from reproduction.families.buoyancy.data import measurement, with_source

from gaspart.reproduction.families.buoyancy import claims as buoyancy


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


def test_the_source_s_discs_float_or_lie_where_theory_has_them():
    ds = with_source(measurement())
    found = buoyancy.buoyancy(ds)
    assert len(found) == 8 + 6 + 2 + 1
    assert set(judged(found).values()) == {"agrees", "reproduced"}
    assert found[-1].measured.error == pytest.approx(0.3 * 0.005 / 8.0 / 2.0 / 0.2, rel=0.3)


@pytest.mark.parametrize(
    ("which", "name", "change", "text", "verdict"),
    [
        (3, "height", 2.0, "source's disc of mass", "disagrees"),
        (0, "height", -4.0, "below the ceiling", "disagrees"),
        (9, "height", 4.0, "above the floor", "disagrees"),
        (slice(None), "density", 0.02, "in the middle", "source in error"),
    ],
)
def test_each_claim_about_the_source_can_fail(which, name, change, text, verdict):
    ds = with_source(measurement())
    ds[f"source_{name}"][which] += change
    found = judged(buoyancy.buoyancy(ds))
    assert verdict in {verdict for claim, verdict in found.items() if text in claim}


def test_too_short_runs_are_inconclusive():
    found = judged(buoyancy.buoyancy(measurement(error=0.6)))
    assert {verdict for claim, verdict in found.items() if "radius" in claim} == {"inconclusive"}
