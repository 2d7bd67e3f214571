import pytest
from reproduction.families.driven_gas.data import driven
from reproduction.families.judged import verdicts

from gaspart import theory
from gaspart.reproduction.families.driven_gas.claims import driven_gas


def test_right_data_agree():
    assert verdicts(driven_gas(driven())) == {"agrees"}


@pytest.mark.parametrize(
    ("wrong", "claim"),
    [
        ({"temperature": 1.01}, "steady temperature"),
        ({"cumulant": 0.01}, "fourth cumulant of the"),
        ({"given": 1.01}, "energy given"),
    ],
)
def test_wrong_data_disagree(wrong, claim):
    claims = driven_gas(driven(**wrong))
    assert verdicts(claims, claim) == {"disagrees"}
    others = [one for one in claims if not one.claim.startswith((claim, "fourth cumulants"))]
    assert verdicts(others) == {"agrees"}


def test_the_cumulants_of_the_cooling_gas_disagree():
    gases = driven()
    for k in range(4):
        e, dimension = float(gases["restitution"][k]), int(gases["dimension"][k])
        gases["cumulant"][k] = theory.finite_size_cumulant(
            theory.fourth_cumulant(e, dimension), 500, dimension
        )
    assert verdicts(driven_gas(gases), "fourth cumulants") == {"disagrees"}
