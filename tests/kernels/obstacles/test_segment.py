"""Interior walls: both sides, solid ends, any number, in any boxes; and what others get wrong."""

import math

import numpy as np
import pytest
from scenes import sent

import gaspart as gp


@pytest.mark.interpreted
@pytest.mark.parametrize("search", ["boxes", "direct", "pairs"])
def test_a_container_of_walls_keeps_a_gas(search):
    particles = [gp.Particle((9.0 + n, 9.0), (1.0, 0.3 * n), 0.3) for n in range(3)]
    scene = gp.Scene(gp.Container((20.0, 20.0)), particles=particles)
    sim = gp.Simulation(scene, gp.EventDriven(search))
    sim.add_box((7.3, 7.7), (13.1, 12.2))
    sim.advance(duration=300.0)
    assert sim.tally.wall_hits[:4].sum() == 0
    assert sim.tally.wall_hits[4:].min() > 10
    assert (sim.state.positions > [7.6 - 1e-9, 8.0 - 1e-9]).all()
    assert (sim.state.positions < [12.8 + 1e-9, 11.9 + 1e-9]).all()
    sim.check_invariants()
    with pytest.raises(gp.SceneError, match="before the first advance"):
        sim.add_wall((1.0, 1.0), (2.0, 2.0))


@pytest.mark.thorough
@pytest.mark.parametrize("degrees", [0, 10, 45, 80])
@pytest.mark.parametrize("boxes_per_side", [1, 5])
def test_the_ends_of_walls_are_solid(degrees, boxes_per_side):
    """What comes along y at an impact parameter b = R sin(a) from the end leaves at the angle 2a."""
    a = math.radians(degrees)
    wall = gp.Wall((6.0, 6.0), (6.0, 11.0))  # its lower end is in the way
    sim = sent((6.0 + 0.5 * math.sin(a), 2.0), (0.0, 1.0), [wall], boxes_per_side=boxes_per_side)
    sim.record_events = True
    sim.advance(max_events=1)
    assert sim.events["particles"].tolist() == [[0, -5]]
    assert sim.events["time"] == pytest.approx([4.0 - 0.5 * math.cos(a)], rel=1e-14)
    expected = [math.sin(2 * a), -math.cos(2 * a)]
    assert sim.state.velocities[0] == pytest.approx(expected, abs=1e-14)


@pytest.mark.interpreted
def test_a_particle_passes_just_beside_an_end_and_does_not_pass_just_inside():
    wall = gp.Wall((6.0, 4.0), (6.0, 6.0))
    for beside, hits in ((0.5 + 1e-9, 0), (0.5 - 1e-9, 1)):
        sim = sent((2.0, 6.0 + beside), (1.0, 0.0), [wall])
        sim.advance(duration=5.0)
        assert sim.tally.wall_hits[4] == hits


@pytest.mark.interpreted
def test_a_side_hit_where_the_side_ends():
    wall = gp.Wall((6.0, 4.0), (6.0, 6.0))
    for y in (6.0, 6.0 - 1e-15, 6.0 + 1e-15, 4.0):
        sim = sent((2.0, y), (1.0, 0.0), [wall])
        sim.advance(duration=5.0)
        assert sim.tally.wall_hits[4] == 1
        assert sim.state.velocities[0] == pytest.approx([-1.0, 0.0], abs=1e-13)


@pytest.mark.interpreted
def test_an_oblique_wall_mirrors_the_velocity():
    sim = sent((2.0, 6.0), (1.0, 0.0), [gp.Wall((4.0, 4.0), (8.0, 8.0))])
    sim.record_events = True
    sim.advance(max_events=1)
    assert sim.events["time"] == pytest.approx([4.0 - 0.5 * math.sqrt(2.0)], rel=1e-14)
    assert sim.state.velocities[0] == pytest.approx([0.0, 1.0], abs=1e-14)


@pytest.mark.interpreted
def test_walls_that_cross_are_corners():
    walls = [gp.Wall((6.0, 2.0), (6.0, 10.0)), gp.Wall((2.0, 6.0), (10.0, 6.0))]
    sim = sent((4.0, 4.0), (1.0, 1.0), walls)
    sim.advance(duration=3.0)
    assert sim.tally.wall_hits[4:].tolist() == [1, 1]
    assert sim.state.velocities[0] == pytest.approx([-1.0, -1.0], abs=1e-14)


@pytest.mark.interpreted
@pytest.mark.parametrize("boxes_per_side", [1, 2, 4])
def test_a_wall_is_met_across_a_periodic_face(boxes_per_side):
    # the wall stands a little inside the low face; the particle comes to the high face and touches its image
    wall = gp.Wall((0.2, 3.0), (0.2, 9.0))
    sim = sent((9.0, 6.0), (1.0, 0.0), [wall], boundary="periodic", boxes_per_side=boxes_per_side)
    sim.advance(duration=4.0)
    assert sim.tally.wall_hits.tolist() == [0, 0, 0, 0, 1]
    assert sim.state.positions[0] == pytest.approx([10.4, 6.0], rel=1e-14)


@pytest.mark.interpreted
def test_gravity_and_a_shelf():
    """Let go over a shelf, a ball bounces on it for ever; thrown up from below, it hits the other side."""
    shelf = gp.Wall((4.0, 6.0), (8.0, 6.0))
    for place, velocity, times in (
        ((6.0, 8.5), (0.0, 0.0), 2.0 * np.arange(1, 20, 2)),
        ((6.0, 2.0), (0.0, 5.0), [5.0 - math.sqrt(25.0 - 7.0)]),
    ):
        sim = sent(place, velocity, [shelf], gravity=(0.0, -1.0))
        sim.record_events = True
        sim.advance(max_events=len(times))
        assert sim.events["time"] == pytest.approx(times, rel=1e-13)
        assert (sim.events["particles"] == [0, -5]).all()


@pytest.mark.interpreted
def test_thrown_round_the_end_of_a_shelf_onto_its_other_side():
    """Up beside the end, over it, and down on the top: the side that it was not on when thrown."""
    shelf = gp.Wall((6.0, 6.0), (11.0, 6.0))
    for search in ("boxes", "direct", "pairs"):
        particle = gp.Particle((4.5, 4.0), (0.5, 3.5), 0.5)
        scene = gp.Scene(gp.Container((12.0, 12.0)), particles=[particle], gravity=(0.0, -1.0), walls=[shelf])
        sim = gp.Simulation(scene, gp.EventDriven(search))
        sim.record_events = True
        sim.advance(max_events=1)
        down = 3.5 + math.sqrt(3.5**2 - 2 * 2.5)
        assert sim.events["particles"].tolist() == [[0, -5]]
        assert sim.events["time"] == pytest.approx([down], rel=1e-13)
        assert sim.state.positions[0] == pytest.approx([4.5 + 0.5 * down, 6.5], rel=1e-13)


@pytest.mark.interpreted
def test_dropped_on_the_end_of_a_wall():
    wall = gp.Wall((6.0, 1.0), (6.0, 5.0))
    sim = sent((6.3, 9.4), (0.0, 0.0), [wall], gravity=(0.0, -2.0))
    sim.record_events = True
    sim.advance(max_events=1)
    assert sim.events["time"] == pytest.approx([2.0], rel=1e-14)
    n = np.array([0.6, 0.8])
    assert sim.state.velocities[0] == pytest.approx(np.array([0.0, -4.0]) + 2 * 4.0 * 0.8 * n, rel=1e-13)


@pytest.mark.interpreted
def test_a_rough_wall_follows_its_formula():
    """Spencer 2022, Eq. 40, at an oblique wall."""
    law, n = gp.Restitution(0.7, 0.4), np.array([1.0, -1.0, 0.0]) / math.sqrt(2.0)
    particle = gp.Particle((2.0, 6.0), (1.0, 0.2), 0.5, 3.0, 1.3, 0.2)
    wall = gp.Wall((4.0, 4.0), (8.0, 8.0))
    scene = gp.Scene(gp.Container((12.0, 12.0)), particles=[particle], restitution=law, walls=[wall])
    sim = gp.Simulation(scene, gp.EventDriven())
    sim.advance(max_events=1)
    v, spin = np.array([1.0, 0.2, 0.0]), np.array([0.0, 0.0, 1.3])
    g = v + 0.5 * np.cross(spin, n)
    gn = (g @ n) * n
    q = -(1 + law.normal) * 3.0 * gn - (1 + law.tangential) / (1 / 3.0 + 0.25 / 0.2) * (g - gn)
    assert sim.state.velocities[0] == pytest.approx((v + q / 3.0)[:2], abs=1e-14)
    assert sim.state.spins[0] == pytest.approx((spin + 0.5 / 0.2 * np.cross(n, q))[2], abs=1e-13)
    assert sim.tally.wall_impulse[4] == pytest.approx(-q @ n, rel=1e-14)


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"walls": [{"start": [6.0, 2.0], "end": [6.0, 13.0]}]}, "walls[0].end"),
        ({"walls": [{"start": [6.0, 2.0, 1.0], "end": [6.0, 3.0]}]}, "walls[0].start"),
        ({"walls": [{"start": [6.0, math.nan], "end": [6.0, 3.0]}]}, "walls[0].start"),
        # Overlaps of its side and of its end.
        ({"walls": [{"start": [2.4, 0.0], "end": [2.4, 12.0]}]}, "particles[0].position"),
        ({"walls": [{"start": [2.0, 2.6], "end": [2.0, 9.0]}]}, "particles[0].position"),
        ({"walls": [{"start": [6.0, 2.0], "end": [6.0, 3.0]}], "centres_to_walls": True}, "centres_to_walls"),
    ],
)
def test_what_is_refused(change, key):
    particle = {"position": [2.0, 2.0], "velocity": [0.0, 0.0], "radius": 0.7}
    with pytest.raises(gp.SceneError) as caught:
        gp.Scene.from_dict({"container": {"lengths": [12.0, 12.0]}, "particles": [particle]} | change)
    assert caught.value.key == key


@pytest.mark.interpreted
def test_overlaps_across_a_periodic_face_lattices_and_files():
    container, wall = gp.Container((12.0, 12.0), "periodic"), gp.Wall((0.1, 3.0), (0.1, 9.0))
    with pytest.raises(gp.SceneError, match=r"overlaps walls\[0\]"):
        gp.Scene(container, particles=[gp.Particle((11.8, 6.0), (0.0, 0.0), 0.5)], walls=[wall])
    full = gp.Scene(container, [gp.Species(100, 0.5, arrangement="lattice")], walls=[wall])
    with pytest.raises(gp.SceneError, match="arrangement"):
        gp.Simulation(full, gp.EventDriven())
    with pytest.raises(gp.SceneError, match="two dimensions"):
        gp.Scene(gp.Container((12.0,) * 3), walls=[wall])


def test_a_trajectory_counts_hits_at_each_wall(tmp_path):
    particle = gp.Particle((2.0, 6.0), (1.0, 0.0), 0.5)
    walls = [gp.Wall((6.0, 0.0), (6.0, 12.0))]
    scene = gp.Scene(gp.Container((12.0, 12.0)), particles=[particle], walls=walls)
    path = gp.run(scene, gp.EventDriven(), 1, 4.0, 1.0, tmp_path / "run.nc")
    with gp.open_trajectory(path) as data:
        assert data.wall_hits.sel(face="wall 0").values.tolist() == [0, 0, 0, 0, 1]
