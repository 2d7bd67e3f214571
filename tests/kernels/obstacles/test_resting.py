"""Particles that rest on interior walls under gravity, slide along them, and leave them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from referee import same_bits

import gaspart as gp

FLAT = [gp.Wall((5.0, 10.0), (15.0, 10.0))]
ROOT = math.sqrt(0.5)


def discs(particles, walls=FLAT, restitution=None, boundary="wall", gravity=(0.0, -1.0)):
    container = gp.Container((20.0, 20.0), boundary)
    particles = [gp.Particle(place, velocity, 0.5) for place, velocity in particles]
    return gp.Scene(container, particles=particles, walls=walls, restitution=restitution, gravity=gravity)


def spheres(particles, walls):
    particles = [gp.Particle(place, velocity, 0.5) for place, velocity in particles]
    return gp.Scene(gp.Container((10.0,) * 3), particles=particles, walls=walls, gravity=(0.0, 0.0, -1.0))


def after(scene, duration):
    """The simulation by boxes, whose events are those of the referee and do not depend on where it stops."""
    sims = [gp.Simulation(scene, gp.EventDriven(search)) for search in ("boxes", "pairs")]
    for sim in sims:
        sim.record_events = True
    sims[1].advance(duration=duration)
    for part in range(1, 4):
        sims[0].advance(until=duration * part / 3)
        again = gp.Simulation(scene, gp.EventDriven())
        again.record_events = True
        again.restore(sims[0].checkpoint())
    again.advance(until=sims[1].time)
    assert same_bits(*sims)
    assert np.array_equal(sims[0].state.positions, sims[1].state.positions)
    assert np.array_equal(again.state.positions, sims[1].state.positions)
    sims[0].check_invariants()
    return sims[0]


def close(sim, positions, velocities):
    assert sim.state.positions == pytest.approx(np.array(positions), abs=1e-9)
    assert sim.state.velocities == pytest.approx(np.array(velocities), abs=1e-9)


@pytest.mark.interpreted
def test_a_disc_at_rest_stays():
    sim = after(discs([((10.0, 10.5), (0.0, 0.0))]), 1000.0)
    close(sim, [(10.0, 10.5)], [(0.0, 0.0)])
    assert sim.tally.wall_hits.sum() <= 2


@pytest.mark.interpreted
def test_a_disc_slides_to_the_end_and_falls():
    sim = after(discs([((10.0, 10.5), (2.0, 0.0))]), 4.0)
    close(sim, [(18.0, 10.5 - 0.5 * 1.5**2)], [(2.0, -1.5)])


@pytest.mark.interpreted
@pytest.mark.parametrize("angle", [0.01, 0.3, 1.2, -0.3])
def test_a_disc_slides_down_a_slope(angle):
    c, s = math.cos(angle), math.sin(angle)
    wall = gp.Wall((10.0 - 4.0 * c, 10.0 - 4.0 * s), (10.0 + 4.0 * c, 10.0 + 4.0 * s))
    start = np.array([10.0 - 0.5 * s, 10.0 + 0.5 * c])
    time = 1.5
    sim = after(discs([(tuple(start), (0.0, 0.0))], [wall]), time)
    close(sim, [start - 0.5 * s * time**2 * np.array([c, s])], [-s * time * np.array([c, s])])


@pytest.mark.interpreted
def test_a_disc_comes_to_rest_and_slides_on():
    """Bounces that lose energy add up to a finite time; what is left is the motion along the wall."""
    sim = after(discs([((8.0, 11.0), (0.1, 0.0))], restitution=gp.Restitution(0.5)), 20.0)
    close(sim, [(10.0, 10.5)], [(0.1, 0.0)])
    assert sim.tally.dissipated_energy == pytest.approx(0.5, rel=1e-9)


@pytest.mark.interpreted
def test_a_disc_at_rest_in_a_wedge_and_one_balanced_on_an_end():
    wedge = [gp.Wall((10.0, 10.0), (15.0, 15.0)), gp.Wall((10.0, 10.0), (5.0, 15.0))]
    place = (10.0, 10.0 + 0.5 / ROOT)
    close(after(discs([(place, (0.0, 0.0))], wedge), 100.0), [place], [(0.0, 0.0)])
    end = [gp.Wall((10.0, 2.0), (10.0, 10.0))]
    close(after(discs([((10.0, 10.5), (0.0, 0.0))], end), 100.0), [(10.0, 10.5)], [(0.0, 0.0)])


@pytest.mark.interpreted
def test_a_disc_slides_from_wall_to_wall_and_across_a_periodic_face():
    walls = [gp.Wall((5.0, 10.0), (10.0, 10.0)), gp.Wall((10.0, 10.0), (15.0, 10.0))]
    close(after(discs([((6.0, 10.5), (1.0, 0.0))], walls), 8.0), [(14.0, 10.5)], [(1.0, 0.0)])
    whole = [gp.Wall((0.0, 10.0), (20.0, 10.0))]
    scene = discs([((6.0, 10.5), (1.0, 0.0))], whole, boundary=("periodic", "wall"))
    close(after(scene, 100.0), [(6.0, 10.5)], [(1.0, 0.0)])


@pytest.mark.interpreted
def test_a_disc_at_rest_is_pushed_and_hit_from_above():
    sim = after(discs([((7.0, 10.5), (1.0, 0.0)), ((10.0, 10.5), (0.0, 0.0))]), 4.0)
    close(sim, [(9.0, 10.5), (12.0, 10.5)], [(0.0, 0.0), (1.0, 0.0)])
    sim = after(discs([((10.0, 10.5), (0.0, 0.0)), ((10.0, 14.0), (0.0, 0.0))]), 20.0)
    assert sim.state.energy == pytest.approx(sim.initial_state.energy, rel=1e-12)


@pytest.mark.thorough
def test_a_disc_that_is_slow_goes_round_the_end():
    """Until the angle a at which gravity no longer holds it there, cos a = 2/3 + v^2/3gR."""
    speed = 0.2
    sim = gp.Simulation(discs([((14.9, 10.5), (speed, 0.0))]), gp.EventDriven())
    end = np.array([15.0, 10.0])
    while sim.state.positions[0, 1] > 10.0:
        sim.advance(duration=0.001)
        gap = sim.state.positions[0] - end
        if math.hypot(*gap) > 0.5 * (1.0 + 1e-6) and gap[0] > 0.0:
            break
    assert gap[1] / math.hypot(*gap) == pytest.approx(2.0 / 3.0 + speed**2 / 1.5, abs=0.03)
    sim.check_invariants()
    assert sim.state.energy == pytest.approx(sim.initial_state.energy, rel=1e-7)


@pytest.mark.interpreted
def test_a_sphere_on_a_plate_and_in_the_trough_of_two():
    plate = [gp.Plate((2.0, 2.0, 5.0), ((6.0, 0.0, 0.0), (0.0, 6.0, 0.0)))]
    sim = after(spheres([((5.0, 5.0, 5.5), (1.0, 0.5, 0.0))], plate), 4.0)
    close(sim, [(9.0, 7.0, 5.0)], [(1.0, 0.5, -1.0)])
    trough = [gp.Plate((1.0, 5.0, 5.0), ((8.0, 0.0, 0.0), (0.0, side, 3.0))) for side in (3.0, -3.0)]
    start = (5.0, 5.0, 5.0 + 0.5 / ROOT)
    sim = after(spheres([(start, (0.5, 0.0, 0.0))], trough), 6.0)
    close(sim, [(8.0, *start[1:])], [(0.5, 0.0, 0.0)])


@pytest.mark.interpreted
def test_a_sphere_slides_down_a_tilted_plate():
    c, s = math.cos(0.3), math.sin(0.3)
    plate = gp.Plate((2.0, 5.0 - 3.0 * c, 5.0 - 3.0 * s), ((6.0, 0.0, 0.0), (0.0, 6.0 * c, 6.0 * s)))
    start = np.array([5.0, 5.0 - 0.5 * s, 5.0 + 0.5 * c])
    sim = after(spheres([(tuple(start), (0.3, 0.0, 0.0))], [plate]), 2.0)
    close(sim, [start + np.array([0.6, -2.0 * s * c, -2.0 * s * s])], [(0.3, -2.0 * s * c, -2.0 * s * s)])


@pytest.mark.thorough
@given(
    st.floats(-1.4, 1.4).map(lambda x: round(x, 6)),
    st.floats(-3.0, 3.0).map(lambda x: round(x, 6)),
    st.sampled_from([1.0, 0.9, 0.5]),
    st.sampled_from([-1.0, 0.5]),
)
def test_one_disc_never_collapses(angle, speed, normal, tangential):
    """On a wall of any slope, thrown or at rest, down to the floor, into corners, and round the end."""
    c, s = math.cos(angle), math.sin(angle)
    wall = gp.Wall((10.0 - 4.0 * c, 10.0 - 4.0 * s), (10.0 + 4.0 * c, 10.0 + 4.0 * s))
    start = (10.0 - 0.5 * s, 10.0 + 0.5 * c)
    law = gp.Restitution(normal, tangential)
    sim = gp.Simulation(discs([(start, (speed * c, speed * s))], [wall], law), gp.EventDriven())
    sim.advance(duration=30.0, max_events=200_000)
    sim.check_invariants()
    x, y = sim.state.positions[0] - [10.0, 10.0]
    along = min(max(x * c + y * s, -4.0), 4.0)
    assert math.hypot(x - along * c, y - along * s) > 0.5 - 1e-9
