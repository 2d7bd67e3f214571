"""Parts of a scene that come to rest while others move."""

import numpy as np
import pytest

import gaspart as gp

GAP = 1e-6  # below each disc of a column


def column(x, count):
    """Discs one upon the other."""
    return [gp.Particle((x, (0.5 + GAP) + (1.0 + GAP) * n), (0.0, 0.0), 0.5) for n in range(count)]


def slider(x, speed):
    """A disc that slides on the floor."""
    return gp.Particle((x, 0.5), (speed, 0.0), 0.5)


def falling(particles, boundary="wall"):
    container = gp.Container((10.0, 6.0), (boundary, "wall"))
    return gp.Scene(container, particles=particles, gravity=(0.0, -1.0), restitution=gp.Restitution(0.5))


def column_and_slider():
    """Three discs, of which the lowest is hit at a time of 4."""
    return falling([*column(1.0, 3), slider(4.0, -0.5)])


@pytest.mark.thorough
def test_a_column_has_no_events_until_it_is_hit():
    """It rests after a fall through a diameter, the first time that is looked at."""
    sim = gp.Simulation(column_and_slider(), gp.EventDriven())
    sim.advance(until=1.0)
    before = sim.tally.collisions
    sim.advance(until=3.9)
    assert sim.tally.collisions == before > 0
    state = sim.state
    assert state.positions == pytest.approx(np.array([(1, 0.5), (1, 1.5), (1, 2.5), (2.05, 0.5)]), abs=1e-5)
    assert not np.any(state.velocities[:3])
    sim.check_invariants()


@pytest.mark.thorough
def test_the_disc_that_hits_it_loses_energy():
    """The contact is the first for a long time: its restitution is 0.5. Then the column falls."""
    sim = gp.Simulation(column_and_slider(), gp.EventDriven())
    sim.advance(until=3.9)
    before = sim.tally.collisions
    while sim.tally.collisions == before:
        sim.advance(max_events=1)
    assert sim.time == pytest.approx(4.0, abs=1e-6)
    assert sim.state.velocities[[0, 3], 0] == pytest.approx([-0.375, -0.125], rel=1e-9)
    energy = sim.state.energy
    sim.advance(until=20.0)
    sim.check_invariants()
    assert sim.state.energy < energy
    assert sim.state.positions[:3, 1].max() < 2.0


@pytest.mark.thorough
def test_columns_that_touch_rest_and_wake_together():
    """Two touch through a periodic face, a third stands alone, and is hit."""
    particles = [*column(0.5, 2), *column(9.5, 2), *column(4.0, 2), slider(6.0, -0.5)]
    sim = gp.Simulation(falling(particles, "periodic"), gp.EventDriven())
    sim.advance(until=1.5)
    island = sim.checkpoint()["contact_island"]
    assert len(set(island[:4])) == 1 and island[4] == island[5] != island[0]
    assert np.all(island[:6] >= 0) and island[6] == -1
    sim.advance(until=2.1)
    after = sim.checkpoint()["contact_island"]
    assert np.array_equal(after, [*island[:4], -1, -1, -1])
