"""Sticky faces: particles that are hit while they stick there."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from referee import check_searches

import gaspart as gp

FACES = {name: gp.Sticky(0.5) for name in ("x_low", "x_high", "y_low", "y_high")}
ROOM = gp.Container((12.0, 12.0))
ROUNDING = 1e-13  # a change of velocity that is no contact


def smallest_change(sim):
    """The smallest change of the velocity of a particle by any event of a simulation."""
    velocities, least = sim.initial_state.velocities.copy(), math.inf
    events = sim.events
    for particles, after in zip(events["particles"], events["velocities"], strict=True):
        for n, particle in enumerate(particles):
            if particle >= 0:
                least = min(least, abs(after[n] - velocities[particle]).max())
                velocities[particle] = after[n]
    return least


@pytest.mark.parametrize("seed", [13, 14])
def test_what_sticks_is_not_met_again_by_rounding(seed):
    """A disc in a corner is hit, gives its velocity to two faces, and is approached again at 1e-17; or one
    that has stopped at a face comes to it at 2e-16."""
    scene = gp.Scene(ROOM, [gp.Species(40, 0.5, temperature=1.0)], faces=FACES)
    sim = gp.Simulation(scene, gp.EventDriven(), seed)
    sim.record_events = True
    sim.advance(until=100.0)
    sim.check_invariants()
    assert smallest_change(sim) > ROUNDING


@st.composite
def cornered(draw):
    """A disc that sticks in a corner, one that sticks beside it on the floor, and one that comes to them."""
    angle, turned = draw(st.floats(0.05, 1.5)), draw(st.floats(-0.05, 0.05))
    radius, mass = draw(st.floats(0.2, 3.0)), draw(st.floats(0.1, 20.0))
    place = [max(0.5 + 6.0 * component, radius) for component in (math.cos(angle), math.sin(angle))]
    angle = math.atan2(place[1] - 0.5, place[0] - 0.5) + turned
    particles = [
        gp.Particle((0.5, 0.5), (-0.01, -0.01), 0.5),
        gp.Particle(tuple(place), (-math.cos(angle), -math.sin(angle)), radius, mass),
    ]
    if draw(st.booleans()):
        particles.append(gp.Particle((1.5, 0.5), (0.0, -0.01), 0.5))
    return gp.Scene(gp.Container((20.0, 20.0)), particles=particles, faces={k: gp.Sticky(3.0) for k in FACES})


@given(cornered())
def test_contacts_in_a_corner_end(scene):
    """Each contact gives the faces a part of the energy: 200 of them at one time are too many even for a mass
    of 20, and all searches agree on them."""
    sim = check_searches(scene, 400, 1)
    times = sim.events["time"]
    assert np.unique(times, return_counts=True)[1].max(initial=0) < 400
    sim.check_invariants()
