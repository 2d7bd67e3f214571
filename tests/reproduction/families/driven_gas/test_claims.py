import pytest
from reproduction.families.driven_gas.data import driven
from reproduction.families.judged import verdicts

from gaspart.reproduction.families.driven_gas.claims import driven_gas


def test_right_data_agree():
    assert verdicts(driven_gas(driven())) == {"agrees"}


@pytest.mark.parametrize(
    ("wrong", "claim"),
    [
        ({"temperature": 1.05}, "steady temperature"),
        ({"cumulant": 0.02}, "fourth cumulant"),
        ({"given": 1.01}, "energy given"),
    ],
)
def test_wrong_data_disagree(wrong, claim):
    claims = driven_gas(driven(**wrong))
    assert verdicts(claims, claim) == {"disagrees"}
    assert verdicts([one for one in claims if not one.claim.startswith(claim)]) == {"agrees"}
