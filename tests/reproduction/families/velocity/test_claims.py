import pytest
from reproduction.families.velocity.data import correlations

from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.velocity.claims import velocity_autocorrelation


def verdicts(dataset, beginning=""):
    claims = velocity_autocorrelation(dataset)
    return {
        verdict
        for claim, verdict in zip(claims, judge(claims), strict=True)
        if claim.claim.startswith(beginning)
    }


def test_right_data_agree():
    assert verdicts(correlations()) == {"agrees"}


@pytest.mark.parametrize(
    ("wrong", "beginning"),
    [({"start": 1.02}, "initial decay"), ({"tail": 0.5}, "long-time")],
)
def test_a_wrong_memory_is_found(wrong, beginning):
    assert "disagrees" in verdicts(correlations(**wrong), beginning)


def test_short_runs_are_inconclusive():
    assert "inconclusive" in verdicts(correlations(error=0.4), "long-time")
