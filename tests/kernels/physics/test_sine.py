"""The sine that is the same bits on every machine."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaspart.kernels.physics.sine import sine_cosine


@given(st.floats(0.0, 1.0))
def test_sine_and_cosine_are_those_of_the_library(turns):
    sine, cosine = sine_cosine(turns)
    assert sine == pytest.approx(math.sin(2.0 * math.pi * turns), abs=1e-15)
    assert cosine == pytest.approx(math.cos(2.0 * math.pi * turns), abs=1e-15)
    assert sine * sine + cosine * cosine == pytest.approx(1.0, abs=1e-15)


def test_quarters_of_a_turn_are_exact():
    found = [sine_cosine(n / 4.0) for n in range(9)]
    assert np.array_equal(found, [(0, 1), (1, 0), (0, -1), (-1, 0), (0, 1), (1, 0), (0, -1), (-1, 0), (0, 1)])
