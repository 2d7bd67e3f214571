"""Random numbers inside kernels: the generator's bits, the logarithm's bits, the distributions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaspart.kernels.physics.rng import flux_speed, log_of, normal_pair, random_words, uniform
from gaspart.kernels.physics.sine import sine_cosine
from gaspart.state.random import key_of, natural_log

WORDS = st.integers(0, 2**63 - 1)


@given(WORDS, WORDS, st.tuples(WORDS, WORDS, st.integers(1, 2**63 - 1)))
def test_the_words_are_those_of_philox(one, other, counter):
    """numpy's Philox is the same generator; it steps its counter before it draws."""
    key = np.array([one, other], dtype=np.uint64)
    particle, number, block = counter
    numpys = np.random.Philox(key=key, counter=[block - 1, number, particle, 0])
    assert list(random_words(key, particle, number, block)) == numpys.random_raw(4).tolist()


@given(st.floats(1e-300, 1e300))
def test_the_logarithm_is_the_one_of_numpy_code_to_the_bit(x):
    assert log_of(x) == natural_log(x)


def test_a_uniform_number_is_never_0_or_1():
    uniform_of = uniform.py_func
    assert uniform_of(np.uint64(0)) == 2.0**-53
    assert uniform_of(np.uint64(2**64 - 1)) == 1.0 - 2.0**-53


def test_speeds_at_a_wall_are_weighted_by_the_flux_and_normal_numbers_are_normal():
    """Moments of v exp(-v^2/2): sqrt(pi/2), 2, 8; of normal numbers 0, 1, 0, 3, and no correlation."""
    count, key = 200_000, key_of(3, 1)
    v = np.array([flux_speed(key, n % 7, n // 7) for n in range(count)])
    for power, mean, square in ((1, math.sqrt(math.pi / 2), 2.0), (2, 2.0, 8.0), (4, 8.0, 384.0)):
        sigma = math.sqrt((square - mean * mean) / count)
        assert np.mean(v**power) == pytest.approx(mean, abs=3 * sigma)
    a, b, _ = np.array([normal_pair(key, n % 7, n // 7, 1) for n in range(count)]).T
    for x in (a, b):
        for power, mean, square in ((1, 0.0, 1.0), (2, 1.0, 3.0), (3, 0.0, 15.0), (4, 3.0, 105.0)):
            sigma = math.sqrt((square - mean * mean) / count)
            assert np.mean(x**power) == pytest.approx(mean, abs=3 * sigma)
    for x, y in ((a, b), (v - math.sqrt(math.pi / 2), a), (v - math.sqrt(math.pi / 2), b)):
        assert np.mean(x * y) == pytest.approx(0.0, abs=3 * x.std() * y.std() / math.sqrt(count))


def test_keys_differ_by_seed_and_purpose():
    keys = {tuple(key_of(*arguments)) for arguments in ((1,), (2,), (1, 1), ((1, 2),), ((1, 2), 3))}
    assert len(keys) == 5


# The sine that is the same bits on every machine.


@given(st.floats(0.0, 1.0))
def test_sine_and_cosine_are_those_of_the_library(turns):
    sine, cosine = sine_cosine(turns)
    assert sine == pytest.approx(math.sin(2.0 * math.pi * turns), abs=1e-15)
    assert cosine == pytest.approx(math.cos(2.0 * math.pi * turns), abs=1e-15)
    assert sine * sine + cosine * cosine == pytest.approx(1.0, abs=1e-15)


def test_quarters_of_a_turn_are_exact():
    found = [sine_cosine(n / 4.0) for n in range(9)]
    assert np.array_equal(found, [(0, 1), (1, 0), (0, -1), (-1, 0), (0, 1), (1, 0), (0, -1), (-1, 0), (0, 1)])
