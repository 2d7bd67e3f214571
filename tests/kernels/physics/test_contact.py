"""One contact: its time, and the momentum that passes."""

from __future__ import annotations

import math
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from gaspart.kernels.physics.ballistic import time_against, time_along, time_to_contact_pulled
from gaspart.kernels.physics.collision import exchange_with_vibration
from gaspart.kernels.physics.contact import (
    contact_root,
    exchange,
    exchange_equal,
    fifth_root,
    restitution_of,
    restitution_of_pair,
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


# The restitution of viscoelastic particles, against the integrated equation of a contact.


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


# Roots of flights under a pull: against a fine search, and where the textbook formula fails.


ballistic_vectors = st.lists(st.floats(-5, 5), min_size=2, max_size=2).map(np.array)


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


@given(ballistic_vectors, ballistic_vectors, ballistic_vectors, st.floats(0.2, 2.0))
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


@given(ballistic_vectors, ballistic_vectors)
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


@pytest.mark.interpreted
@pytest.mark.parametrize(("mobility", "expected"), [(1.0, (1.0, -1.0)), (0.0, (0.9, 0.3))])
def test_a_contact_with_a_fixed_particle_within_the_duration_is_elastic(mobility, expected):
    """Unless the other one is pressed, and moves no more."""
    each = {"latest": [0.0, 0.0], "met": [0.0, 0.0], "contacts": [0, 0], "elastic": [0]}
    duration = SimpleNamespace(inverse_mass=[1.0, 0.0], length=0.1, **each)
    law = SimpleNamespace(inverse_mass=[mobility, 0.0], tangential=0.3)
    flights = [SimpleNamespace(clock=0.05)] * 2
    assert restitution_of_pair(flights, 0, 1, 0.9, law, duration) == expected


@pytest.mark.interpreted
@pytest.mark.parametrize("modes", [[2.0, -1.0], [-1.0, 2.0]])
def test_a_mode_takes_the_energy_of_the_approach_and_gives_its_own(modes):
    """A reduced mass of 2, and -1 without a mode."""
    left = np.array(modes)
    assert exchange_with_vibration(0, 1, 3.0, 0.5, left) == math.sqrt(2.0)
    assert sorted(left) == [-1.0, 9.0]
    assert exchange_with_vibration(0, 1, 3.0, 0.5, np.array([-1.0, -1.0])) == -1.0
