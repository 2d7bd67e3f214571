"""Sticky faces: particles that are hit while they stick there."""

import math

import pytest

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


@pytest.mark.thorough
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
