import pytest
from reproduction.families.driven_gas.test_claims import verdicts
from reproduction.families.settling.data import settled

from gaspart.reproduction.families.settling.claims import settling


def test_right_data_agree():
    assert verdicts(settling(settled())) == {"agrees"}


@pytest.mark.parametrize(
    ("wrong", "claim"),
    [
        ({"contacts": 3.0}, "contacts of a disc"),
        ({"contacts": 1.5}, "contacts of a disc"),
        ({"displacement": 1e-3}, "largest displacement"),
        ({"rise": 1e-3}, "largest rise"),
        ({"residual": 3.0}, "kinetic energy"),
        ({"head": 1.2}, "ln of the rate"),
        ({"exponent": 1.0}, "exponent"),
        ({"exponent": 2.5}, "exponent"),
    ],
)
def test_wrong_data_disagree(wrong, claim):
    assert "disagrees" in verdicts(settling(settled(**wrong)), claim)


def test_another_law_leaves_deviations():
    assert verdicts(settling(settled(exponent=2.5)), "deviations") == {"disagrees"}


def test_an_exponent_that_is_not_known_well_is_inconclusive():
    assert verdicts(settling(settled(spread=0.1)), "exponent") == {"inconclusive"}
