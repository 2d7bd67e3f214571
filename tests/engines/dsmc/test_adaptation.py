"""Steps, cells and sums that follow a gas whose speeds and densities change: the same bits however a run is
split, and a line where a step that was given is too long."""

import math
import warnings

import numpy as np
import pytest
from engines.dsmc.steps import make
from referee import check_same, restored

import gaspart as gp
from gaspart.engines.dsmc.defaults import LONGEST, MOST, ROOM, rates, reach_of
from gaspart.engines.dsmc.resolution import EPOCH

SLIT = ("periodic", "periodic", "wall")


def driven(speed=0.01, power=0.05, interval=0.1, count=150):
    """A granular gas that starts cold and is heated 1e4 times."""
    rest = {"restitution": gp.Restitution(0.7), "thermostat": gp.Thermostat(power, interval)}
    container = gp.Container((20.0, 20.0, 20.0), "periodic")
    return gp.Scene(container, [gp.Species(count, 0.5, speed=speed)], **rest)


def falling():
    """A gas that falls from rest into a tenth of its container, by hot faces that keep it there."""
    container, gas = gp.Container((6.0, 6.0, 20.0), SLIT), gp.Species(600, 0.05, temperature=1.0)
    return gp.Scene(container, [gas], gravity=(0.0, 0.0, -1.0), faces={"z_low": gp.Thermal(1.0)})


def check_split(scene, engine, steps, threads):
    """A run in one piece, one of single steps, one that is restored often, and one by more threads."""
    whole, single, kept = (gp.Simulation(scene, engine, 3) for _ in range(3))
    other = gp.Simulation(scene, gp.DSMC(**{**vars(engine), "threads": threads}), 3)
    make(whole, steps)
    make(other, steps)
    for n in range(steps):
        make(single, 1)
        assert single.state.count == scene.count  # reading it changes nothing
        if n % 7 == 0:
            kept = restored(kept)
        make(kept, 1)
    for sim in (single, kept, other):
        check_same(whole, sim)
    whole.check_invariants()
    return whole


@pytest.mark.thorough
def test_divided_steps_give_the_same_bits_however_a_run_is_split():
    sim = check_split(driven(), gp.DSMC(time_step=20.0, adapt="both"), 40, 2)
    assert sim.tally.steps > 100 * 40  # parts
    assert sim.tally.time == 800.0


@pytest.mark.thorough
@pytest.mark.parametrize("model", ["boltzmann", "enskog"])
def test_cells_that_follow_the_density_give_the_same_bits_however_a_run_is_split(model):
    scene = falling()
    start = gp.Simulation(scene, gp.DSMC(model=model), 3)._dynamics.cells_per_side
    sim = check_split(scene, gp.DSMC(model=model), 3 * EPOCH + 5, 2)
    cells = sim._dynamics.cells_per_side
    assert math.prod(cells) > 1.5 * math.prod(start)
    heights = sim.state.positions[:, 2]
    assert np.mean(heights) < 3.0


@pytest.mark.thorough
def test_tiny_energies_are_counted():
    """From rest, with a power of 1e-40 or less: what is given is kept or dissipated."""
    for power in (1e-40, 1e-60):
        scene = driven(0.0, power, 1.0)
        sim = gp.Simulation(scene, gp.DSMC().for_scene(scene), 1)
        sim.advance(duration=4.0 * sim.engine.time_step)
        tally, energy = sim.tally, sim.state.kinetic_energy
        assert tally.thermostat_energy == pytest.approx(150 * power * sim.time, rel=0.5)
        assert 0.0 < tally.dissipated_energy < tally.thermostat_energy
        assert energy + tally.dissipated_energy == pytest.approx(tally.thermostat_energy, rel=1e-13)
        sim.check_invariants()


@pytest.mark.thorough
@pytest.mark.parametrize(("speed", "step", "duration"), [(1e-5, 0.5, 100.0), (1e-3, 0.1, 20.0)])
def test_energies_a_thousand_million_times_those_of_the_start_balance(speed, step, duration):
    scene = driven(speed, 1.0, 0.1, 100)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sim = gp.Simulation(scene, gp.DSMC(time_step=step), 1)
        for _ in range(10):
            sim.advance(duration=duration / 10)
            sim.check_invariants()
    tally = sim.tally
    left = sim.state.kinetic_energy - sim.initial_state.kinetic_energy
    left += tally.dissipated_energy - tally.thermostat_energy
    assert left == pytest.approx(0.0, abs=1e-13 * tally.thermostat_energy)
    assert tally.dissipated_energy > 0.0


@pytest.mark.interpreted
def test_a_step_of_its_own_allows_for_what_accelerates_the_particles():
    """They fly no farther in it than a fifth of a mean free path, by what gravity and kicks give them."""
    scene = driven(0.0)
    step = gp.DSMC().for_scene(scene).time_step
    way = math.sqrt(2.0 * 0.05 * step) * step
    assert way == pytest.approx(LONGEST * rates(scene, False).path, rel=2e-3)
    fall = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(9, 0.01)], gravity=(0.0, -2.0))
    assert gp.DSMC().for_scene(fall).time_step == pytest.approx(math.sqrt(9.0 / 8.0 / 2.0), rel=2e-3)
    with pytest.raises(gp.SceneError, match="time_step = None: must be given for particles that start at "):
        gp.DSMC().for_scene(gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(9, 0.01)]))


@pytest.mark.thorough
def test_parts_of_a_step_are_as_short_as_is_stated():
    """At every end of a step the mean speed times the last part is within sqrt 2 of what is recommended."""
    scene = driven()
    sim = gp.Simulation(scene, gp.DSMC(), 1)
    reach = reach_of(scene, rates(scene, False).path)
    for _ in range(60):
        before = sim.tally.steps
        make(sim, 1)
        part = sim.engine.time_step / (sim.tally.steps - before)
        speed = float(np.sqrt((sim.state.velocities**2).sum(axis=1)).mean())
        assert speed * part < ROOM * 1.3 * reach.recommended


@pytest.mark.thorough
def test_a_step_that_was_given_is_kept_and_warned_of_once():
    scene = driven()
    sim = gp.Simulation(scene, gp.DSMC(time_step=20.0), 1)
    with pytest.warns(UserWarning, match=r"time_step = 20 is .* mean free times by time .* with a step of "):
        sim.advance(duration=200.0)
    assert sim.tally.steps == 10
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sim.advance(duration=200.0)


@pytest.mark.interpreted
@pytest.mark.parametrize("step", [1e9, 1e59])
@pytest.mark.parametrize("start", [{"temperature": 1.0}, {}])
def test_a_step_of_many_mean_free_times_is_refused_with_one_that_would_do(step, start):
    more = {} if start else {"gravity": (0.0, 0.0, -1.0)}
    scene = gp.Scene(gp.Container((9.0, 9.0, 9.0)), [gp.Species(50, 0.5, **start)], **more)
    with pytest.raises(gp.SceneError, match=rf"time_step = .*more than {MOST:g} mean free paths.* at most$"):
        gp.Simulation(scene, gp.DSMC(time_step=step), 1)


@pytest.mark.thorough
def test_a_gas_that_becomes_too_fast_for_its_step_stops_with_a_line_and_its_state():
    scene = driven(0.01, 1e-3, 0.1)
    hot = gp.Scene(scene.container, scene.species, thermostat=gp.Thermostat(1e8, 1e-3))
    with pytest.raises(gp.SceneError, match="time_step"):
        gp.Simulation(hot, gp.DSMC(time_step=10.0), 1)
    slow = gp.Scene(scene.container, scene.species, thermostat=gp.Thermostat(30.0, 0.1))
    sim = gp.Simulation(slow, gp.DSMC(time_step=30.0), 1)
    line = pytest.raises(gp.SimulationError, match=r"at time .* time_step = 30 .* would do$")
    with warnings.catch_warnings(), line as caught:
        warnings.simplefilter("ignore")
        sim.advance(duration=1e9)
    assert "\n" not in str(caught.value)
    sim.check_invariants()
    assert sim.time > 0.0 and sim.time % 30.0 == 0.0


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("settings", "adapt"),
    [
        ({}, "both"),
        ({"time_step": 0.5}, "cells"),
        ({"cells_per_side": 2}, "steps"),
        ({"time_step": 0.5, "cells_per_side": 2}, None),
        ({"time_step": 0.5, "cells_per_side": 2, "adapt": "both"}, "both"),
        ({"adapt": "nothing"}, None),
    ],
)
def test_what_was_not_given_adapts_and_the_settings_state_so(settings, adapt):
    engine = gp.DSMC(**settings).for_scene(driven())
    assert engine.adapt == adapt
    assert engine == engine.for_scene(driven())
    assert gp.engine_from_dict(gp.engine_to_dict(engine)) == engine
    assert engine.with_step(0.25).time_step == 0.25 and not engine.with_step(0.25).adapts_steps
