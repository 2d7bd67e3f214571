import math

import numpy as np
import pytest
from claims.data import claim

from gaspart.claims import holm, judge


def test_three_sigma_is_the_edge_for_a_claim_alone():
    assert judge([claim(1.0 + 2.99 * 0.01)]) == ["agrees"]
    assert judge([claim(1.0 - 2.99 * 0.01)]) == ["agrees"]
    assert judge([claim(1.0 + 3.01 * 0.01)]) == ["disagrees"]
    assert judge([claim(1.0 - 3.01 * 0.01)]) == ["disagrees"]


def test_too_large_an_uncertainty_is_inconclusive_whatever_the_value():
    assert judge([claim(1.0, 0.021)]) == ["inconclusive"]
    assert judge([claim(50.0, 0.021)]) == ["inconclusive"]


@pytest.mark.parametrize("broken", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_not_finite_are_inconclusive(broken):
    assert judge([claim(broken)]) == ["inconclusive"]
    assert judge([claim(expected=broken)]) == ["inconclusive"]
    assert judge([claim(error=abs(broken))]) == ["inconclusive"]


def test_one_of_many_at_just_over_three_sigma_is_no_disagreement():
    family = [claim(1.0 + 3.2 * 0.01), *[claim(text=f"Z at {k}") for k in range(20)]]
    assert judge(family)[0] == "agrees"
    assert judge([claim(1.0 + 4.2 * 0.01), *family[1:]])[0] == "disagrees"


def test_inconclusive_claims_and_identities_do_not_weaken_the_family():
    many = [claim(text=f"Z at {k}", error=1.0) for k in range(50)]
    identities = [claim(text=f"T at {k}", kind="identity") for k in range(50)]
    assert judge([claim(1.0 + 3.1 * 0.01), *many, *identities])[0] == "disagrees"
    assert judge([claim(1.0 + 3.1 * 0.01, kind="identity"), *family_of(20)])[0] == "disagrees"


def family_of(size):
    """That many claims which agree."""
    return [claim(text=f"Z at {k}") for k in range(size)]


def test_holm_steps_down():
    # 0.01 <= 0.05/4, then 0.0166 <= 0.05/3; 0.03 > 0.05/2 stops it, although 0.04 <= 0.05 would pass.
    assert holm([0.04, 0.0166, 0.03, 0.01], 0.05) == [False, True, False, True]
    assert holm([0.03, 0.03], 0.05) == [False, False]
    assert holm([], 0.05) == []


def test_family_of_true_claims_is_wrong_as_seldom_as_one_test():
    generator = np.random.default_rng(11)
    deviations = generator.standard_normal((4000, 30))
    wrong = sum("disagrees" in judge([claim(1.0 + 0.01 * d) for d in row]) for row in deviations)
    assert wrong <= 25  # 0.0027 of 4000 is 11
