"""One contact: its time, and the momentum that passes."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from gaspart.kernels.physics.contact import (
    contact_root,
    exchange,
    exchange_equal,
    time_to_contact,
)

# Of what is not 0 the squares must not underflow: scenes whose lengths or speeds are smaller are refused.
numbers = st.floats(-10, 10).map(lambda x: x if abs(x) > 1e-60 else 0.0)
vectors = st.lists(numbers, min_size=3, max_size=3).map(np.array)
masses = st.floats(1e-8, 1e8)


@given(vectors, vectors, st.floats(0.1, 2.0))
def test_particles_touch_at_the_predicted_time(r, v, sigma):
    assume(r @ r > 1.01 * sigma**2)
    time = time_to_contact(r @ r, r @ v, v @ v, sigma**2)
    if math.isinf(time):
        closest = r if v @ v == 0 else r - v * min((r @ v) / (v @ v), 0)
        assert r @ v >= 0 or closest @ closest > sigma**2 * (1 - 1e-9)
    else:
        at = r + v * time
        assert time > 0
        # the contact is where it is to rounding, divided by how squarely the particles meet
        assert math.sqrt(at @ at) == pytest.approx(sigma, rel=1e-12 * (1 + r @ r) / sigma**2 + 1e-9)
        assert at @ v <= 1e-6 * (1 + math.sqrt(v @ v))  # on the way in, not out


def test_a_touching_pair_collides_now_if_it_approaches():
    assert time_to_contact(1.0, -0.1, 1.0, 1.0) == 0.0
    assert time_to_contact(0.999, -0.1, 1.0, 1.0) == 0.0
    assert time_to_contact(1.0, 0.1, 1.0, 1.0) == math.inf
    assert time_to_contact(1.0, 0.0, 0.0, 1.0) == math.inf


def test_an_overlapping_pair_touched_in_the_past():
    r, v = np.array([0.7, 0.1]), np.array([-2.0, 0.3])
    time = contact_root(r @ r, r @ v, v @ v, 1.0)
    at = r + v * time
    assert time < 0
    assert at @ at == pytest.approx(1.0, rel=1e-14)


def test_the_root_survives_where_the_textbook_formula_cancels():
    # a gap of 1e-13 closed at unit speed: the textbook form (-b - sqrt(b^2 - c))/a is off by 10 %
    gap = 1e-13
    rr = (1 + gap) ** 2
    assert time_to_contact(rr, -(1 + gap), 1.0, 1.0) == pytest.approx(gap, rel=2e-3)


@given(vectors, vectors, masses, masses)
def test_momentum_and_energy_are_kept_and_the_normal_velocity_turns(r, v, m1, m2):
    assume(r @ r > 1e-2)
    v1, v2 = np.zeros(3), v
    to1, to2 = exchange(r @ r, r @ v, m1, m2)
    w1, w2 = v1 + to1 * r, v2 - to2 * r
    size = m1 * abs(w1).max() + m2 * (abs(w2).max() + abs(v2).max())
    assert np.allclose(m1 * w1 + m2 * w2, m2 * v2, rtol=0, atol=4e-15 * size)
    assert m1 * w1 @ w1 + m2 * w2 @ w2 == pytest.approx(m2 * v2 @ v2, rel=1e-12, abs=1e-300)
    assert (w2 - w1) @ r == pytest.approx(-(v @ r), rel=1e-12, abs=1e-12 * size / min(m1, m2))


def test_no_mass_is_lost_at_a_ratio_of_1e16():
    to1, to2 = exchange(1.0, -1.0, 1.0, 1e16)
    assert to1 == -2.0
    assert to2 == pytest.approx(-2e-16, rel=1e-15)


def test_equal_masses_are_the_general_case():
    assert exchange(2.0, -3.0, 1.0, 1.0) == (exchange_equal(2.0, -3.0),) * 2


def test_float32_stays_float32():
    rr, rv, m = np.float32(2.0), np.float32(-3.0), np.float32(1.5)
    assert exchange.py_func(rr, rv, m, m)[0].dtype == np.float32
    assert contact_root.py_func(np.float32(0.9), rv, m, np.float32(1.0)).dtype == np.float32
