"""The face of the library."""

import math
import subprocess
import sys
import warnings

import numpy as np
import pytest
from scenes import gas

import gaspart as gp


def test_same_seed_same_bits_and_another_seed_another_gas():
    scene = gas(3, 50, 0.1)
    ends = []
    for seed in (1, 1, 2, (1, 1)):
        sim = gp.Simulation(scene, gp.EventDriven(), seed=seed)
        sim.advance(duration=5.0)
        ends.append(sim.state.positions)
    assert np.array_equal(ends[0], ends[1])
    assert not np.array_equal(ends[0], ends[2])
    assert not np.array_equal(ends[0], ends[3])


@pytest.mark.interpreted
@pytest.mark.parametrize("engine", [gp.EventDriven(), gp.TimeStepped(0.01)])
@pytest.mark.parametrize(
    ("target", "key"),
    [
        *(({"until": value}, "until") for value in (math.nan, math.inf, -1.0, "1", True)),
        *(({"duration": value}, "duration") for value in (math.nan, math.inf, -1.0, "1")),
        *(({"max_events": value}, "max_events") for value in (-1, 1.5, "7", True, math.nan)),
        ({"duration": 1e308, "until": math.nan}, "until"),
        ({}, "duration"),
    ],
)
def test_an_invalid_target_is_refused_and_changes_nothing(engine, target, key):
    sim = gp.Simulation(gas(2, 20, 0.1, "wall"), engine, seed=1)
    before = sim.state
    with pytest.raises(gp.SceneError) as caught:
        sim.advance(**target)
    assert caught.value.key == key and "\n" not in str(caught.value)
    assert sim.time == 0.0 and np.array_equal(sim.state.positions, before.positions)
    sim.add_random(1, 0.1)  # which is refused after the first advance


@pytest.mark.interpreted
def test_the_time_stepped_engine_refuses_unreachable_targets():
    sim = gp.Simulation(gas(2, 20, 0.1, "wall"), gp.TimeStepped(0.01), seed=1)
    for target, key in (
        ({"until": math.inf, "max_events": 3}, "max_events"),
        ({"until": 1e300}, "until"),
        ({"duration": 1e308}, "until"),
    ):
        with pytest.raises(gp.SceneError) as caught:
            sim.advance(**target)
        assert caught.value.key == key and sim.time == 0.0
    sim.add_random(1, 0.1)


@pytest.mark.parametrize("make", [gp.EventDriven, lambda **given: gp.TimeStepped(0.1, **given)])
@pytest.mark.parametrize(
    "given", [10**9, (10**5, 10**5), (1,) * 4, 0, -1, 1.5, "9", math.nan, (3, None), True]
)
def test_an_invalid_partition_is_refused_before_anything_is_allocated(make, given):
    with pytest.raises(gp.SceneError, match="boxes_per_side = ") as caught:
        make(boxes_per_side=given)
    assert caught.value.key == "boxes_per_side"


def test_recording_changes_no_bit():
    plain, recorded = (gp.Simulation(gas(2, 50, 0.2, "wall"), gp.EventDriven(), seed=1) for _ in range(2))
    recorded.record_events = True
    for sim in (plain, recorded):
        sim.advance(duration=300.0)
    assert np.array_equal(plain.state.positions, recorded.state.positions)
    events = recorded.events
    hits = plain.tally.wall_hits.sum()
    assert len(events["time"]) == plain.tally.collisions + hits > 4096  # more than the record holds at once
    assert (np.diff(events["time"]) >= -1e-12).all()
    assert (events["particles"][:, 1] < 0).sum() == hits
    pairs = events["particles"][:, 1] >= 0
    r = events["positions"][pairs, 1] - events["positions"][pairs, 0]
    assert np.allclose((r**2).sum(axis=1), 1.0, atol=1e-10)


@pytest.mark.interpreted
def test_replay_by_time_and_by_event():
    sim = gp.Simulation(gas(2, 10, 0.1, "wall"), gp.EventDriven(), seed=1)
    sim.advance(duration=4.0)
    frames = list(sim.replay(by="time", interval=0.5))
    assert [frame.time for frame in frames] == [0.5 * n for n in range(9)]
    assert np.array_equal(frames[0].positions, sim.initial_state.positions)
    assert np.array_equal(frames[-1].positions, sim.state.positions)
    events = list(sim.replay(by="event"))
    assert len(events) == 2 + sim.tally.collisions + sim.tally.wall_hits.sum()
    assert np.array_equal(events[-1].positions, sim.state.positions)


@pytest.mark.interpreted
def test_chosen_properties_at_any_time():
    sim = gp.Simulation(gas(2, 10, 0.1, "wall"), gp.EventDriven(), seed=1)
    sim.advance(duration=4.0)
    found = sim.properties("positions", "speeds", "kinetic_energies", "radii", at=[3.25, 0.0, 4.0, 3.25])
    assert found["time"].tolist() == [3.25, 0.0, 4.0, 3.25]
    assert found["positions"].shape == (4, 10, 2) and found["radii"].shape == (4, 10)
    assert np.array_equal(found["positions"][0], found["positions"][3])
    assert np.array_equal(found["positions"][1], sim.initial_state.positions)
    now = sim.properties("positions", "speeds")
    assert np.array_equal(found["positions"][2], now["positions"])
    assert found["speeds"][2] == pytest.approx(np.hypot(*sim.state.velocities.T), rel=1e-15)
    assert found["kinetic_energies"].sum(axis=1) == pytest.approx(sim.state.kinetic_energy, rel=1e-12)
    for wrong in ({"at": [4.5]}, {"at": [-1.0]}):
        with pytest.raises(gp.SceneError, match="at = "):
            sim.properties("positions", **wrong)
    with pytest.raises(gp.SceneError, match="properties = 'time'"):
        sim.properties("time")


@pytest.mark.interpreted
def test_energies_of_spinning_and_fixed_particles():
    for spin in (2.0, (0.0, 0.0, 2.0)):
        d = 2 if isinstance(spin, float) else 3
        particles = [
            gp.Particle((1.0,) * d, (1.0,) * d, 0.5, mass=3.0, spin=spin, moment_of_inertia=4.0),
            gp.Particle((3.0,) * d, (0.0,) * d, 0.5, fixed=True),
        ]
        sim = gp.Simulation(gp.Scene(gp.Container((5.0,) * d), particles=particles), gp.EventDriven())
        assert sim.properties("kinetic_energies")["kinetic_energies"].tolist() == [1.5 * d + 8.0, 0.0]
        assert sim.state.kinetic_energy == 1.5 * d + 8.0


@pytest.mark.interpreted
def test_max_events_is_exact_and_tallies_can_be_reset():
    sim = gp.Simulation(gas(2, 50, 0.2), gp.EventDriven(), seed=1)
    sim.advance(max_events=123)
    assert sim.tally.collisions == 123
    time = sim.time
    sim.reset_tally()
    sim.advance(max_events=7)
    assert sim.tally.collisions == 7
    assert sim.tally.time == pytest.approx(sim.time - time)
    sim.advance(duration=1e9, max_events=0)
    assert sim.tally.collisions == 7


@pytest.mark.interpreted
def test_particles_are_added_before_the_start_only():
    sim = gp.Simulation(gp.Scene(gp.Container((10.0, 10.0))), gp.EventDriven(), seed=1)
    sim.add(position=(5.0, 5.0), velocity=(1.0, 0.0), radius=1.0, mass=2.0)
    sim.add_random(10, radius=0.3, speed=1.0)
    assert sim.scene.count == 11
    assert sim.state.positions[0].tolist() == [5.0, 5.0]
    with pytest.raises(gp.SceneError, match="overlaps"):
        sim.add(position=(5.5, 5.0), velocity=(0.0, 0.0), radius=1.0)
    assert sim.scene.count == 11
    sim.advance(duration=1.0)
    with pytest.raises(gp.SceneError, match="before the first advance"):
        sim.add_random(1, radius=0.3)


@pytest.mark.parametrize("search", ["boxes", "pairs"])
def test_work_is_bounded_where_nothing_but_crossings_happens(search):
    """Two discs that cross a thin periodic axis a million million times and never meet."""
    discs = [gp.Particle((0.5, height), (1.0, 0.0), 0.05) for height in (1e9, 9e9)]
    scene = gp.Scene(gp.Container((1.0, 1e10), "periodic"), particles=discs)
    sim, whole = (gp.Simulation(scene, gp.EventDriven(search), seed=1) for _ in range(2))
    crossed, pieces = 0, [100_000, 1, 7, 100_000]
    for work in pieces:
        before = sim.time
        sim.advance(until=1e12, max_work=work)
        images = int(sim.state.images.sum())
        assert work // 2 - 2 <= images - crossed <= work + 2  # both stand at the face just now
        assert before <= sim.time
        crossed = images
    whole.advance(until=sim.time)
    for name in ("positions", "velocities", "images"):
        assert np.array_equal(getattr(sim.state, name), getattr(whole.state, name)), name


@pytest.mark.interpreted
def test_work_is_a_whole_number_and_counted_by_the_event_driven_engine_only():
    sim = gp.Simulation(gas(2, 5, 0.1), gp.EventDriven(), seed=1)
    for given, key in (({"duration": 1.0, "max_work": 0}, "max_work"), ({"max_work": 1}, "duration")):
        with pytest.raises(gp.SceneError, match=key):
            sim.advance(**given)
    sim = gp.Simulation(gas(2, 5, 0.1), gp.TimeStepped(0.01), seed=1)
    with pytest.raises(gp.SceneError, match="max_work"):
        sim.advance(duration=1.0, max_work=5)


@pytest.mark.interpreted
def test_states_cannot_be_changed_and_copies_of_them_and_tallies_are_copies():
    sim = gp.Simulation(gas(2, 5, 0.1), gp.EventDriven(), seed=1)
    for state in (sim.initial_state, sim.state):
        for change in (state.positions, state.velocities, state.masses, state.images):
            with pytest.raises(ValueError, match="read-only"):
                change[:] = 0
        state.copy().velocities[:] = 0
    sim.tally.wall_hits[:] = 7
    assert sim.state.velocities.any()
    assert sim.initial_state.positions.any()
    assert not sim.tally.wall_hits.any()


def test_engines_can_be_serialised():
    for engine in (
        gp.EventDriven("direct"),
        gp.EventDriven(boxes_per_side=(2, 3)),
        gp.TimeStepped(0.1, 4, "float32"),
    ):
        assert gp.engine_from_dict(gp.engine_to_dict(engine)) == engine


CONTAINER = gp.Container(lengths=(20.0, 20.0))


def simulated(**scene):
    species = scene.pop("species", [gp.Species(count=10, radius=0.5)])
    return gp.Simulation(gp.Scene(container=CONTAINER, species=species, **scene), seed=1)


@pytest.mark.interpreted
def test_a_gas_at_rest_warns():
    simulation = simulated()
    with pytest.warns(UserWarning, match="give a species a temperature or a speed"):
        simulation.advance(0.5)
    assert simulation.tally.collisions == simulation.tally.wall_hits.sum() == 0


@pytest.mark.interpreted
@pytest.mark.parametrize(
    "scene",
    [
        {"species": [gp.Species(count=10, radius=0.5, speed=1.0)]},
        {"gravity": (0.0, -1.0)},
        {"thermostat": gp.Thermostat(power=1.0, interval=0.1)},
        {"faces": {"x_low": gp.Piston(speed=0.1)}},
        {"species": [gp.Species(count=10, radius=0.5, fixed=True)]},
    ],
    ids=["speed", "gravity", "thermostat", "piston", "fixed"],
)
def test_a_gas_that_something_moves_does_not(scene):
    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        simulated(**scene)._warn_at_rest()  # without the kernels of each scene


def test_the_command_line_warns_in_one_line(tmp_path):
    scene = tmp_path / "rest.yaml"
    scene.write_text("container: {lengths: [20.0, 20.0]}\nspecies: [{count: 10, radius: 0.5}]\n")
    words = ["run", str(scene), "-o", str(tmp_path / "rest.nc"), "--duration", "1", "--sample-interval", "1"]
    command = [sys.executable, "-m", "gaspart", *words]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0
    assert done.stderr.count("warning: all particles are at rest") == 1
    assert "simulation.advance" not in done.stderr
