"""When a particle meets a vibrating face: against a fine search in time."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaspart.kernels.obstacles.moving import place_and_velocity, time_to_vibrating

_SEARCHED, _FINE = 6, 2000  # periods of the search by brute force, and its steps in each
LONG = 0.0, 1e6  # clocks that have just begun
sines, phases = st.booleans(), st.floats(0.0, 0.999)


def places(times, sine, stroke, period):
    """Where the face is at these times, by the library's cosine."""
    turns = times / period % 1.0
    return 0.5 * stroke * (1.0 - np.cos(2.0 * np.pi * turns)) if sine else stroke * turns


@given(sines, phases, st.floats(0.1, 3.0), st.floats(0.1, 3.0))
def test_place_and_velocity_of_a_face(sine, phase, stroke, period):
    at, late = phase * period, 1e-6 * period
    place, speed = place_and_velocity(at, sine, stroke, period)
    assert place == pytest.approx(places(np.array(at), sine, stroke, period), abs=1e-14 * stroke)
    further = place_and_velocity(at + late, sine, stroke, period)[0]
    assert (further - place) / late == pytest.approx(speed, abs=1e-4 * stroke / period)


@given(
    sines,
    phases,
    st.sampled_from([1e-9, 0.01, 0.3, 3.0]),
    st.floats(0.01, 1.0),
    st.floats(-3.0, 3.0),
    st.sampled_from([-5.0, -1.0, -0.05, 0.0, 0.5]),
)
def test_contacts_are_the_first_of_a_fine_search(sine, phase, scale, share, v, a):
    """None is missed, and none is where the particle is still above the face."""
    stroke, period = 0.7, 1.3
    at = phase * period
    x = float(places(np.array(at), sine, stroke, period)) + scale * share
    found = time_to_vibrating(x, v, a, LONG, at, sine, stroke, period)
    times = np.arange(_SEARCHED * _FINE) * (period / _FINE)
    gaps = x + v * times + 0.5 * a * times**2 - places(at + times, sine, stroke, period)
    assert found <= times[gaps < -1e-12].min(initial=math.inf)
    if found <= times[-1]:
        gap = x + v * found + 0.5 * a * found**2 - places(np.array(at + found), sine, stroke, period)
        jump = not sine and min((at + found) % period, -(at + found) % period) < 1e-9
        assert jump or gap == pytest.approx(0.0, abs=1e-12)


@given(sines, phases, st.floats(1e-6, 2.0), st.sampled_from([-1.0, 0.0]))
def test_a_particle_that_has_just_bounced_parts_from_the_face(sine, phase, parting, a):
    """Rounding leaves it a little within the face: it does not meet it again where it is."""
    stroke, period = 0.7, 1.3
    at = phase * period
    place, speed = place_and_velocity(at, sine, stroke, period)
    for error in (-1e-15, 0.0, 1e-15):
        found = time_to_vibrating(place + error, speed + parting, a, LONG, at, sine, stroke, period)
        assert found > 1e-2 * parting


def test_a_particle_out_of_reach_is_never_met():
    for sine in (True, False):
        assert time_to_vibrating(1.0, 0.0, 0.0, LONG, 0.3, sine, 0.5, 1.0) == math.inf
        assert time_to_vibrating(1.0, 2.0, 0.5, LONG, 0.3, sine, 0.5, 1.0) == math.inf
        assert time_to_vibrating(math.nan, 0.0, 0.0, LONG, 0.3, sine, 0.5, 1.0) >= 0.0  # it ends


def test_a_particle_at_rest_on_a_face_that_begins_to_rise_is_met_at_once():
    assert time_to_vibrating(0.0, 0.0, 0.0, LONG, 0.0, True, 0.5, 1.0) < 1e-14
    assert time_to_vibrating(0.0, 0.0, -1.0, LONG, 0.0, False, 0.5, 1.0) == 0.0


@pytest.mark.parametrize("v", [-1e-18, -1e-15, -1e-12])
def test_a_search_ends_with_the_epoch_of_the_clocks(v):
    """It would take 1e11 to 1e17 periods to the face."""
    for sine in (True, False):
        assert time_to_vibrating(1.0, v, 0.0, (3.0, 500.0), 0.3, sine, 0.5, 1.0) == math.inf
