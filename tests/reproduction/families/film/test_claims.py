import pytest
from reproduction.claims.data import judged
from reproduction.families.film.data import slits

from gaspart.reproduction.families.film import claims as film


def verdicts(dataset):
    return judged(film.thin_film(dataset))


def verdict(found, text):
    return next(verdict for claim, verdict in found.items() if text in claim)


def test_slits_as_theory_says_agree():
    found = verdicts(slits())
    assert len(found) == 6
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("name", "factor", "text"),
    [
        ("contact", 1.05, "on it, width 12"),
        ("contact", 1.02, "all widths"),
        ("pressure", 1.02, "bulk's at the density"),
        ("chemical_potential", 1.04, "by insertion"),
    ],
)
def test_each_claim_can_fail(name, factor, text):
    dataset = slits()
    dataset[name] = dataset[name] * factor
    assert verdict(verdicts(dataset), text) == "disagrees"


def test_a_solvation_pressure_unlike_the_functionals_is_found():
    dataset = slits()
    dataset["at_bulk"] = 1.5 * dataset["at_bulk"] - 0.5 * dataset.attrs["bulk_pressure"]
    assert verdict(verdicts(dataset), "over that of the density functional") == "disagrees"


def test_another_period_is_found():
    dataset = slits()
    dataset.attrs["period"] = 1.3
    assert verdict(verdicts(dataset), "period") == "disagrees"


def test_few_widths_claim_no_oscillation():
    assert len(verdicts(slits().isel(width=[1, 2, 6]))) == 4
