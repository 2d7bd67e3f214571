"""Random granular scenes: mixtures of discs or spheres that fall among walls with ends, any contact law."""

import math

import numpy as np
import pytest
from scenes import closest

import gaspart as gp

pytestmark = pytest.mark.thorough

TIME = 100.0
EVENTS = 200  # contacts of each particle
ROUNDING = 1e-9


def granular_scene(rng, dimension=2):
    """A mixture of two masses that falls, in any direction or on the floor, among one to three interior
    walls, which may touch each other and the faces."""
    lengths = rng.uniform(8.0, 14.0, dimension) if dimension == 2 else rng.uniform(4.0, 7.0, dimension)
    gravity = np.zeros(dimension)
    gravity[-1] = -1.0
    if rng.random() < 0.4:
        gravity = rng.normal(size=dimension)
        gravity /= np.linalg.norm(gravity)
    temperature, radius = float(rng.choice([0.1, 1.0, 10.0])), rng.uniform(0.2, 0.45)
    few = int(rng.integers(1, 8))
    species = [
        gp.Species(int(rng.integers(8, 40)), radius, temperature=temperature),
    ]
    size = radius * rng.uniform(0.3, 1.8)
    species.append(gp.Species(few, size, mass=float(rng.choice([0.1, 3.0, 10.0])), temperature=1.0))
    if rng.random() < 0.3:
        species.append(gp.Species(int(rng.integers(1, 4)), radius, fixed=True))
    normal = float(rng.choice([0.0, 0.1, 0.5, 0.8, 0.95, 0.99, rng.random()]))
    law = gp.Restitution(normal, float(rng.choice([-1.0, -1.0, -0.5, 0.0, 0.5, 0.9, 1.0])))
    rest = {"gravity": tuple(rng.choice([0.1, 1.0, 5.0]) * gravity), "restitution": law}
    walls = [wall_of(rng, lengths) for _ in range(int(rng.integers(1, 4)))]
    return gp.Scene(gp.Container(tuple(lengths)), species, walls=walls, **rest)


def wall_of(rng, lengths):
    """A wall anywhere; one in four is a floor, one in four begins at the middle of a face: a wedge."""
    start, end = rng.uniform(0.0, 1.0, (2, len(lengths))) * lengths
    kind = rng.integers(4)
    if kind == 0:
        end[-1] = start[-1]
    elif kind == 1:
        start = 0.5 * lengths
        start[0] = 0.0
    if len(lengths) == 2:
        return gp.Wall(tuple(start), tuple(end))
    along = 0.3 * (end - start)
    across = np.cross(along, rng.normal(size=3))
    across *= 0.2 / np.abs(across).max()
    start = np.clip(start, 2.5, lengths - 2.5)
    return gp.Plate(tuple(start), (tuple(along), tuple(across)))


def faults(scene, seed):
    """What is wrong with a run, if anything."""
    sim = gp.Simulation(scene, gp.EventDriven(), seed)
    start = sim.initial_state
    weights = start.masses[np.isfinite(start.masses)].sum() * np.abs(scene.gravity)
    scale = start.kinetic_energy + weights @ np.array(scene.container.lengths)
    energy, found = start.energy, []
    for time in np.arange(0.1, 1.05, 0.1) * TIME:
        sim.advance(until=time)
        energy, before = sim.state.energy, energy
        if energy > before + ROUNDING * scale:
            found.append(f"the energy rises by {energy - before:g} before {time:g}")
    while (
        2 * sim.tally.collisions < EVENTS * scene.count
        and sim.time < 10.0 * TIME
        and np.any(sim.state.velocities)
    ):
        sim.advance(duration=TIME)
    sim.check_invariants()
    if (gap := closest(scene, sim.state)) < -ROUNDING:
        found.append(f"particles overlap by {-gap:g}")
    for position, radius in zip(sim.state.positions, sim.state.radii, strict=True):
        if wall := scene.wall_at(tuple(position), radius * (1.0 - ROUNDING)):
            found.append(f"a particle overlaps {wall}")
    return found


def all_faults(seeds, dimension=2):
    """Seed and faults of each random scene that has some; scenes that cannot be are left out."""
    found, runs = {}, 0
    for seed in seeds:
        rng = np.random.default_rng(seed)
        try:
            scene = granular_scene(rng, dimension)
            gp.Simulation(scene, gp.EventDriven(), seed)
        except gp.SceneError:
            continue
        runs += 1
        try:
            wrong = faults(scene, seed)
        except gp.SimulationError as error:
            wrong = [str(error)]
        if wrong:
            found[seed] = wrong
    assert runs > 0.5 * len(seeds)
    return found


@pytest.mark.parametrize("seed", [146, 275])
def test_contacts_with_walls_do_not_repeat_for_ever(seed):
    """A slow disc in an acute wedge, and one that an inelastic contact has left moving along a wall."""
    assert faults(granular_scene(np.random.default_rng(seed)), seed) == []


@pytest.mark.thorough
@pytest.mark.parametrize("first", range(0, 2000, 100))
def test_two_thousand_random_granular_scenes(first):
    assert all_faults(range(first, first + 80)) == {}
    assert all_faults(range(first + 80, first + 100), dimension=3) == {}


def test_a_row_that_is_pressed_along_a_floor_does_not_meet_ever_more_often():
    """Six discs at rest on a floor, which gravity presses slightly against a wall, and one that bounces off
    the row. They had 3e5 collisions before the time 0.125, ever slower ones in ever smaller gaps."""
    row = [gp.Particle((0.5 + n * (1.0 + 1e-13), 0.5), (0.0, 0.0), 0.5) for n in range(6)]
    row.append(gp.Particle((8.0, 0.5), (-1.0, 0.0), 0.5))
    law = gp.Restitution(0.95, contact_duration=0.0036)
    scene = gp.Scene(gp.Container((12.0, 5.0)), particles=row, gravity=(-0.1, -5.0), restitution=law)
    sim = gp.Simulation(scene, gp.EventDriven())
    energy = sim.state.energy
    sim.advance(until=10.0, max_events=300_000)
    assert sim.time == 10.0
    assert sim.state.energy + sim.tally.dissipated_energy == pytest.approx(energy, rel=1e-9)
    assert sim.state.energy < energy


def test_a_stack_stays_at_rest_on_an_interior_wall():
    """Ten discs, each exactly on the one below."""
    particles = [gp.Particle((5.0, math.pi + 0.5 + n), (0.0, 0.0), 0.5) for n in range(10)]
    rest = {"gravity": (0.0, -1.0), "restitution": gp.Restitution(0.8, 0.5, contact_duration=0.1)}
    walls = [gp.Wall((2.0, math.pi), (8.0, math.pi))]
    scene = gp.Scene(gp.Container((10.0, 16.0)), particles=particles, walls=walls, **rest)
    sim = gp.Simulation(scene, gp.EventDriven())
    sim.advance(duration=TIME)
    assert sim.state.positions == pytest.approx(sim.initial_state.positions, abs=1e-5)
    assert not np.any(sim.state.velocities)
