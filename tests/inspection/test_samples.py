"""The clock of a trajectory, and how many independent samples it holds."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart.inspection.checks import judge_places
from gaspart.inspection.frames import Frames
from gaspart.inspection.readers import read_frames
from gaspart.inspection.statistics import (
    contact_values,
    count_collisions,
    decorrelated_frames,
    density_modulation,
    first_relaxed_frame,
    independent,
)


@pytest.mark.parametrize("boundary", ["periodic", "wall"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_the_clock_counts_the_collisions_of_a_particle(dimension, boundary, tmp_path):
    scene = gas(dimension, 300, 0.2, boundary)
    file = gp.run(scene, gp.EventDriven(), 1, 5.0, 0.1, tmp_path / "a.nc")
    with gp.open_trajectory(file) as run:
        counted = 2.0 * run["collisions"].values / scene.count
    found = count_collisions(read_frames(file))
    assert 0.7 * counted[-1] < found[-1] <= 1.05 * counted[-1]
    assert (np.diff(found) >= 0.0).all()


def test_nothing_happens_to_particles_in_flight_or_under_a_weak_thermostat():
    rng = np.random.default_rng(1)
    velocities = np.repeat(rng.standard_normal((1, 100, 3)), 20, axis=0)
    still = Frames(np.zeros((20, 100, 3)), np.ones(3), np.ones(100), (True,) * 3, velocities)
    assert count_collisions(still)[-1] == 0.0
    walk = np.cumsum(0.1 * rng.standard_normal(velocities.shape), axis=0)
    assert count_collisions(replace(still, velocities=velocities + walk))[-1] < 1.0


def test_the_number_of_independent_samples():
    assert independent(np.zeros(50), 1.0) == pytest.approx(1.0)
    assert independent(1e3 * np.arange(50.0), 1.0) == pytest.approx(50.0)
    times = np.sort(np.random.default_rng(2).random(40)) * 10.0
    pairs = np.exp(-0.7 * np.abs(times[:, None] - times))
    assert independent(times, 0.7) == pytest.approx(1.0 / pairs.mean())


def test_ways_are_followed_across_faces():
    steps = np.full((30, 5, 2), 0.3)
    steps[:, 0] = -1.2  # the centre of mass stays
    frames = Frames(np.cumsum(steps, axis=0) % 4.0, np.full(2, 4.0), np.ones(5), (True, True))
    way = np.array(list(frames.paths()))
    assert way[-1, 0] == pytest.approx(29 * np.array([-1.2, -1.2]))
    assert frames.spacing == pytest.approx(1.79, abs=0.01)
    assert first_relaxed_frame(frames) == 3  # 0.85 a frame
    assert first_relaxed_frame(frames.parts(slice(3))) is None
    assert decorrelated_frames(way, 2.0) == list(range(0, 30, 3))


def test_a_wave_is_uneven_and_random_places_are_not():
    rng = np.random.default_rng(3)
    for periodic in ((True, True), (False, True)):
        x = rng.random((1, 500, 2))
        frames = Frames(x, np.ones(2), np.full(500, 0.01), periodic)
        assert density_modulation(frames, 0, rng.random(500)) < 12.0
        assert density_modulation(frames, 0, np.where(x[0, :, 0] < 0.5, 1.0, 2.0)) > 100.0
        assert density_modulation(frames, 0, np.ones(500)) == 0.0


@pytest.mark.parametrize("dimension", [2, 3])
def test_contact_values_are_those_of_all_pairs(dimension):
    """Pairs that overlap by rounding count as contacts, deeper ones do not."""
    rng, lengths = np.random.default_rng(1), np.array([6.0, 7.0, 8.0])[:dimension]
    positions = rng.random((2, 150, dimension)) * lengths
    positions[:, 1] = positions[:, 0] + np.eye(dimension)[0] * (1.0 - 1e-7)
    positions[:, 3] = positions[:, 2] + np.eye(dimension)[1] * (1.0 - 1e-4)
    frames = Frames(positions % lengths, lengths, np.full(150, 0.5), (True,) * dimension)
    edges = np.linspace(1.0, 1.3, 16)
    shells = np.diff(edges**dimension) * {2: np.pi, 3: 4.0 / 3.0 * np.pi}[dimension]
    edges[0] -= 1e-5
    means = [
        [((r ** (dimension - 1)) * (r - 1.0) ** k).mean() / (r ** (dimension - 1)).mean() for k in range(5)]
        for r in (np.linspace(low, low + 0.02, 20001) for low in np.linspace(1.0, 1.28, 15))
    ]
    scale = np.sqrt(shells)
    weights = np.linalg.pinv(np.array(means) * scale[:, None])[0] * scale
    for frame, value in zip(frames.positions, contact_values(frames), strict=True):
        gap = frame[:, None] - frame
        gap -= lengths * np.round(gap / lengths)
        distance = np.sqrt((gap**2).sum(axis=2))[~np.eye(150, dtype=bool)]
        counts = np.histogram(distance, edges)[0]
        expected = weights @ (counts / (150 * 150 / lengths.prod() * shells))
        assert value == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("walls", [(), (2,), (0, 1, 2)])
@pytest.mark.parametrize("gap", [-1e-3, -1e-8, 1e-8])
def test_many_particles_have_the_verdict_of_few(gap, walls, monkeypatch):
    """In many frames pairs are counted first, and only overlapping pairs are searched for the deepest."""
    axes = np.stack(np.meshgrid(*[np.arange(5.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    positions = np.repeat(3.0 * axes[None], 3, axis=0)
    positions[1, 1] = positions[1, 0] - [0.0, 0.0, 1.0 + gap]
    positions[2, 7] = positions[2, 8] - [0.0, 0.0, 1.0 + 0.9 * gap]
    positions[:, :, 2] += 2.0 * bool(walls)  # else the pairs touch across the face
    periodic = tuple(k not in walls for k in range(3))
    frames = Frames(positions % 15.0, np.full(3, 15.0), np.full(125, 0.5), periodic)
    verdicts = []
    for many in (0, 10**9):
        monkeypatch.setattr("gaspart.inspection.checks._MANY", many)
        verdicts.append(judge_places(frames)[0])
    assert verdicts[0] == verdicts[1]
    assert bool(verdicts[0].passed) is (gap > -1e-7)


def test_many_particles_of_a_coarse_file_have_a_bound_on_their_overlap(monkeypatch):
    monkeypatch.setattr("gaspart.inspection.checks._MANY", 0)
    positions = np.full((2, 125, 3), np.arange(125.0)[:, None] % 5.0)
    positions[..., 1:] = np.stack([np.arange(125.0) // 5.0 % 5.0, np.arange(125.0) // 25.0], axis=1)
    positions *= 3.0
    positions[1, 1] = positions[1, 0] + [0.9987, 0.0, 0.0]
    frames = Frames(positions, np.full(3, 15.0), np.full(125, 0.5), (True,) * 3, resolution=1e-3)
    assert str(judge_places(frames)[0].text).startswith("the deepest is 0.002 of a contact distance at most")
    (verdict, _) = judge_places(frames, tolerance=0.0012)
    assert verdict.passed is False and "0.0013 of a contact distance, in frame 1" in verdict.text
