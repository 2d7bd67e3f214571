import pytest
from reproduction.families.judged import verdicts
from reproduction.families.vibrated.data import beds

from gaspart.reproduction.families.vibrated.claims import vibrated_bed


def test_right_data_agree():
    claims = vibrated_bed(beds())
    assert verdicts(claims) == {"agrees"}
    assert len(claims) == 2 + 4 * 3 + 4 * 2


@pytest.mark.parametrize(
    ("wrong", "claim"),
    [
        ({"limit": 1.06}, "temperature"),
        ({"given": 1.01}, "energy given"),
        ({"lost": 1.05}, "energy lost"),
        ({"height": 0.95}, "mean height"),
    ],
)
def test_wrong_data_disagree(wrong, claim):
    claims = vibrated_bed(beds(**wrong))
    assert verdicts(claims, claim) == {"disagrees"}
    assert verdicts([one for one in claims if not one.claim.startswith(claim)]) == {"agrees"}


def test_two_beds_have_no_limit():
    claims = vibrated_bed(beds(restitutions=(0.95, 0.9)))
    assert not [claim for claim in claims if claim.claim.startswith("temperature")]
    assert verdicts(claims) == {"agrees"}
