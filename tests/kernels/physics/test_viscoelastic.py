"""The restitution of viscoelastic particles, against the integrated equation of a contact."""

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from gaspart.kernels.physics.contact import fifth_root, restitution_of


def integrated(damping):
    """Minus the speed at which x'' + b sqrt(x) x' + x^(3/2) = 0 from x = 0, x' = 1 ends: without a force."""

    def rate(_, y):
        return y[1], -math.sqrt(max(y[0], 0.0)) * (y[0] + damping * y[1])

    def force(time, y):
        return y[0] + damping * y[1] if time > 1e-4 else 1.0

    force.terminal, force.direction = True, -1
    ended = solve_ivp(rate, (0.0, 1e3), (1e-9, 1.0), "DOP853", events=force, rtol=1e-10, atol=1e-13)
    assert ended.status == 1
    return -ended.y[1, -1]


@given(st.floats(1e-300, 1e300))
def test_the_fifth_root_is_correct_to_rounding(value):
    assert float(Fraction(fifth_root(value)) ** 5 / Fraction(value)) == pytest.approx(1.0, rel=2e-15)


def test_the_fifth_root_at_its_ends():
    assert fifth_root(0.0) == 0.0
    assert fifth_root(32.0) == 2.0
    assert float(Fraction(fifth_root(5e-324)) ** 5 / Fraction(5e-324)) == pytest.approx(1.0, rel=2e-15)


@pytest.mark.parametrize("damping", [1e-3, 0.01, 0.1, 0.5, 1.0, 3.0, 10.0, 30.0])
def test_the_restitution_is_that_of_the_integrated_contact(damping):
    assert restitution_of(damping) == pytest.approx(integrated(damping), abs=0.009)


def test_slow_contacts_follow_the_first_terms_of_the_series():
    """1 - C b + 3 C^2 b^2 / 5, C = 1.15345 (Ramirez, Poeschel, Brilliantov and Schwager 1999)."""
    for damping in (1e-4, 1e-3, 1e-2):
        series = 1.0 - 1.15345 * damping + 0.6 * (1.15345 * damping) ** 2
        assert restitution_of(damping) == pytest.approx(series, abs=2.0 * damping**2.5)
        assert integrated(damping) == pytest.approx(series, abs=2.0 * damping**2.5 + 1e-8)


@given(st.floats(0.0, 1e6), st.floats(1.001, 10.0))
def test_it_falls_from_one_to_zero(damping, factor):
    assert 0.0 <= restitution_of(factor * damping) <= restitution_of(damping) <= 1.0
