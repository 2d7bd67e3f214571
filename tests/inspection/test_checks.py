"""Each check lets a good run pass and finds what is wrong with a bad one."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart import theory
from gaspart.inspection.checks import judge
from gaspart.inspection.frames import Frames
from gaspart.inspection.readers import read_frames
from gaspart.inspection.statistics import diffusion

RUNS = {"spheres": (3, 0.3), "discs": (2, 0.3), "dense": (3, 0.45)}


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Frames of good runs, by name."""
    folder, engine = tmp_path_factory.mktemp("runs"), gp.EventDriven()
    found = {}
    for name, (dimension, eta) in RUNS.items():
        start = "random" if eta < 0.4 else "lattice"
        scene = gas(dimension, 500, eta, arrangement=start)
        found[name] = read_frames(gp.run(scene, engine, 1, 24.0, 0.2, folder / f"{name}.nc"))
    return found


def verdicts(frames, **settings):
    return {check.name: check.passed for check in judge(frames, **settings)}


@pytest.mark.parametrize("name", RUNS)
def test_a_good_run_passes_every_check_that_can_be_made(runs, name):
    found = verdicts(runs[name])
    assert False not in found.values()
    unmade = {"container"} | ({"diffusion coefficient D"} if name == "discs" else set())
    assert {name for name, passed in found.items() if passed is None} == unmade


def test_wrong_positions(runs):
    good = runs["spheres"]
    rng = np.random.default_rng(1)
    ideal = replace(good, positions=rng.random(good.positions.shape) * good.lengths, counted=None)
    found = verdicts(ideal)
    assert found["overlaps"] is False and found["pressure Z"] is False
    near = np.array(good.positions)
    near[3, 5] = near[3, 6] + [0.0, 0.0, 1.0 - 1e-3]
    assert verdicts(replace(good, positions=near % good.lengths))["overlaps"] is False
    assert verdicts(replace(good, positions=near % good.lengths), tolerance=1.0)["overlaps"] is True


@pytest.mark.parametrize("resolution", [0.3, 1.0, 1e6])
def test_a_coarse_file_does_not_excuse_spheres_at_one_place(runs, resolution):
    good = runs["spheres"]
    near = np.array(good.positions)
    near[3, 5] = near[3, 6]
    found = judge(replace(good, positions=near, resolution=resolution))[0]
    assert found.name == "overlaps" and found.passed is False and "1 of a contact distance" in found.text


def test_particles_behind_walls(runs):
    good = replace(runs["discs"], periodic=(False, False))
    assert verdicts(good)["container"] is True
    out = np.array(good.positions)
    out[-1, 0, 1] = -0.01
    assert verdicts(replace(good, positions=out))["container"] is False


@pytest.mark.parametrize("radius", [1e-4, 0.03, 0.1])
@pytest.mark.parametrize("seed", range(4))
def test_a_gas_whose_particles_hardly_meet_has_no_wrong_pressure(radius, seed):
    """Ideal gas at random: with no pair near contact, or a few, the scatter of the counts is no error."""
    rng = np.random.default_rng(seed)
    lengths, flights = np.full(3, 12.0), rng.normal(size=(100, 3))
    positions = (rng.random((100, 3)) * lengths + 40.0 * np.arange(60)[:, None, None] * flights) % lengths
    frames = Frames(positions, lengths, np.full(100, radius), (True,) * 3)
    (pressure,) = [check for check in judge(frames, tolerance=1.0) if check.name == "pressure Z"]
    assert pressure.passed is not False
    if radius < 0.01:
        assert pressure.text == "pairs near contact are too few in 59 independent samples"


def test_wrong_speeds(runs):
    good = runs["spheres"]
    same = good.velocities / np.linalg.norm(good.velocities, axis=2, keepdims=True)
    found = verdicts(replace(good, velocities=same))
    assert found["speed law"] is False and found["kurtosis of speeds"] is False


def test_wrong_times(runs):
    good = runs["spheres"]
    assert verdicts(replace(good, time=2.0 * good.time))["diffusion coefficient D"] is False


def test_diffusion_of_a_random_walk_is_known():
    rng = np.random.default_rng(3)
    side, sigma = np.full(3, 8.0), 0.1
    walk = np.cumsum(sigma * rng.standard_normal((400, 200, 3)), axis=0)
    frames = Frames(
        (walk - 8.0 * np.floor(walk / 8.0)),
        side,
        np.full(200, 0.5),
        (True,) * 3,
        velocities=rng.standard_normal((400, 200, 3)),
        time=np.arange(400) * 0.1,
    )
    found, _ = diffusion(frames)
    value, error = found.value, found.error
    assert abs(value - 0.5 * sigma**2 / 0.1) < 4.0 * error
    assert error < 0.05 * value
    assert theory.collision_rate(frames.packing_fraction, 3) > 0.5  # or the lags would not fit
