import pytest
from reproduction.claims.data import judged
from reproduction.families.gravity.data import capacities, columns, with_source

from gaspart.reproduction.families.gravity import claims as gravity


def test_theory_agrees_with_itself():
    for found, count in (
        (gravity.barometric(columns()), 4 + 5),
        (gravity.separation(columns(2)), 7 + 5),
        (gravity.heat_capacity(capacities()), 6),
    ):
        assert len(found) == count
        assert set(judged(found).values()) == {"agrees"}


def source_mixture():
    """The source's mixture as theory has it: halfway to equilibrium."""
    ds = with_source(columns(2)).isel(point=[0, 1, 2])
    ds["exchange_ratio"][2] = 0.6
    return ds


def test_the_source_is_reproduced_by_its_own_numbers():
    for found, before, count in (
        (gravity.barometric(with_source(columns())), 9, 4 + 2),
        (gravity.separation(source_mixture()), 12, 5),
    ):
        assert {verdict for claim, verdict in judged(found).items()} == {"agrees", "reproduced"}
        own = found[before : before + count]
        assert {claim.kind for claim in own} >= {"reproduction", "identity"}


@pytest.mark.parametrize(
    ("statement", "name", "change", "text", "verdict"),
    [
        (gravity.barometric, "collisions", 2e5, "collisions until", "disagrees"),
        (gravity.barometric, "temperature", 0.05, "over the source's, in its sample", "disagrees"),
        (gravity.barometric, "ringing", 0.02, "amplitude of the oscillation", "source in error"),
        (gravity.separation, "share", 0.04, "share of light discs", "disagrees"),
        (gravity.separation, "exchange_ratio", 0.4, "mixture at the end", "disagrees"),
        (gravity.separation, "species_temperature_ratio", 0.02, "temperature of the heavy", "disagrees"),
    ],
)
def test_each_claim_about_the_source_can_fail(statement, name, change, text, verdict):
    ds = with_source(columns()) if statement is gravity.barometric else source_mixture()
    ds[name] = ds[name] + change
    found = judged(statement(ds))
    assert verdict in {verdict for claim, verdict in found.items() if text in claim}


@pytest.mark.parametrize(
    ("statement", "name", "change", "text"),
    [
        (gravity.barometric, "slope_ratio", 0.02, "slope of the chemical"),
        (gravity.barometric, "temperature_gradient", 0.02, "temperature against height"),
        (gravity.barometric, "imbalance", 1e-6, "gain of momentum"),
        (gravity.barometric, "mean_height_ratio", 0.06, "mean height"),
        (gravity.barometric, "range_ratio", -0.02, "pressure that carries"),
        (gravity.separation, "exchange_ratio", 0.02, "slope of ln(heavy/light)"),
        (gravity.separation, "species_temperature_ratio", 0.02, "temperature of the heavy"),
        (gravity.separation, "slope_ratio", 0.02, "of the heavy"),
    ],
)
def test_each_claim_about_columns_can_fail(statement, name, change, text):
    ds = columns(1 if statement is gravity.barometric else 2)
    ds[name] = ds[name] + change
    found = judged(statement(ds))
    assert "disagrees" in {verdict for claim, verdict in found.items() if text in claim}


@pytest.mark.parametrize(("name", "text"), [("slope", "dE/dT"), ("fluctuation", "fluctuations")])
def test_each_claim_about_heat_can_fail(name, text):
    ds = capacities()
    ds[name] = ds[name] * 1.1
    found = judged(gravity.heat_capacity(ds))
    assert {verdict for claim, verdict in found.items() if text in claim} == {"disagrees"}


def test_too_short_runs_are_inconclusive():
    found = judged(gravity.barometric(columns(error=0.05)))
    assert {
        verdict for claim, verdict in found.items() if "balance" not in claim and "gain" not in claim
    } == {"inconclusive"}
