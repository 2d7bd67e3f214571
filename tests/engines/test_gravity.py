"""Uniform gravity: parabolic flights, exactly."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scenes import gas

import gaspart as gp

DOWN = (0.0, -1.0)


def thrown(position, velocity, gravity=DOWN, search="boxes"):
    particles = [gp.Particle(position, velocity, 0.5)]
    scene = gp.Scene(gp.Container((10.0, 10.0)), particles=particles, gravity=gravity)
    boxes = 8 if search == "boxes" else None
    return gp.Simulation(scene, gp.EventDriven(search, boxes_per_side=boxes))


@pytest.mark.interpreted
@pytest.mark.parametrize("search", ["boxes", "direct", "pairs"])
def test_a_projectile_is_where_it_should_be(search):
    sim = thrown((1.0, 1.0), (1.0, 3.0), search=search)  # up through several boxes, and down again
    for _ in range(11):
        sim.advance(duration=0.5)
        t = sim.time
        assert sim.state.positions == pytest.approx(np.array([[1 + t, 1 + 3 * t - t * t / 2]]), rel=1e-14)
        assert sim.state.velocities == pytest.approx(np.array([[1.0, 3 - t]]), abs=1e-14)
    assert sim.tally.wall_hits.sum() == 0
    assert sim.tally.crossings >= 6 or search != "boxes"


@pytest.mark.interpreted
@pytest.mark.parametrize("search", ["boxes", "pairs"])
def test_bounce_times_of_a_ball_let_go(search):
    """Let go at height h: the floor at sqrt(2h/g), and after each 2 sqrt(2h/g) again."""
    sim = thrown((5.0, 5.0), (0.0, 0.0), gravity=(0.0, -9.0), search=search)
    sim.record_events = True
    sim.advance(duration=40.5)
    fall = math.sqrt(2 * 4.5 / 9.0)
    assert sim.events["time"] == pytest.approx(fall * np.arange(1, 41, 2), rel=1e-14)
    assert (sim.events["particles"] == [0, -3]).all()
    assert sim.events["velocities"][:, 0, 1] == pytest.approx(9.0, rel=1e-14)


@pytest.mark.thorough
def test_ten_thousand_bounces_lose_no_height():
    sim = thrown((5.0, 5.0), (0.01, 0.0))
    fall = math.sqrt(2 * 4.5)
    sim.advance(until=20_000 * fall)
    assert sim.tally.wall_hits[2] == 10_000
    assert sim.state.positions[0, 1] == pytest.approx(5.0, abs=1e-8)
    assert sim.state.energy == pytest.approx(sim.initial_state.energy, rel=1e-11)
    assert sim.tally.wall_impulse[2] == pytest.approx(10_000 * 2 * fall, rel=1e-11)


@pytest.mark.interpreted
def test_a_ball_hits_the_ceiling_on_its_way_up():
    sim = thrown((5.0, 5.0), (0.0, 5.0))
    sim.record_events = True
    sim.advance(max_events=2)
    up = 5 - math.sqrt(25 - 9)
    assert sim.events["particles"][:, 1].tolist() == [-4, -3]
    down = -4 + math.sqrt(16 + 2 * 9)
    assert sim.events["time"] == pytest.approx([up, up + down], rel=1e-14)


@pytest.mark.interpreted
def test_two_that_fall_together_meet_as_if_they_did_not():
    particles = [gp.Particle((2.0, 60.0), (1.0, 0.0), 0.5), gp.Particle((6.0, 60.0), (0.0, 0.0), 0.5)]
    scene = gp.Scene(gp.Container((10.0, 100.0)), particles=particles, gravity=DOWN)
    sim = gp.Simulation(scene, gp.EventDriven())
    sim.advance(duration=4.0)
    assert sim.tally.collisions == 1
    assert sim.state.positions == pytest.approx(np.array([[5.0, 52.0], [7.0, 52.0]]), rel=1e-15)


@pytest.mark.thorough
@pytest.mark.parametrize("gravity", [(0.0, -1.0), (0.0, -1e9), (0.0, -1e-60), (0.0, 1e6), (-1.0, -1.0)])
def test_a_particle_at_rest_on_a_floor_stays_there(gravity):
    place = tuple(0.5 if g <= 0 else 9.5 for g in gravity)
    sim = thrown(place, (0.0, 0.0), gravity=gravity)
    sim.advance(duration=100.0)
    assert sim.state.positions.tolist() == [list(place)]
    assert sim.tally.wall_hits.sum() == 0


@pytest.mark.interpreted
def test_a_particle_slides_on_a_floor_and_is_pushed_off_it():
    particles = [gp.Particle((2.0, 0.5), (1.0, 0.0), 0.5), gp.Particle((6.0, 1.0), (0.0, 0.0), 1.0)]
    scene = gp.Scene(gp.Container((40.0, 10.0)), particles=particles, gravity=(0.0, -1.0))
    for search in ("boxes", "direct", "pairs"):
        sim = gp.Simulation(scene, gp.EventDriven(search))
        meet = 4.0 - math.sqrt(1.5**2 - 0.5**2)  # the large particle's centre is higher by a half
        sim.advance(duration=meet - 1e-9)
        assert sim.state.positions[0] == pytest.approx([2 + meet, 0.5], abs=1e-8)
        assert sim.tally.collisions == 0
        sim.advance(duration=2e-9)
        assert sim.tally.collisions == 1
        assert sim.state.velocities[1, 1] > 0  # lifted by the low one, which the floor throws back
        sim.check_invariants()


@pytest.mark.interpreted
def test_a_falling_particle_meets_one_that_lies():
    particles = [gp.Particle((5.0, 0.5), (0.0, 0.0), 0.5), gp.Particle((5.0, 5.5), (0.0, 0.0), 0.5)]
    scene = gp.Scene(gp.Container((10.0, 10.0)), particles=particles, gravity=(0.0, -2.0))
    sim = gp.Simulation(scene, gp.EventDriven())
    sim.record_events = True
    sim.advance(max_events=2)
    assert sim.events["time"] == pytest.approx([2.0, 2.0])
    assert sim.events["particles"].tolist() == [[0, 1], [0, -3]]


@pytest.mark.thorough
@pytest.mark.parametrize("speed", [1e-3, 1e-6, 1e-12, 1e-59])
def test_small_bounces_end_in_rest_not_in_a_loop(speed):
    sim = thrown((5.0, 0.5), (0.0, speed))
    sim.advance(duration=1e4 * speed)
    assert sim.tally.wall_hits[2] <= 5001
    assert sim.state.positions[0, 1] == pytest.approx(0.5, abs=speed**2)


@pytest.mark.interpreted
@pytest.mark.parametrize("pull", [1e-9, 1e-30, 1e-60])
def test_gravity_that_vanishes(pull):
    scene = gas(2, 30, 0.1, "wall")
    scenes = (replace(scene, gravity=gravity) for gravity in (None, (0.0, -pull)))
    plain, pulled = sims = [gp.Simulation(one, gp.EventDriven(), seed=3) for one in scenes]
    for sim in sims:
        sim.advance(duration=5.0)
    assert plain.tally.collisions == pulled.tally.collisions > 20
    assert np.allclose(plain.state.positions, pulled.state.positions, atol=1e5 * pull + 1e-7)


@pytest.mark.interpreted
@pytest.mark.parametrize("zero", [(0.0, 0.0), (0, 0), [0.0, -0.0]])
def test_zero_gravity_is_none_from_the_start(zero):
    """So that no rule about gravity holds for it: energy losses in steps, sticky faces, a piston."""
    scene = replace(gas(2, 30, 0.1, "wall"), gravity=zero)
    assert scene.gravity is None and scene == replace(scene, gravity=None)
    lossy = replace(scene, restitution=gp.Restitution(0.9))
    assert lossy.contact_duration == 0.0
    gp.Simulation(lossy, gp.TimeStepped(0.001)).advance(until=0.01)
    replace(scene, faces={"y_low": gp.Sticky(0.1), "y_high": gp.Piston(10.0, 1.0)})
    with pytest.raises(gp.SceneError, match="gravity.*list of 2"):
        replace(scene, gravity=(0.0, 0.0, 0.0))


@pytest.mark.thorough
def test_turned_velocities_run_back_until_chaos_takes_over():
    scene, gravity = gas(3, 30, 0.1, "wall"), (0.0, 0.2, -1.0)
    sim = gp.Simulation(replace(scene, gravity=gravity), gp.EventDriven(), seed=4)
    sim.record_events = True  # with the kernels of the searches' comparison
    sim.advance(duration=3.0)
    assert sim.tally.collisions > 20
    turned = replace(sim.state, velocities=-sim.state.velocities)
    back = gp.Simulation(sim.scene, gp.EventDriven(), initial=turned)
    back.record_events = True
    back.advance(duration=3.0)
    assert np.allclose(back.state.positions, sim.initial_state.positions, atol=1e-5)


@pytest.mark.interpreted
def test_what_is_refused():
    container = gp.Container((10.0, 10.0), ("wall", "periodic"))
    with pytest.raises(gp.SceneError, match="gravity.*periodic"):
        gp.Scene(container, gravity=(0.0, -1.0))
    gp.Scene(container, gravity=(1.0, 0.0))
