"""Exact sums: of any size and order, and without an end."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaspart.kernels.compile.policy import kernel
from gaspart.kernels.physics.exact_sum import DIGITS, WIDTH, add_exact, exact_parts, sum_over_threads

NUMBERS = st.floats(allow_nan=False, allow_infinity=False, width=64)


@kernel
def add_all(total, terms):
    for x in terms:
        add_exact(total, x)


def summed(*lists):
    """The sums (threads, WIDTH) of lists of numbers, one by each thread."""
    total = np.zeros((len(lists), WIDTH), np.int64)
    for row, terms in zip(total, lists, strict=True):
        add_all(row, np.array(terms, dtype=float))
    return total


@given(st.lists(NUMBERS, max_size=40), st.lists(NUMBERS, max_size=40))
def test_a_sum_is_exact_whatever_the_sizes_of_its_terms(one, other):
    exact = sum(map(Fraction, one + other), Fraction(0))
    if abs(exact) < Fraction(2) ** 1000:
        value, rest = exact_parts(summed(one, other))
        assert value == float(exact)
        assert abs(exact - Fraction(value) - Fraction(rest)) <= abs(exact) * Fraction(2) ** -64


def test_order_and_threads_do_not_matter():
    rng = np.random.default_rng(3)
    terms = rng.standard_normal(1000) * 10.0 ** rng.integers(-300, 300, 1000)
    found = sum_over_threads(summed(terms))
    for parts in ((terms[::-1],), (terms[:300], terms[300:]), (terms[700:], [], terms[:700])):
        assert np.array_equal(sum_over_threads(summed(*parts)), found)


def test_what_is_left_of_large_terms_is_kept():
    value, _ = exact_parts(summed([1e300, 1e-300, -1e300]))
    assert value == 1e-300
    assert exact_parts(summed([1e16, 1.0, -1e16, 0.0, -0.0])).tolist() == [1.0, 0.0]


@pytest.mark.parametrize("x", [1.0, -math.pi, 2.0**-1074, 1e-40, 1e200])
def test_nothing_overflows(x):
    """Sums of the most terms that are added without a carry, and one more."""
    total = summed([x])
    total *= 2**29 - 1
    total[0, DIGITS] = 2**29 - 1  # as many terms
    add_all(total[0], np.array([x]))  # makes the carries
    assert total[0, DIGITS] == 0 and (total[0, : DIGITS - 1] < 2**32).all()
    for _ in range(10):
        total *= 2
        sum_over_threads(total[None])
    assert exact_parts(total)[0] == x * 2.0**39
