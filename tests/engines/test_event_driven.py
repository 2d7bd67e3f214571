"""The event-driven engine against its referee, exact cases, conservation laws and the equation of state."""

import math

import numpy as np
import pytest
from referee import WORK, check_same
from scenes import gas, measured_compressibility

import gaspart as gp
from gaspart import theory


@pytest.mark.thorough
def test_energy_over_a_million_collisions():
    sim = gp.Simulation(gas(3, 1000, 0.3), gp.EventDriven(), seed=5)
    sim.advance(max_events=1_000_000)
    drift = sim.state.kinetic_energy / sim.initial_state.kinetic_energy - 1
    assert abs(drift) < 1e-12
    assert sim.tally.collisions == 1_000_000
    assert sim.tally.worst_contact < 1e-9


@pytest.mark.thorough
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("eta", [0.1, 0.2, 0.3])
def test_compressibility_factor(dimension, eta):
    """Z within 3 sigma of the reference, sigma at most 0.2 %; the finite-size shift is theory's."""
    count = 500
    sim = gp.Simulation(
        gas(dimension, count, eta, arrangement="lattice"), gp.EventDriven(), seed=(11, dimension)
    )
    sim.advance(max_events=30 * count)
    found, error = measured_compressibility(sim, blocks=16, max_events=100 * count)
    expected = theory.compressibility_factor(eta, dimension)
    expected += theory.finite_size_correction(eta, dimension, count)
    assert error < 2e-3 * expected
    assert abs(found - expected) < 3 * error


def sent(particles, side=10.0, search="automatic", **rest):
    """A simulation, which records its events, of particles in a square or cube."""
    container = gp.Container((side,) * len(particles[0].position))
    sim = gp.Simulation(gp.Scene(container, particles=particles, **rest), gp.EventDriven(search))
    sim.record_events = True
    return sim


@pytest.mark.interpreted
def test_a_head_on_collision_is_exact():
    sim = sent([gp.Particle((2.0, 5.0), (1.0, 0.0), 0.5), gp.Particle((6.0, 5.0), (0.0, 0.0), 0.5)])
    sim.advance(duration=4.0)
    assert sim.events["time"].tolist() == [3.0]
    assert sim.events["particles"].tolist() == [[0, 1]]
    assert sim.state.positions.tolist() == [[5.0, 5.0], [7.0, 5.0]]
    assert sim.state.velocities.tolist() == [[0.0, 0.0], [1.0, 0.0]]


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("search", ["boxes", pytest.param("pairs", marks=pytest.mark.thorough)])
@pytest.mark.parametrize("radius", [1e-5, 1e-7, 1e-9])
@pytest.mark.parametrize(("miss", "touches"), [(0.7, True), (1.5, False)])
def test_tiny_particles_far_apart_touch_if_they_pass_within_a_diameter(
    dimension, search, radius, miss, touches
):
    """With the usual discriminant, rounding alone decides below a diameter of 1e-8 distances."""
    rng = np.random.default_rng(7)
    for _ in range(10):
        axis, side = np.linalg.qr(rng.normal(size=(dimension, dimension)))[0][:2]
        centre = np.full(dimension, 5.0)
        start = centre - 2.0 * axis + 2.0 * radius * miss * side
        particles = [gp.Particle(start, 1.3 * axis, radius), gp.Particle(centre, -0.4 * axis, radius)]
        sim = sent(particles, search=search)
        sim.advance(duration=1.5)
        assert sim.tally.collisions == touches


@pytest.mark.interpreted
def test_a_wall_hit_gives_its_momentum_to_that_face():
    sim = sent([gp.Particle((2.0, 5.0), (-1.0, 0.0), 0.5, mass=3.0)])
    sim.advance(duration=2.0)
    assert sim.tally.wall_hits.tolist() == [1, 0, 0, 0]
    assert sim.tally.wall_impulse.tolist() == [6.0, 0.0, 0.0, 0.0]
    assert sim.events["particles"].tolist() == [[0, -1]]
    assert sim.state.positions.tolist() == [[1.0, 5.0]]


@pytest.mark.interpreted
def test_centres_reach_the_walls_where_the_scene_says_so():
    sim = sent([gp.Particle((2.0, 5.0), (-1.0, 0.0), 0.5)], centres_to_walls=True)
    sim.advance(duration=3.0)
    assert sim.state.positions.tolist() == [[1.0, 5.0]]


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("ratio", "count"),
    [(1.0, 3), (1e2, 31), (1e4, 314), (1e6, 3141), (1e8, 31415), (1e10, 314159), (1e12, 3141592)],
)
def test_pi_by_billiards(ratio, count):
    """A heavy ball, a light one at rest, a wall: ceil(pi/arctan sqrt(m/M)) - 1 hits (Galperin 2003)."""
    particles = [
        gp.Particle((2.0, 1.0), (0.0, 0.0), 0.5),
        gp.Particle((4.0, 1.0), (-1.0, 0.0), 0.5, mass=ratio),
    ]
    sim = gp.Simulation(gp.Scene(gp.Container((1e3, 2.0)), particles=particles), gp.EventDriven())
    sim.advance(duration=500.0)
    assert sim.tally.collisions + sim.tally.wall_hits[0] == count
    assert sim.tally.wall_hits[1] == 0
    assert count == math.ceil(math.pi / math.atan(math.sqrt(1 / ratio))) - 1


@pytest.mark.interpreted
def test_two_balls_into_a_cradle_and_two_leave_it():
    """A chain of simultaneous contacts: those that touch are a pair themselves."""
    row = [gp.Particle((x, 5.0), (1.0 if x < 4.0 else 0.0, 0.0), 0.5) for x in (1.0, 2.0, 5.0, 6.0, 7.0)]
    for search in ("boxes", "pairs"):
        sim = sent(row, 20.0, search)
        sim.advance(duration=4.0)
        assert sim.state.velocities[:, 0].tolist() == [0.0, 0.0, 0.0, 1.0, 1.0]
        assert sim.state.positions[:, 0].tolist() == [3.0, 4.0, 5.0, 8.0, 9.0]
        assert sim.tally.collisions == 6


@pytest.mark.interpreted
def test_a_corner_of_three_faces_is_met_at_once():
    sim = sent([gp.Particle((5.0,) * 3, (1.0,) * 3, 0.5)])
    sim.advance(duration=5.5)
    assert sim.tally.wall_hits.tolist() == [0, 1, 0, 1, 0, 1]
    assert sim.state.positions.tolist() == [[8.5] * 3]


@pytest.mark.interpreted
def test_simultaneous_contacts_come_in_the_order_of_their_indices():
    # two pairs touch at one instant, and a lone particle meets a wall: the wall, then (0, 3), then (1, 2)
    starts = ((2.0, 2.0), 1.0), ((2.0, 6.0), 1.0), ((6.0, 6.0), -1.0), ((6.0, 2.0), -1.0), ((8.0, 4.0), 1.0)
    particles = [gp.Particle(place, (v, 0.0), 0.5) for place, v in starts]
    for search in ("boxes", "direct", "pairs"):
        sim = sent(particles, search=search)
        sim.advance(max_events=3)
        assert sim.events["time"].tolist() == [1.5, 1.5, 1.5]
        assert sim.events["particles"].tolist() == [[4, -2], [0, 3], [1, 2]]


@pytest.mark.thorough
def test_a_checkpoint_that_lacks_its_boxes_goes_on():
    """As older ones do, when an unfinished run is resumed by a revision that chooses other boxes."""
    whole, other = (gp.Simulation(gas(2, 100, 0.2, "wall"), gp.EventDriven("boxes", n), 2) for n in (15, 7))
    whole.advance(until=3.0)
    checkpoint = whole.checkpoint()
    del checkpoint["boxes_per_side"]
    other.restore(checkpoint)
    for sim in (whole, other):
        sim.advance(until=20.0)
    check_same(whole, other, WORK)


@pytest.mark.thorough
def test_clocks_that_start_again_lose_nothing():
    """Far beyond a lap of the clocks (some 1000 times of flight), contacts are as exact as at the start."""
    sim = gp.Simulation(gas(2, 10, 0.05), gp.EventDriven(), seed=3)
    sim.advance(duration=200_000.0)
    assert sim.tally.worst_contact < 1e-11
    sim.check_invariants()
    referee = gp.Simulation(gas(2, 10, 0.05), gp.EventDriven("pairs"), seed=3)
    referee.advance(duration=5_000.0)
    again = gp.Simulation(gas(2, 10, 0.05), gp.EventDriven(), seed=3)
    again.advance(duration=5_000.0)
    assert np.array_equal(again.state.unwrapped, referee.state.unwrapped)


@pytest.mark.interpreted
@pytest.mark.parametrize("count", [0, 1])
def test_empty_scenes_and_scenes_of_one_particle(count):
    scene = gp.Scene(gp.Container((3.0, 3.0)), [gp.Species(count, 0.5, speed=1.0)])
    sim = gp.Simulation(scene, gp.EventDriven())
    sim.advance(duration=100.0)
    assert sim.time == 100.0
    assert sim.tally.collisions == 0
