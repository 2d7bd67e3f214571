"""The time-stepped engine: one result whatever the boxes, and the event-driven engine as its limit."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import gas, mixtures

import gaspart as gp
from gaspart.engines.step.limits import check_scene

SEARCHES = (
    {"boxes_per_side": 1},
    {"boxes_per_side": 2, "near_boxes": True},
    {"boxes_per_side": 3, "near_boxes": True},
    {},
    {"skin": 0.05},
    {"skin": 2.0},
)
TWO = gp.Particle((2.0, 5.0), (1.0, 0.1), 0.5), gp.Particle((6.0, 5.4), (-0.5, 0.0), 0.5, mass=3.0)


@pytest.mark.thorough
@given(
    mixtures(most=20), st.sampled_from(["float64", "float32"]), st.booleans(), st.sampled_from([1, 3]),
    st.integers(0, 2**32),
)  # fmt: skip
def test_any_search_gives_the_same_bits(scene, precision, rewind, passes, seed):
    """Discs in double precision only, so that fewer kernels are compiled."""
    precision = precision if scene.dimension == 3 else "float64"
    ends = []
    for search in SEARCHES:
        engine = gp.TimeStepped(0.01, precision=precision, rewind=rewind, passes=passes, **search)
        try:
            sim = gp.Simulation(scene, engine, seed=seed)
        except gp.SceneError as error:
            assert error.key in ("boxes_per_side", "lengths", "time_step")
            continue
        try:
            sim.advance(duration=3.0)
        except gp.SimulationError as error:  # too dense for the step: all searches must say the same
            ends.append((str(error),))
            continue
        tally = sim.tally
        ends.append((sim.state.unwrapped, tally.wall_impulse, tally.virial_sum, tally.overlaps_left))
    for end in ends[1:]:
        assert all(np.array_equal(one, other) for one, other in zip(ends[0], end, strict=True))


@pytest.mark.interpreted
@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("boxes", [1, 2, 3])
def test_near_boxes_are_searched_across_a_periodic_face(axis, boxes):
    """Two discs meet head-on at the face; the second of two boxes is also beyond it."""
    places, speeds = np.full((2, 2), 3.0), np.zeros((2, 2))
    places[:, axis], speeds[:, axis] = (0.6, 5.4), (-1.0, 1.0)
    pair = [gp.Particle(tuple(x), tuple(v), 0.5) for x, v in zip(places, speeds, strict=True)]
    scene = gp.Scene(gp.Container((6.0, 6.0), "periodic"), particles=pair)
    sim = gp.Simulation(scene, gp.TimeStepped(0.01, boxes_per_side=boxes, near_boxes=True))
    sim.advance(duration=1.0)
    assert sim.tally.collisions == 1


@pytest.mark.interpreted
def test_one_box_tests_each_pair_once_a_step():
    sim = gp.Simulation(gas(3, 40, 0.01), gp.TimeStepped(0.01, boxes_per_side=1, passes=1), seed=1)
    sim.advance(duration=1.0)
    assert sim.tally.steps == 100
    assert sim.tally.pair_tests == 100 * 40 * 39 // 2
    assert sim.tally.box_visits == 100 * 40


@pytest.mark.thorough
@pytest.mark.parametrize(("precision", "rounding"), [("float64", 1e-13), ("float32", 3e-5)])
def test_energy_is_kept_to_rounding(precision, rounding):
    sim = gp.Simulation(gas(2, 100, 0.2, "wall"), gp.TimeStepped(0.01, precision=precision), seed=1)
    sim.advance(duration=100.0)
    assert sim.tally.collisions > 5000
    assert sim.state.kinetic_energy == pytest.approx(sim.initial_state.kinetic_energy, rel=rounding)


@pytest.mark.interpreted
def test_a_rewound_collision_is_exact():
    """Wherever in the step the contact falls, the particles go on as if it had been met exactly."""
    scene = gp.Scene(gp.Container((10.0, 10.0)), particles=TWO)
    exact = gp.Simulation(scene, gp.EventDriven())
    exact.advance(duration=3.0)
    for time_step in (0.25, 0.03, 0.001):
        sim = gp.Simulation(scene, gp.TimeStepped(time_step))
        sim.advance(duration=3.0)
        assert sim.tally.collisions == exact.tally.collisions == 1
        assert np.allclose(sim.state.velocities, exact.state.velocities, atol=1e-13)
        assert np.allclose(sim.state.positions, exact.state.positions, atol=1e-12)


@pytest.mark.interpreted
@pytest.mark.parametrize("boundary", ["wall", "periodic"])
def test_a_step_longer_than_the_container_leaves_no_particle_outside(boundary):
    particle = gp.Particle((2.0, 5.0), (130.0, 0.0), 0.5)
    scene = gp.Scene(gp.Container((10.0, 10.0), boundary), particles=[particle])
    sim = gp.Simulation(scene, gp.TimeStepped(1.0))
    for _ in range(20):
        sim.advance(duration=1.0)
        assert 0 <= sim.state.positions[0, 0] <= 10


@pytest.mark.interpreted
@pytest.mark.parametrize("normal", [0.0, 0.5, 0.9])
def test_inelastic_contacts_follow_the_event_driven_engine(normal):
    """Two particles among walls: what each contact and each wall takes, and where the particles are then."""
    scene = gp.Scene(gp.Container((10.0, 10.0)), particles=TWO, restitution=gp.Restitution(normal))
    exact, sim = gp.Simulation(scene, gp.EventDriven()), gp.Simulation(scene, gp.TimeStepped(0.02))
    for each in (exact, sim):
        each.advance(duration=20.0)
        each.check_invariants()
    assert exact.tally.collisions == 1
    assert sim.tally.wall_hits.tolist() == exact.tally.wall_hits.tolist()
    assert np.allclose(sim.state.positions, exact.state.positions, atol=1e-9)
    assert np.allclose(sim.tally.wall_impulse, exact.tally.wall_impulse, rtol=1e-7)
    assert sim.tally.dissipated_energy == pytest.approx(exact.tally.dissipated_energy, rel=1e-9)


@pytest.mark.thorough
def test_a_granular_gas_cools_as_in_the_event_driven_engine():
    """Most of its energy goes, by the same path in both."""
    container, gas = gp.Container((60.0, 60.0), ("wall", "periodic")), gp.Species(600, 0.5, temperature=1.0)
    scene = gp.Scene(container, [gas], restitution=gp.Restitution(0.9))
    exact = gp.Simulation(scene, gp.EventDriven(), seed=3)
    exact.advance(duration=20.0)
    assert exact.state.kinetic_energy < 0.4 * exact.initial_state.kinetic_energy
    sim = gp.Simulation(scene, gp.TimeStepped(0.02), seed=3)
    sim.advance(duration=20.0)
    sim.check_invariants()
    # 4000 contacts take a hundredth of the energy, each; their number and depth vary by less than 2 %
    assert sim.state.kinetic_energy == pytest.approx(exact.state.kinetic_energy, rel=0.02)


@pytest.mark.interpreted
def test_time_is_a_whole_number_of_steps():
    sim = gp.Simulation(gas(2, 5, 0.01), gp.TimeStepped(0.1), seed=1)
    sim.advance(duration=0.35)
    assert sim.time == pytest.approx(0.3)
    for _ in range(7):
        sim.advance(until=sim.time + 0.1)
    assert sim.tally.steps == 10


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("settings_", "key"),
    [
        ({"time_step": 0.0}, "time_step"),
        ({"time_step": math.nan}, "time_step"),
        ({"time_step": 0.1, "precision": "float16"}, "precision"),
    ],
)
def test_settings_that_are_none(settings_, key):
    with pytest.raises(gp.SceneError, match=key):
        gp.TimeStepped(**settings_)


@pytest.mark.interpreted
def test_what_it_cannot_do_it_refuses():
    falling = replace(gas(2, 5, 0.01, "wall"), gravity=(0.0, -1.0))
    fixed = replace(falling, species=[gp.Species(2, 0.3, fixed=True)])
    lossy = replace(falling, restitution=gp.Restitution(0.9))
    for scene, key in ((lossy, "restitution.normal"), (fixed, "fixed")):
        with pytest.raises(gp.SceneError, match=f'{key} = .*"event" .*engine'):
            gp.Simulation(scene, gp.TimeStepped(0.1))
    sim = gp.Simulation(gas(2, 5, 0.01), gp.TimeStepped(0.1), seed=1)
    with pytest.raises(gp.SceneError, match="max_events"):
        sim.advance(max_events=3)
    with pytest.raises(gp.SceneError, match="record_events"):
        sim.record_events = True


@pytest.mark.interpreted
def test_more_particles_than_a_list_can_tell_are_refused():
    with pytest.raises(gp.SceneError, match="at most"):
        check_scene(gas(3, 8, 0.1), SimpleNamespace(count=2**28), None)


@pytest.mark.interpreted
def test_a_bouncing_ball_follows_its_parabolas():
    """Whatever the step, the ball is where the event-driven engine has it; many bounces fit into one step."""
    ball = gp.Particle((2.0, 3.0), (1.0, 0.0), 0.5)
    scene = gp.Scene(gp.Container((10.0, 10.0)), particles=[ball], gravity=(0.0, -2.0))
    exact = gp.Simulation(scene, gp.EventDriven())
    exact.advance(duration=16.0)
    for time_step in (8.0, 0.25, 0.001):
        sim = gp.Simulation(scene, gp.TimeStepped(time_step))
        sim.advance(duration=16.0)
        assert sim.tally.wall_hits.tolist() == exact.tally.wall_hits.tolist()
        assert np.allclose(sim.state.positions, exact.state.positions, atol=1e-9)
        assert np.allclose(sim.tally.wall_impulse, exact.tally.wall_impulse, rtol=1e-7)


@pytest.mark.thorough
def test_oversized_and_fixed_particles_follow_the_event_driven_engine():
    """A particle larger than a box is kept outside the partition, a fixed one passes no momentum on."""
    large = gp.Particle((10.0, 10.0), (0.1, 0.0), 4.0, mass=50.0)
    particles = [large, gp.Particle((3.0, 16.0), (0.0, 0.0), 0.5, fixed=True)]
    kinds = [gp.Species(25, 0.3, temperature=1.0)]
    scene = gp.Scene(gp.Container((20.0, 20.0), "periodic"), kinds, particles)
    exact = gp.Simulation(scene, gp.EventDriven(), seed=5)
    exact.advance(duration=5.0)
    assert exact.tally.collisions > 5
    for search in ({}, {"boxes_per_side": 20}):  # boxes of 1, the large particle of 8
        sim = gp.Simulation(scene, gp.TimeStepped(0.0005, **search), seed=5)
        sim.advance(duration=5.0)
        assert sim.tally.collisions == exact.tally.collisions
        assert np.allclose(sim.state.unwrapped, exact.state.unwrapped, atol=1e-8)


@pytest.mark.thorough
def test_more_passes_find_what_one_misses():
    """Of dilute discs one pass misses (v_th dt/sigma)^2 of the contacts, several a quarter of that."""
    scene, time_step = gas(2, 400, 0.02), 0.25
    met = {}
    for passes in (1, 4):
        sim = gp.Simulation(scene, gp.TimeStepped(time_step, passes=passes), seed=1)
        sim.advance(duration=4000.0)
        met[passes] = sim.tally.collisions
        assert sim.tally.overlaps_left < 0.01 * met[passes]
    missed = (1 - 1 / 4) * time_step**2
    assert 1 - met[1] / met[4] == pytest.approx(missed, abs=4 / math.sqrt(met[4]), rel=0.3)


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("count", "eta", "time_step"), [(100, 0.01, 0.6), (200, 0.4, 0.5), (32, 0.724, 0.014)]
)
def test_a_step_that_is_too_long_is_refused(count, eta, time_step):
    scene = gas(3, count, eta, arrangement="lattice")
    with pytest.raises(gp.SceneError, match=r"time_step = .* a step of \S+ would do") as refused:
        gp.Simulation(scene, gp.TimeStepped(time_step), seed=1)
    would_do = float(str(refused.value).split("a step of ")[1].split()[0])
    gp.Simulation(scene, gp.TimeStepped(0.98 * would_do), seed=1)
    with pytest.warns(UserWarning, match="would do"):
        gp.Simulation(scene, gp.TimeStepped(1.1 * would_do), seed=1)
