"""Gravity between hard walls at fixed energy: averages over its surface, sampled without dynamics."""

import math

import numpy as np
import pytest
from exact.bodies import Case
from exact.sampler import overlaps, potential
from numba import njit

import gaspart as gp

pytestmark = pytest.mark.thorough

GRAVITY, RADIUS, SIDES = 0.6, 0.3, (3.0, 5.0)
STARTS = [(0.5, 0.5, 1.1, 0.3), (1.5, 0.9, -0.7, 0.8), (2.5, 0.5, 0.2, -1.0), (0.7, 2.0, 0.9, 0.1)]
STARTS += [(2.0, 2.4, -1.2, 0.5), (1.2, 3.6, 0.4, -0.6)]
SCENE = {
    "container": {"lengths": list(SIDES)},
    "gravity": [0.0, -GRAVITY],
    "particles": [{"position": [x, y], "velocity": [u, v], "radius": RADIUS} for x, y, u, v in STARTS],
}
BINS, BLOCKS = 10, 20


@njit
def heights(positions, radii, energy, box, sweeps, rng):
    """Return heights (sweeps, N) of configurations with the weight (E - U)^(N d/2 - 1)."""
    n, power = len(positions), len(positions) - 1.0
    found = np.empty((sweeps, n))
    fall = 0.0
    for i in range(n):
        fall += potential(positions[i], radii[i], 1.0, 0, box)
    for sweep in range(sweeps):
        for _ in range(4 * n):
            i = int(n * rng.random())
            x = positions[i] + (2.0 * rng.random(2) - 1.0) * 0.6
            new = potential(x, radii[i], 1.0, 0, box)
            if new == np.inf or overlaps(x, radii[i], positions, radii, i, box):
                continue
            after = fall + new - potential(positions[i], radii[i], 1.0, 0, box)
            if after < energy and rng.random() < ((energy - after) / (energy - fall)) ** power:
                positions[i], fall = x, after
        found[sweep] = positions[:, 1]
    return found


def blocks(values):
    """Return mean and standard error of rows (S, ...), from blocks."""
    means = values[: len(values) // BLOCKS * BLOCKS].reshape(BLOCKS, -1, *values.shape[1:]).mean(axis=1)
    return means.mean(axis=0), means.std(axis=0, ddof=1) / math.sqrt(BLOCKS)


def profile(found):
    """Return the part of the discs in bins of the height, for each configuration (S, BINS)."""
    at = np.minimum((found / SIDES[1] * BINS).astype(int), BINS - 1)
    return (at[..., None] == np.arange(BINS)).mean(axis=1)


@pytest.mark.parametrize("engine", [gp.EventDriven(), gp.TimeStepped(time_step=0.002)], ids=["event", "step"])
def test_discs_fall_at_fixed_energy(engine):
    """The mean height sets the kinetic energy, and the force on the floor is the weight and the ceiling's."""
    places, speeds = np.array(STARTS)[:, :2], np.array(STARTS)[:, 2:]
    energy = 0.5 * (speeds**2).sum() + GRAVITY * places[:, 1].sum()
    box, rng = Case(SCENE | {"particles": [], "species": []}).box, np.random.default_rng(1)
    right = heights(places.copy(), np.full(len(STARTS), RADIUS), energy, box, 30_000, rng)
    sim = gp.Simulation(gp.Scene.from_dict(SCENE), engine, seed=1)
    frames, kinetic = [], []
    for _ in range(8_000):
        sim.advance(duration=1.0)
        frames.append(sim.state.positions[:, 1].copy())
        kinetic.append(sim.state.kinetic_energy)
    count = len(STARTS)
    for measured, expected in (
        (profile(np.array(frames)), profile(right)),
        (np.array(kinetic), energy - GRAVITY * right.sum(axis=1)),
    ):
        (value, error), (known, scatter) = blocks(measured), blocks(expected)
        apart = np.abs(value - known) / np.maximum(np.hypot(error, scatter), 1e-12)
        assert (apart < 4.0).all(), (value, known, apart)
        assert (error < 0.1 * np.maximum(known, 0.1)).all()
    impulse = sim.tally.wall_impulse / sim.tally.time
    assert impulse[2] == pytest.approx(impulse[3] + count * GRAVITY, rel=1e-3)
