import pytest
from reproduction.families.granular.data import inelastic, rough
from reproduction.families.judged import verdicts

from gaspart.reproduction.families.granular.claims import cooling, equipartition


def test_right_data_agree():
    assert verdicts(equipartition(rough())) == {"agrees"}
    assert verdicts(cooling(inelastic())) == {"agrees"}


def test_a_rate_that_does_not_show_the_cumulant_is_inconclusive():
    gases = inelastic()
    gases["rate_error"] = 10.0 * gases["rate_error"]
    undecided = [claim.claim for claim in cooling(gases) if not claim.has_power]
    assert len(undecided) == 2 and all(
        "restitution 0.7" in text for text in undecided
    )  # it is nearly 0 there


@pytest.mark.parametrize(
    ("wrong", "beginning"),
    [
        ({"rate": 1.04}, "initial decay"),
        ({"rate": 1.2}, "T_tr - T_rot minus"),
        ({"ratio": 1.02}, "T_rot / T_tr of rough discs"),
        ({"steady": 0.85}, "T_rot / T_tr of cooling discs"),
        ({"exchange": 0.97}, "energy that the first hits turn into spin"),
        ({"mixed": 1.03}, "T_rot / T_tr along the walls"),
    ],
)
def test_wrong_shares_are_found(wrong, beginning):
    assert "disagrees" in verdicts(equipartition(rough(**wrong)), beginning)


def test_a_gas_with_fewer_frames_than_another_is_judged_too():
    gases = rough()
    frames = gases.sizes["frame"]
    longer = gases.pad(frame=(0, 2))  # as beside one with two more
    assert longer.sizes["frame"] == frames + 2
    assert verdicts(equipartition(longer)) == {"agrees"}


def test_wrong_cooling_is_found():
    assert "disagrees" in verdicts(cooling(inelastic(rate=1.03)), "-d ln T")
    assert "disagrees" in verdicts(cooling(inelastic(exponent=-1.9)), "exponent")
    assert verdicts(cooling(inelastic(clustered=False)), "ln of variance") == {"disagrees"}
    assert verdicts(cooling(inelastic(clustered=False)), "ln of T over") == {"disagrees"}
