import numpy as np
import pytest
from reproduction.claims.data import judged
from reproduction.families.mixtures.data import measured

from gaspart.reproduction.families.mixtures.claims import mixture_state


def test_a_gas_of_that_theory_agrees():
    found = judged(mixture_state(measured()))
    verdicts = [verdict for claim, verdict in found.items() if "rms deviation" not in claim]
    assert set(verdicts) == {"agrees", "no verdict"}
    assert sum("virial sum" in claim for claim in found) == 7
    assert sum("contact value" in claim for claim in found) == 3
    assert sum("Z over" in claim for claim in found) == 6
    assert sum("largest deviation" in claim for claim in found) == 4


@pytest.mark.parametrize(
    ("name", "factor", "text"),
    [
        ("Z", 1.004, "Z over"),
        ("contact", 1.03, "contact value of large-small"),
        ("virial", None, "virial sum"),
    ],
)
def test_each_claim_can_fail(name, factor, text):
    ds = measured()
    values = ds[name] * factor if factor else ds[name] + 0.005
    found = judged(mixture_state(ds.assign({name: values})))
    assert "disagrees" in {verdict for claim, verdict in found.items() if text in claim}


def test_boubliks_equation_is_excluded_or_nothing_is_said():
    found = judged(mixture_state(measured(error=2e-3)))
    of_z = {verdict for claim, verdict in found.items() if "Z over Boublik's" in claim}
    assert of_z == {"inconclusive"}
    ds = measured()
    z = ds["Z"].where(ds["dimension"] == 2, 1.00001 * ds["boublik"])
    as_boublik = judged(mixture_state(ds.assign(Z=z)))
    assert "disagrees" in {verdict for claim, verdict in as_boublik.items() if "Z over Boublik's" in claim}


@pytest.mark.parametrize(("theory", "verdict"), [("starling", "reproduced"), ("boublik", "source in error")])
def test_the_comparison_of_1999(theory, verdict):
    ds = measured(error=1e-5)
    z = ds["Z"].where(ds["dimension"] == 2, ds[theory] * (1.0 + 1e-5 * np.arange(ds.sizes["point"])))
    found = judged(mixture_state(ds.assign(Z=z)))
    assert {found[claim] for claim in found if "rms deviation" in claim} == {verdict}
