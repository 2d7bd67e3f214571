import pytest
from experiments.velocity.data import correlations

from gaspart.claims import judge
from gaspart.experiments.velocity.claims import spreading_uncertainty, velocity_autocorrelation


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
    [({"start": 1.02}, "initial decay"), ({"tail": 0.5}, "long-time"), ({"exponent": 1.0}, "exponent")],
)
def test_a_wrong_memory_is_found(wrong, beginning):
    assert "disagrees" in verdicts(correlations(**wrong), beginning)


def test_short_runs_are_inconclusive():
    assert "inconclusive" in verdicts(correlations(error=0.4), "long-time")


def test_the_theory_is_as_uncertain_as_diffusion_is_beyond_enskog():
    assert spreading_uncertainty(3, 0.01) < 0.01
    assert 0.02 < spreading_uncertainty(3, 0.3) < 0.2
    assert 0.02 < spreading_uncertainty(2, 0.3) < 0.3
