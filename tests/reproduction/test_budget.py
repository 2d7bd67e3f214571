"""Where the time of a reproduction went, and which length suffices."""

import math

import pytest
from reproduction.claims.data import claim

from gaspart.reproduction.claims.judging import sufficient


def test_the_length_that_suffices_goes_as_the_square_of_the_uncertainty():
    assert sufficient(claim(1.0, 0.01)) == pytest.approx(4.0 * sufficient(claim(1.0, 0.005)))
    required = claim(1.0, 0.01).required
    assert sufficient(claim(1.0, required)) == pytest.approx(1.0)
    distinguished = claim(1.0, 0.01, alternative=1.02)
    assert sufficient(distinguished) == pytest.approx((0.01 / (0.02 / 2.0)) ** 2, rel=0.2)
    assert math.isnan(sufficient(claim(1.0, 0.0)))
    assert math.isinf(sufficient(claim(1.0, 0.01, alternative=1.0)))
