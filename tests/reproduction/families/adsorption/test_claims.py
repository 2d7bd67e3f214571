import pytest
from reproduction.claims.data import judged
from reproduction.families.adsorption.data import walls

from gaspart.reproduction.families.adsorption import claims as adsorption


def verdicts(dataset):
    return judged(adsorption.adsorption(dataset))


def verdict(found, text):
    return next(verdict for claim, verdict in found.items() if text in claim)


def test_walls_as_theory_says_agree():
    found = verdicts(walls())
    assert len(found) == 11
    assert set(found.values()) == {"agrees"}


def test_a_thermal_wavelength_is_found():
    found = verdicts(walls(power=-0.5))
    assert verdict(found, "power of T in h") == "disagrees"
    assert verdict(found, "slope of ln") == "disagrees"


def test_a_coverage_that_follows_henrys_law_is_found():
    assert verdict(verdicts(walls(coverage_power=1.0)), "power of the gas' density") == "disagrees"


@pytest.mark.parametrize(
    ("name", "kind", "change", "text"),
    [
        ("length", "ideal", 0.01, "over the well's width"),
        ("filling", "layer", 0.06, "coverage over that of hard discs"),
        ("slow_share", "ideal", 0.02, "wells: share"),
        ("slow_share", "sticky", 0.3, "slow particles that leave"),
    ],
)
def test_each_claim_can_fail(name, kind, change, text):
    dataset = walls()
    dataset[name] = dataset[name] + change * (dataset["kind"] == kind)
    assert verdict(verdicts(dataset), text) == "disagrees"
