"""Open faces under the DSMC engine: balances, and a flow between reservoirs beside the exact one; points
without collisions are in `tests/engines/test_open_faces.py`, for both engines."""

import math
from dataclasses import replace

import numpy as np
import pytest
from battery.disturbed import ROWS
from hypothesis import given, settings
from hypothesis import strategies as st
from referee import check_same, restored
from scenes import opened

import gaspart as gp
from gaspart.errors import SimulationError

pytestmark = pytest.mark.thorough

MIXED = ROWS["dsmc, open faces"].scene
"""Discs between two reservoirs, a vacuum and a thermal face."""


def books(sim, begun):
    """Compare number and energy inside with all that came and went."""
    state, tally = sim.state, sim.tally
    faces = [n for n, _ in sim.scene.faces_of(gp.Open)]
    assert state.count == sim.scene.count + tally.entries.sum() - tally.wall_hits[faces].sum()
    exchanged = np.abs(tally.wall_energy).sum() + begun
    assert state.energy + tally.wall_energy.sum() == pytest.approx(begun, abs=1e-12 * exchanged)
    sim.check_invariants()


@settings(max_examples=settings.default.max_examples // 5)
@given(opened(most=0.1), st.integers(0, 1000))
@pytest.mark.filterwarnings("ignore:gaspart")
def test_random_open_scenes(scene, seed):
    sim, parts = (gp.Simulation(scene, gp.DSMC(), seed) for _ in range(2))
    begun = sim.state.energy
    for end in (5.0, 11.0, 20.0):
        parts.advance(until=end)
        parts = restored(parts)
    sim.advance(until=20.0)
    books(sim, begun)
    check_same(sim, parts)


def between(low, high, length, count=50):
    """A slab of spheres between two reservoirs, with the packing fractions of ideal gases."""
    container = gp.Container((length, 12.0, 12.0), ("wall", "periodic", "periodic"))
    faces = {"x_low": gp.Open(low, 1.0), "x_high": gp.Open(high, 1.0)}
    return gp.Scene(container, [gp.Species(count, 0.5, temperature=1.0)], faces=faces, centres_to_walls=True)


@pytest.mark.parametrize("knudsen", [0.2, 5.0])
def test_a_gas_between_equal_reservoirs_is_theirs(knudsen):
    """A number with the distribution of Poisson, and the pressure n k_B T, whatever the free path."""
    eta = 0.02
    path = 1.0 / (math.sqrt(2.0) * 6.0 * eta)  # 1 / (sqrt(2) n pi sigma^2), n = 6 eta / pi
    scene = between(eta, eta, path / knudsen)
    expected = 6.0 * eta / math.pi * scene.container.volume
    sim = gp.Simulation(scene, gp.DSMC(), seed=2)
    sim.advance(duration=60.0)
    means, pressures, squares = [], [], []
    for _ in range(40):
        sim.reset_tally()
        counts = []
        for _ in range(25):
            sim.advance(duration=10.0)
            counts.append(sim.state.count)
        means.append(np.mean(counts))
        squares.append(np.mean((np.array(counts) - expected) ** 2))
        pressures.append(sim.tally.wall_impulse[:2].sum() / (2.0 * 144.0 * sim.tally.time))
    for values, exact in ((means, expected), (squares, expected), (pressures, 6.0 * eta / math.pi)):
        error = np.std(values, ddof=1) / math.sqrt(len(values))
        assert abs(np.mean(values) - exact) < 3.0 * error
    assert np.std(means, ddof=1) / math.sqrt(len(means)) < 0.02 * expected


def flow(sim, blocks, duration):
    """Net numbers per time that pass a slab from its lower to its upper end, in blocks."""
    rates = []
    for _ in range(blocks):
        sim.reset_tally()
        sim.advance(duration=duration)
        tally = sim.tally
        net = tally.entries[:2] - tally.wall_hits[:2]
        rates.append(0.5 * (net[0] - net[1]) / tally.time)
    return np.array(rates)


def test_a_flow_between_reservoirs_is_that_of_hard_spheres():
    """Over four mean free paths: collisions with the gas that comes the other way take a tenth of the flow;
    the excluded volume, which the engine lacks, is 1.6 % at most."""
    dense, thin = 0.002, 0.0004
    scene = between(dense, thin, 4.0 / (math.sqrt(2.0) * 6.0 * dense), 70)
    rates = []
    for engine in (gp.EventDriven(), gp.DSMC()):
        sim = gp.Simulation(scene, engine, seed=5)
        sim.advance(duration=5000.0)
        rates.append(flow(sim, 40, 2000.0))
    (exact, other), errors = zip(*[(r.mean(), r.std(ddof=1) / math.sqrt(len(r))) for r in rates], strict=True)
    free = 144.0 * (dense - thin) * 6.0 / math.pi / math.sqrt(2.0 * math.pi)
    assert abs(exact - other) < 3.0 * math.hypot(*errors) < 0.04 * free
    assert exact + 3.0 * errors[0] < 0.95 * free


def test_a_gas_that_fills_a_container_gets_the_cells_of_its_density():
    """From one particle to two thousand, with the cells and steps of the full container from the start."""
    scene = between(0.05, 0.05, 150.0, 1)
    sim = gp.Simulation(scene, gp.DSMC(), seed=1)
    full = replace(scene.species[0], count=round(0.05 * 6.0 / math.pi * scene.container.volume))
    cells = sim._dynamics.cells_per_side
    assert cells == gp.DSMC().for_scene(replace(scene, species=[full])).cells_per_side
    sim.advance(duration=3000.0)
    assert sim.state.count == pytest.approx(full.count, abs=5.0 * math.sqrt(full.count))
    assert sim._dynamics.cells_per_side == cells


def test_a_full_container_ends_the_run():
    """Which never happens: the numbers are taken away."""
    sim = gp.Simulation(MIXED, gp.DSMC(), seed=1)
    sim._dynamics._open.present[:] = 1
    with pytest.raises(SimulationError, match=f"no room for more than {MIXED.capacity} particles"):
        sim.advance(duration=1000.0)


def test_reservoirs_that_are_refused():
    """An ideal gas of an activity such as that of a dense fluid would be more particles than fit."""
    scene = replace(MIXED, faces={"x_low": gp.Open(20.0, 1.0)})
    with pytest.raises(gp.SceneError, match='faces.x_low = .open.: .* of which 1... fit.* needs the "event"'):
        gp.Simulation(scene, gp.DSMC())
    gp.Simulation(scene, gp.EventDriven())
