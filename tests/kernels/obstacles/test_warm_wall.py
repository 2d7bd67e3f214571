"""Interior walls at a temperature: what leaves them, on both sides and at the ends, and their heat."""

import math
from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp

HOT, COLD = 4.0, 1.0
SIDES = {f"{axis}_{side}": gp.Thermal(COLD) for axis in "xy" for side in ("low", "high")}
SEGMENT = gp.Wall((3.0, 4.0), (7.0, 6.0), temperature=HOT)
DISCS = gp.Scene(
    gp.Container((10.0, 10.0)), [gp.Species(300, 1e-4, temperature=1.5)], faces=SIDES, walls=[SEGMENT]
)
PLATE = gp.Plate((1.0, 2.0, 2.0), ((2.0, 1.0, 0.0), (0.0, 0.0, 2.0)), temperature=HOT)
SPHERES = gp.Scene(
    gp.Container((4.0, 5.0, 6.0)),
    [gp.Species(300, 1e-4, temperature=1.5)],
    faces=SIDES | {"z_low": gp.Thermal(COLD), "z_high": gp.Thermal(COLD)},
    walls=[PLATE],
)
SCENES = {2: DISCS, 3: SPHERES}
NORMALS = {2: np.array([-1.0, 2.0]) / math.sqrt(5.0), 3: np.array([1.0, -2.0, 0.0]) / math.sqrt(5.0)}


def areas(scene):
    """(faces + 1,) of the faces, and of both sides of the wall."""
    lengths = np.array(scene.container.lengths)
    faces = np.repeat([np.delete(lengths, k).prod() for k in range(scene.dimension)], 2)
    return np.append(faces, 2.0 * (math.sqrt(20.0) if scene.dimension == 2 else 2.0 * math.sqrt(5.0)))


@pytest.mark.thorough
@pytest.mark.parametrize("dimension", [2, 3])
def test_heat_from_a_hot_wall_to_cold_faces_in_free_flight(dimension):
    """All surfaces are hit equally often per area, and a hit carries (d + 1) k_B T / 2. No ray leads from one
    side of a flat wall to it: whatever comes was cold, and takes (d + 1) k_B (T_hot - T_cold) / 2."""
    scene = SCENES[dimension]
    simulation = gp.Simulation(scene, gp.EventDriven(), seed=1)
    simulation.advance(duration=40.0)
    hits, heat = [], []
    for _ in range(32):
        simulation.reset_tally()
        simulation.advance(duration=20.0)
        hits.append(simulation.tally.wall_hits)
        heat.append(simulation.tally.wall_energy)
    simulation.check_invariants()
    rates = np.array(hits) / areas(scene)
    mean, error = rates.mean(axis=0), rates.std(axis=0, ddof=1) / math.sqrt(len(hits))
    assert (error < 0.04 * mean).all()
    whole = rates[:, :-1].mean()
    assert mean[-1] == pytest.approx(whole, abs=3.0 * error[-1])
    assert mean[:-1] == pytest.approx(whole, abs=3.5 * error.max())
    taken = -np.array(heat)[:, -1] / np.array(hits)[:, -1]
    each = 0.5 * (dimension + 1) * (HOT - COLD)
    assert taken.std(ddof=1) / math.sqrt(len(taken)) < 0.02 * each
    assert taken.mean() == pytest.approx(each, abs=3.0 * taken.std(ddof=1) / math.sqrt(len(taken)))
    assert np.array(heat).sum() == pytest.approx(0.0, abs=0.02 * np.abs(heat).sum())


@pytest.mark.thorough
@pytest.mark.parametrize("dimension", [2, 3])
def test_velocities_after_a_wall(dimension):
    """On both sides alike: m v_n^2 / T has the mean 2, along the wall 1, without a mean velocity there."""
    simulation = gp.Simulation(SCENES[dimension], gp.EventDriven(), seed=2)
    simulation.record_events = True
    simulation.advance(max_events=40_000)
    events, normal = simulation.events, NORMALS[dimension]
    velocities = events["velocities"][events["particles"][:, 1] == -1 - 2 * dimension, 0]
    across = velocities @ normal
    along = velocities - across[:, None] * normal
    one = across > 0.0
    assert one.mean() == pytest.approx(0.5, abs=3.0 * 0.5 / math.sqrt(len(one)))
    for side in (one, ~one):
        count = side.sum()
        assert count > 1000
        assert (across[side] ** 2).mean() == pytest.approx(2.0 * HOT, abs=3.0 * HOT * math.sqrt(4.0 / count))
        square = (along[side] ** 2).sum(axis=1).mean() / (dimension - 1)
        assert square == pytest.approx(HOT, abs=3.0 * HOT * math.sqrt(2.0 / count / (dimension - 1)))
        assert np.abs(along[side].mean(axis=0)).max() < 3.5 * math.sqrt(HOT / count)
        assert abs((across[side] * along[side, 0]).mean()) < 3.5 * HOT * math.sqrt(2.0 / count)


def test_a_wall_and_a_force_have_a_steady_state():
    """A force along a warm wall, which takes its momentum and its heat."""
    container = gp.Container((6.0, 6.0), "periodic")
    species = [gp.Species(30, 0.2, temperature=1.0)]
    walls = [gp.Wall((0.0, 3.0), (6.0, 3.0), temperature=1.0)]
    scene = gp.Scene(container, species, gravity=(0.1, 0.0), walls=walls)
    assert scene.conserved_axes == (False, False)
    with pytest.raises(gp.SceneError, match="without limit along x"):
        replace(scene, walls=[replace(walls[0], temperature=None)])


@pytest.mark.interpreted
def test_what_is_refused():
    wall = {"start": [1.0, 1.0], "end": [5.0, 5.0], "temperature": 0.0}
    with pytest.raises(gp.SceneError, match=r"walls\[0\].temperature = 0.0: must be positive"):
        gp.Scene.from_dict({"container": {"lengths": [9.0, 9.0]}, "walls": [wall]})
