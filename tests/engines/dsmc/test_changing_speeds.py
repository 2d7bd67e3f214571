"""Starts at rest, cold, hot, and with one light or heavy particle, in scenes that change the speeds: the DSMC
engine with its own settings against the event-driven one."""

import math
from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp

pytestmark = pytest.mark.thorough

SIDE, COUNT, RADIUS = 8.0, 320, 0.05  # dilute: a contact value of 1.0008
OTHERS = gp.Species(COUNT - 1, RADIUS, temperature=1.0)
STARTS = {
    "rest": [gp.Species(COUNT, RADIUS)],
    "cold": [gp.Species(COUNT, RADIUS, speed=0.05)],
    "hot": [gp.Species(COUNT, RADIUS, temperature=50.0)],
    "light": [OTHERS, gp.Species(1, RADIUS, mass=1e-8, temperature=1.0)],
    "heavy": [OTHERS, gp.Species(1, RADIUS, mass=1e4, temperature=1e3)],
}
SCENES = {
    "thermostat": {"thermostat": gp.Thermostat(0.1, 0.05), "restitution": gp.Restitution(0.7)},
    "gravity": {"gravity": (0.0, 0.0, -0.3)},
    "thermal": {"faces": {"z_low": gp.Thermal(2.0), "z_high": gp.Thermal(0.5)}},
    "restitution": {"restitution": gp.Restitution(0.7)},
}
STILL = {("rest", "thermal"), ("rest", "restitution")}
"""Pairs in which nothing ever moves."""
POINTS = [gp.Species(COUNT, 1e-5)]
"""For a fall from rest: in columns the same particles would meet again and again, without molecular chaos."""
DURATION, SAMPLES, SEEDS = 30.0, 6, 12
SIZE = 0.01
"""What the size of the particles and of cells that hold 8 may change, relatively."""


def balance(sim, start):
    """By how much energy, losses and gains do not balance, over all that was exchanged."""
    state, tally = sim.state, sim.tally
    left = state.energy - start + tally.dissipated_energy - tally.thermostat_energy + tally.wall_energy.sum()
    parts = (start, state.kinetic_energy, tally.dissipated_energy, tally.thermostat_energy)
    return abs(left) / (sum(map(abs, parts)) + sim._dynamics.exchanged + 1e-300)


def measured(scene, engine, seed):
    """Of a run: the mean kinetic energy, and the momentum that the faces across z have taken per time."""
    sim = gp.Simulation(scene, engine.for_scene(scene, DURATION / SAMPLES), seed)
    start, energies = sim.initial_state.energy, []
    for n in range(SAMPLES):
        sim.advance(until=DURATION * (n + 1) / SAMPLES)
        energies.append(sim.state.kinetic_energy)
        sim.check_invariants()
    assert balance(sim, start) < 1e-11
    return np.mean(energies), sim.tally.wall_impulse[4:6].sum() / sim.time


def compared(start, kind, seeds):
    """Means (2,) of what is `measured` by the event-driven engine, and (2,) by how much that of the DSMC
    engine is above, with its error: both begin with the same particles for each seed."""
    kinds = POINTS if (start, kind) == ("rest", "gravity") else STARTS[start]
    scene = gp.Scene(gp.Container((SIDE,) * 3), kinds, **SCENES[kind])
    engines = gp.DSMC(), gp.EventDriven()
    one, other = np.array([[measured(scene, engine, seed) for seed in seeds] for engine in engines])
    error = (one - other).std(axis=0, ddof=1) / math.sqrt(len(seeds))
    return other.mean(axis=0), (one - other).mean(axis=0), error


@pytest.mark.parametrize("kind", SCENES)
@pytest.mark.parametrize("start", STARTS)
def test_energies_and_pressures_are_those_of_the_event_driven_engine(start, kind):
    if (start, kind) in STILL:
        scene = gp.Scene(gp.Container((SIDE,) * 3), STARTS[start], **SCENES[kind])
        sim = gp.Simulation(scene, gp.DSMC(0.5), 1)
        sim.advance(duration=DURATION)
        assert sim.state.kinetic_energy == sim.tally.dissipated_energy == sim.tally.collisions == 0
        return
    means, apart, error = compared(start, kind, range(SEEDS))
    assert (np.abs(apart) < 3.0 * error + SIZE * means).all(), (means, apart, error)


def test_an_own_step_fits_a_given_state_that_is_hotter():
    """Ten times as fast as the scene states: eight times as many parts, the power of two that fits."""
    scene = gp.Scene(gp.Container((12.0,) * 3, "periodic"), [gp.Species(300, 0.5, temperature=1.0)])
    steps = []
    for factor in (1.0, 10.0):
        state = gp.Simulation(scene, gp.DSMC(), 1).initial_state
        faster = replace(state, velocities=factor * state.velocities)
        simulation = gp.Simulation(scene, gp.DSMC(), 1, initial=faster)
        simulation.advance(until=5.0)
        steps.append(simulation.tally.steps)
    assert steps[1] == 8 * steps[0]
