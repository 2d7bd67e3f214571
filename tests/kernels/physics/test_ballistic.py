"""Roots of flights under a pull: against a fine search, and where the textbook formula fails."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from gaspart.kernels.physics.ballistic import time_against, time_along, time_to_contact_pulled
from gaspart.kernels.physics.contact import time_to_contact

vectors = st.lists(st.floats(-5, 5), min_size=2, max_size=2).map(np.array)


@given(st.floats(1e-3, 10), st.floats(0, 10), st.floats(1e-6, 10))
def test_against_and_along_a_pull(gap, speed, pull):
    rise = time_against(gap, speed, pull)
    if math.isfinite(rise):
        assert speed * rise - pull * rise**2 / 2 == pytest.approx(gap, rel=1e-10)
        assert speed - pull * rise >= -1e-6 * speed  # on the way up
    else:
        assert speed**2 / (2 * pull) < gap * (1 + 1e-12)
    for begun in (speed, -speed):
        fall = time_along(gap, begun, pull)
        assert begun * fall + pull * fall**2 / 2 == pytest.approx(gap, abs=1e-12 * (gap + speed * fall))
        assert begun + pull * fall >= 0  # on the way down


def test_the_roots_survive_where_they_cancel():
    # a gap of 1e-14 crossed at speed 1: (-v + sqrt(v^2 + 2 g h)) / g would be 0, or 10 % off
    assert time_along(1e-14, 1.0, 1.0) == pytest.approx(1e-14, rel=1e-12)
    assert time_against(1e-14, 1.0, 1.0) == pytest.approx(1e-14, rel=1e-12)
    for pull in (1e-300, 1e-30, 1e-12):  # gravity that is hardly there: the straight flight
        assert time_along(3.0, 2.0, pull) == pytest.approx(1.5, rel=1e-11)
        assert time_against(3.0, 2.0, pull) == pytest.approx(1.5, rel=1e-11)
    assert time_along(0.5, 0.0, 1e12) == pytest.approx(1e-6, rel=1e-14)
    assert time_against(1.0, 0.0, 1.0) == math.inf


def test_a_particle_that_left_a_floor_comes_back_even_if_rounding_put_it_below():
    assert time_along(0.0, -1.0, 2.0) == 1.0
    assert time_along(-1e-16, -1.0, 2.0) == pytest.approx(1.0, rel=1e-15)
    assert time_along(-1e-16, -1e-9, 2.0) == 5e-10  # it never comes clear: it turns back at the apex
    assert time_along(-1e-16, 1e-9, 2.0) == 0.0


def separation(r, v, a, t):
    at = r + np.multiply.outer(t, v) + 0.5 * np.multiply.outer(t * t, a)
    return (at**2).sum(axis=-1)


@given(vectors, vectors, vectors, st.floats(0.2, 2.0))
def test_a_pulled_contact_is_the_first(r, v, a, sigma):
    assume(r @ r > 1.01 * sigma**2 and a @ a > 1e-3)
    time = time_to_contact_pulled(r @ r - sigma**2, r @ v, v @ v, r @ a, v @ a, a @ a)
    end = min(time, 30.0)
    before = separation(r, v, a, np.linspace(0, end, 3001))[:-1]
    assert before.min() > sigma**2 * (1 - 1e-9)
    if math.isfinite(time):
        assert separation(r, v, a, np.float64(time)) == pytest.approx(sigma**2, rel=1e-8)
        assert (r + v * time + a * time**2 / 2) @ (v + a * time) < 1e-6


def test_a_pulled_contact_from_rest_and_thrown_up():
    # a ball of contact distance 1 let go at height 3 above a fixed one: it falls by 2
    drop = time_to_contact_pulled(8.0, 0.0, 0.0, -3.0, 0.0, 1.0)
    assert drop == pytest.approx(2.0, rel=1e-15)
    # touching, thrown up at speed 2 under a pull of 1: back after 4
    back = time_to_contact_pulled(0.0, 2.0, 4.0, -1.0, -2.0, 1.0)
    assert back == pytest.approx(4.0, rel=1e-14)
    assert time_to_contact_pulled(-1e-16, 2.0, 4.0, -1.0, -2.0, 1.0) == pytest.approx(4.0, rel=1e-14)
    assert time_to_contact_pulled(0.0, -2.0, 4.0, -1.0, 2.0, 1.0) == 0.0
    assert time_to_contact_pulled(1.0, 0.0, 0.0, 1.5, 0.0, 1.0) == math.inf


@given(vectors, vectors)
def test_a_vanishing_pull_changes_nothing(r, v):
    assume(r @ r > 1.01 and v @ v > 1e-2)
    straight = time_to_contact(r @ r, r @ v, v @ v, 1.0)
    closest = r - v * min((r @ v) / (v @ v), 0)
    assume(abs(closest @ closest - 1.0) > 1e-6)
    a = np.array([0.0, 1e-40])
    pulled = time_to_contact_pulled(r @ r - 1.0, r @ v, v @ v, r @ a, v @ a, a @ a)
    if math.isfinite(straight):
        assert pulled == pytest.approx(straight, rel=1e-6)
    else:
        assert pulled > 1e20
