import math

import numpy as np
import pytest
from reproduction.claims.data import claim

from gaspart.reproduction.claims import (
    UNVERIFIED,
    Claim,
    Estimate,
    family_test,
    holm,
    judge,
)
from gaspart.reproduction.claims.judging import reason

TEXTS = {"source": "theory", "fails_if": "it is not"}


def test_three_sigma_is_the_edge_for_a_claim_alone():
    assert judge([claim(1.0 + 2.99 * 0.01)]) == ["agrees"]
    assert judge([claim(1.0 - 2.99 * 0.01)]) == ["agrees"]
    assert judge([claim(1.0 + 3.01 * 0.01)]) == ["disagrees"]
    assert judge([claim(1.0 - 3.01 * 0.01)]) == ["disagrees"]


def test_too_large_an_uncertainty_is_inconclusive_unless_the_value_is_off_nevertheless():
    assert judge([claim(1.0, 0.021)]) == ["inconclusive"]
    assert judge([claim(1.0 + 2.9 * 0.021, 0.021)]) == ["inconclusive"]
    assert judge([claim(50.0, 0.021)]) == ["disagrees"]


def test_agreement_that_does_not_exclude_the_alternative_is_inconclusive():
    assert judge([claim(1.0, 0.01, alternative=1.021)]) == ["agrees"]
    assert judge([claim(1.0, 0.01, alternative=1.019)]) == ["inconclusive"]
    hidden = claim(1.0, 0.01, expected=Estimate(1.0, 0.02), alternative=0.98)
    assert judge([hidden]) == ["inconclusive"]
    assert "only a better theory" in reason(hidden, "inconclusive")
    assert judge([claim(1.2, 0.01, alternative=1.0)]) == ["disagrees"]


def test_what_has_no_verdict_is_only_reported():
    recalled = claim(9.0, no_verdict=UNVERIFIED)
    assert judge([recalled]) == ["no verdict"]
    assert reason(recalled, "no verdict") == UNVERIFIED


def test_a_source_is_reproduced_or_in_error_for_a_reason():
    def of(value, **others):
        return judge([claim(value, kind="reproduction", **others)])

    assert of(1.0) == ["reproduced"]
    assert of(2.0) == ["disagrees"]
    assert of(2.0, source_error="its step is 27 times too slow") == ["source in error"]
    assert of(1.0, error=1.0, source_error="its step is 27 times too slow") == ["inconclusive"]
    wrong = claim(2.0, kind="reproduction", source_error="it counts twice")
    assert reason(wrong, "source in error") == "it counts twice"


@pytest.mark.parametrize(
    ("undecided", "factor"),
    [
        (claim(1.0, 0.04, 0.02), "4 times"),
        (claim(1.0, 0.02, 0.02, alternative=1.02), "4 times"),
        (Claim.at_most(claim="d", measured=Estimate(1.15, 0.1), bound=1.0, required=1.0, **TEXTS), "4 times"),
        (claim(math.nan), "not measured"),
    ],
)
def test_an_inconclusive_claim_states_what_would_decide_it(undecided, factor):
    assert judge([undecided]) == ["inconclusive"]
    assert factor in reason(undecided, "inconclusive")


@pytest.mark.parametrize("broken", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_not_finite_are_inconclusive(broken):
    assert judge([claim(broken)]) == ["inconclusive"]
    assert judge([claim(expected=broken)]) == ["inconclusive"]
    assert judge([claim(error=abs(broken))]) == ["inconclusive"]


def test_one_of_many_at_just_over_three_sigma_is_no_disagreement():
    family = [claim(1.0 + 3.2 * 0.01), *[claim(text=f"Z at {k}") for k in range(20)]]
    assert judge(family)[0] == "agrees"
    assert judge([claim(1.0 + 4.2 * 0.01), *family[1:]])[0] == "disagrees"


def test_claims_without_a_verdict_and_identities_do_not_weaken_the_family():
    many = [claim(text=f"Z at {k}", no_verdict=UNVERIFIED) for k in range(25)]
    many += [claim(text=f"Z at {k}", error=math.nan) for k in range(25, 50)]
    identities = [claim(text=f"T at {k}", kind="identity") for k in range(50)]
    assert judge([claim(1.0 + 3.1 * 0.01), *many, *identities])[0] == "disagrees"
    assert judge([claim(1.0 + 3.1 * 0.01, kind="identity"), *family_of(20)])[0] == "disagrees"


def family_of(size):
    """That many claims which agree."""
    return [claim(text=f"Z at {k}") for k in range(size)]


def spread(scale, seed=3):
    """Claims whose deviations scatter by this many of their uncertainties."""
    deviations = scale * np.random.default_rng(seed).standard_normal(60)
    return [claim(1.0 + 0.01 * d, text=f"Z at {k}") for k, d in enumerate(deviations)]


@pytest.mark.parametrize(("scale", "verdict"), [(1.0, "agrees"), (0.6, "disagrees"), (1.5, "disagrees")])
def test_a_family_whose_uncertainties_are_wrong_is_noticed_on_both_sides(scale, verdict):
    (joint,) = family_test(spread(scale))
    assert judge([joint]) == [verdict]
    assert joint.kind == "family" and joint.measured.value == pytest.approx(scale**2, abs=0.5)
    alone = judge(spread(scale))
    assert scale > 1.0 or set(alone) == {"agrees"}  # Holm's correction does not notice a narrow family


def test_the_joint_test_leaves_out_what_does_not_scatter_as_a_gaussian():
    wide = [claim(9.0, expected=Estimate(1.0, 0.1), text=f"D at {k}") for k in range(9)]
    banded = Claim.at_most(claim="d", measured=Estimate(9.0, 0.1), bound=1.0, required=1.0, **TEXTS)
    (joint,) = family_test([*family_of(20), *wide, banded])
    assert joint.measured.value == 0.0
    assert family_test([claim(), banded]) == []
    assert family_test([claim(1.0, 0.0, text=f"count {k}") for k in range(9)]) == []  # exact
    assert family_test(wide) == []


def test_holm_steps_down():
    # 0.01 <= 0.05/4, then 0.0166 <= 0.05/3; 0.03 > 0.05/2 stops it, although 0.04 <= 0.05 would pass.
    assert holm([0.04, 0.0166, 0.03, 0.01], 0.05) == [False, True, False, True]
    assert holm([0.03, 0.03], 0.05) == [False, False]
    assert holm([], 0.05) == []


def test_family_of_true_claims_is_wrong_as_seldom_as_one_test():
    generator = np.random.default_rng(11)
    deviations = generator.standard_normal((1000, 30))
    wrong = sum("disagrees" in judge([claim(1.0 + 0.01 * d) for d in row]) for row in deviations)
    assert wrong <= 10  # 0.0027 of 1000 is 3; without Holm's steps some 80
