"""Interior walls of three dimensions: both sides, solid edges and corners, met from anywhere."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart.kernels.physics.ballistic import time_of_summit

PLATE = gp.Plate((6.0, 4.0, 4.0), ((0.0, 4.0, 0.0), (0.0, 0.0, 4.0)))
SEARCHES = pytest.mark.parametrize("search", ["boxes", "pairs"])


def sent(position, velocity, search="boxes", walls=(PLATE,), gravity=(0.0, 0.0, -1e-60), **rest):
    """One sphere and its first event; the weakest of gravities, so that all tests share their kernels."""
    particle = gp.Particle(position, velocity, 0.5)
    scene = gp.Scene(gp.Container((12.0,) * 3, **rest), particles=[particle], walls=walls, gravity=gravity)
    sim = gp.Simulation(scene, gp.EventDriven(search))
    sim.record_events = True
    sim.advance(max_events=1)
    return sim


@pytest.mark.interpreted
@SEARCHES
@pytest.mark.parametrize(("x", "v"), [(2.0, 1.0), (10.0, -1.0)])
def test_a_side(search, x, v):
    sim = sent((x, 6.0, 5.0), (v, 0.25, 0.0), search)
    assert sim.events["time"].tolist() == [3.5]
    assert sim.events["particles"].tolist() == [[0, -7]]
    assert sim.state.velocities[0, :2].tolist() == [-v, 0.25]
    assert sim.tally.wall_impulse.tolist() == [0.0] * 6 + [2.0]


@pytest.mark.interpreted
@SEARCHES
@pytest.mark.parametrize("degrees", [0, 10, 45, 80])
def test_an_edge_is_a_cylinder(search, degrees):
    """What comes along y at an impact parameter b = R sin(a) from an edge leaves at 2a; z is not changed."""
    a = math.radians(degrees)
    sim = sent((6.0 + 0.5 * math.sin(a), 1.0, 5.0), (0.0, 1.0, 0.25), search)
    assert sim.events["time"] == pytest.approx([3.0 - 0.5 * math.cos(a)], rel=1e-14)
    assert sim.state.velocities[0] == pytest.approx([math.sin(2 * a), -math.cos(2 * a), 0.25], abs=1e-14)


@pytest.mark.interpreted
@SEARCHES
def test_a_corner_is_a_sphere(search):
    """Sent along the diagonal of a cube at a corner, a particle comes back; beside it, it passes."""
    way = np.array([1.0, 1.0, 1.0])
    sim = sent(tuple(np.array([6.0, 4.0, 4.0]) - 2 * way), tuple(way), search)
    assert sim.events["time"] == pytest.approx([2.0 - 0.5 / math.sqrt(3.0)], rel=1e-14)
    assert sim.state.velocities[0] == pytest.approx(-way, abs=1e-14)
    for beside, hit in ((0.5 - 1e-9, True), (0.5 + 1e-9, False)):
        off = beside * np.array([0.0, -1.0, -1.0]) / math.sqrt(2.0)
        sim = sent(tuple(np.array([2.0, 4.0, 4.0]) + off), (1.0, 0.0, 0.0), search)
        assert (sim.tally.wall_hits[6] == 1) == hit


@pytest.mark.interpreted
@SEARCHES
def test_a_rim_is_met_where_side_and_edge_meet(search):
    for y in (4.0, 4.0 - 1e-15, 4.0 + 1e-15, 8.0):
        sim = sent((2.0, y, 8.0), (1.0, 0.0, 0.0), search)
        assert sim.state.velocities[0] == pytest.approx([-1.0, 0.0, 0.0], abs=1e-12)


@pytest.mark.interpreted
@SEARCHES
def test_thrown_over_an_edge_and_back_onto_it(search):
    """Beside the end of an edge a particle passes its line, rises, and comes down on the edge itself."""
    shelf = gp.Plate((6.0, 6.0, 4.0), ((5.0, 0.0, 0.0), (0.0, 0.0, -3.0)))  # its upper edge along x
    sim = sent((3.0, 6.0, 2.0), (0.8, 0.0, 3.0), search, walls=[shelf], gravity=(0.0, 0.0, -1.0))
    down = 3.0 + math.sqrt(9.0 - 2 * 2.5)  # z = 2 + 3t - t^2/2 = 4.5
    assert 3.0 + 0.8 * (3.0 - math.sqrt(9.0 - 2 * 1.5)) < 5.4  # the line was passed on the way up, beside it
    assert sim.events["time"] == pytest.approx([down], rel=1e-13)
    assert sim.state.velocities[0] == pytest.approx([0.8, 0.0, down - 3.0], rel=1e-12)


def test_the_summit_between_two_approaches():
    """A ball thrown past a point that falls back to it."""
    # z = (t - 1)(t - 5)/2: z0 = 2.5, v = -3, a = 1; |z| is greatest in between at t = 3
    assert time_of_summit(2.5 * -3.0, 9.0, 2.5, -3.0, 1.0) == pytest.approx(3.0, rel=1e-12)
    assert time_of_summit(2.5 * 3.0, 9.0, 2.5, 3.0, 1.0) == pytest.approx(-3.0, rel=1e-12)
    assert time_of_summit(0.0, 0.0, 2.5, 0.0, 1.0) == math.inf  # one that turns before the centre


@pytest.mark.interpreted
def test_a_plate_is_met_across_a_periodic_face():
    wall = gp.Plate((0.2, 3.0, 3.0), ((0.0, 6.0, 0.0), (0.0, 0.0, 6.0)))
    sim = sent((9.0, 6.0, 6.0), (1.0, 0.0, 0.0), walls=[wall], boundary=("periodic", "wall", "wall"))
    assert sim.events["time"] == pytest.approx([2.7], rel=1e-14)
    assert sim.tally.wall_hits.tolist() == [0] * 6 + [1]


@pytest.mark.interpreted
def test_a_box_of_plates_keeps_a_gas():
    particle = gp.Particle((5.5, 6.0, 6.0), (1.0, 0.3, 0.7), 0.3)
    scene = gp.Scene(gp.Container((12.0,) * 3), particles=[particle], gravity=(0.0, 0.0, -0.1))
    sim = gp.Simulation(scene, gp.EventDriven())
    sim.record_events = True
    sim.add_box((4.0, 4.0, 4.0), (7.0, 8.0, 7.0))
    sim.add_plate((6.5, 5.0, 5.0), ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    sim.advance(duration=200.0)
    assert sim.tally.wall_hits[:6].sum() == 0
    assert sim.tally.wall_hits[6:12].min() > 10
    assert (sim.state.positions > 4.3 - 1e-9).all()
    assert (sim.state.positions < np.array([6.7, 7.7, 6.7]) + 1e-9).all()
    sim.check_invariants()


@pytest.mark.parametrize(
    ("plate", "key"),
    [
        ({"corner": [6, 4, 4], "edges": [[0, 9, 0], [0, 0, 4]]}, "walls[0].edges[0]"),
        ({"corner": [6, 13, 4], "edges": [[0, 4, 0], [0, 0, 4]]}, "walls[0].corner"),
        ({"start": [6, 4], "end": [6, 6]}, "walls[0].start"),
        ({"corner": [2.4, 4, 4], "edges": [[0, 4, 0], [0, 0, 4]]}, "particles[0].position"),
    ],
)
def test_what_is_refused(plate, key):
    particle = {"position": [2.0, 5.0, 5.0], "velocity": [0.0, 0.0, 0.0], "radius": 0.7}
    with pytest.raises(gp.SceneError) as caught:
        gp.Scene.from_dict({"container": {"lengths": [12.0] * 3}, "particles": [particle], "walls": [plate]})
    assert caught.value.key == key


@pytest.mark.interpreted
def test_random_particles_keep_clear_and_files_keep_plates():
    scene = gp.Scene(gp.Container((12.0,) * 3), [gp.Species(300, 0.4)], walls=[PLATE])
    state = gp.Simulation(scene, gp.EventDriven(), seed=3).initial_state
    assert all(PLATE.distance(tuple(place)) >= 0.4 for place in state.positions)
    assert PLATE.distance((5.0, 3.0, 3.0)) == pytest.approx(math.sqrt(3.0))
    assert PLATE.distance((4.5, 5.0, 9.0)) == pytest.approx(math.hypot(1.5, 1.0))
