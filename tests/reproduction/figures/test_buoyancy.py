"""Made-up runs of a large disc in a fluid under gravity, with known answers."""

from __future__ import annotations

import numpy as np
import pytest

import gaspart as gp
from gaspart.reproduction.figures import buoyancy
from gaspart.reproduction.figures._columns import Stretch
from gaspart.reproduction.points.point import Point

WIDTH, HEIGHT, STRENGTH, RADIUS, SMALL = 24.0, 60.0, 0.05, 3.0, 0.5


def dilute_fluid(rng, frames, count, large):
    """Frames (T, 1 + count, 2) of an ideal gas at temperature 1 around the large disc's places (T, 2)."""
    positions = np.empty((frames, 1 + count, 2))
    for frame, place in enumerate(large):
        chance = rng.random(4 * count) * -np.expm1(-STRENGTH * HEIGHT)
        points = np.stack([WIDTH * rng.random(4 * count), -np.log1p(-chance) / STRENGTH], axis=-1)
        across = np.abs(points[:, 0] - place[0])
        across = np.minimum(across, WIDTH - across)
        outside = across**2 + (points[:, 1] - place[1]) ** 2 > (RADIUS + SMALL) ** 2
        positions[frame] = [place, *points[outside][:count]]
    return positions


def stretch(positions, displaced):
    """The stretch of such frames at temperature 1, whose fluid bears the weight of so many small discs."""
    frames, particles, _ = positions.shape
    energies = np.ones((frames, particles))
    energies[:, 0] = 0.0
    weight = STRENGTH * (particles - 1)
    return Stretch(positions, energies, weight + 2.0 + displaced * STRENGTH, 2.0, 0.0, 1.0)


SETTINGS = {"bins": 30, "blocks": 8, "clear": 2, "far": 5.0, "near": 3.0, "source_density": 0.2}
SETTINGS |= {"source": ["column_source"]}
COUNT = 30


@pytest.fixture
def points(tmp_path):
    """A point with the disc held fast at height 20 above the small discs' lowest, and one with it free."""
    particle = gp.Particle((12.0, 20.0 + SMALL), (0.0, 0.0), RADIUS, mass=0.5)
    scene = gp.Scene(
        gp.Container((WIDTH, HEIGHT + 2 * SMALL), ("periodic", "wall")),
        [gp.Species(COUNT, SMALL)],
        particles=[particle],
        gravity=(0.0, -STRENGTH),
    )
    scene.to_file(tmp_path / "scene.yaml")
    settings = {"scene": str(tmp_path / "scene.yaml"), "duration": 40.0, "samples": 20, "equilibration": 10.0}
    return [
        Point("column", "one", "simulate", settings | {"scene.particles.0.fixed": fixed}, "results", 1)
        for fixed in (True, False)
    ]


@pytest.fixture
def runs(monkeypatch):
    """Stands in for the trajectories: a list of stretches."""
    made = []
    monkeypatch.setattr(buoyancy, "stretches", lambda point, number: made)
    return made


def test_in_a_dilute_gas_the_radius_that_counts_is_r_more(points, runs):
    rng = np.random.default_rng(1)
    density = COUNT * STRENGTH / -np.expm1(-STRENGTH * HEIGHT) * np.exp(-STRENGTH * 20.0) / WIDTH
    displaced = density * np.pi * (RADIUS + SMALL) ** 2
    place = np.tile([12.0, 20.0], (1500, 1))
    runs += [
        stretch(dilute_fluid(rng, 1500, COUNT, place), displaced * factor)
        for factor in rng.normal(1.0, 0.02, 8)
    ]
    row = buoyancy._measure_fixed(points[0], SETTINGS)
    missing = row["missing"]
    assert row["force"].value == pytest.approx(displaced, rel=0.03)
    assert missing.value == pytest.approx(displaced, abs=4.0 * missing.error + 0.03 * displaced)
    assert missing.error < 0.05 * displaced
    for radius in (row["force_radius"], row["count_radius"]):
        assert radius.value == pytest.approx(1.0, abs=4.0 * radius.error + 0.1)
        assert 0.0 < radius.error < 0.25 and radius.freedom == 7
    assert row["radius_expected"] == pytest.approx(1.0, abs=0.05)
    assert row["packing_fraction"].value == pytest.approx(density * np.pi / 4.0, rel=0.05)


def test_a_free_disc_is_lifted_by_what_it_displaces(points, runs):
    rng = np.random.default_rng(2)
    for _ in range(8):
        # So light a gas carries nothing: the disc's own weight alone counts, M g / T = 0.025.
        chance = rng.random(400)
        low, high = RADIUS - SMALL, HEIGHT - RADIUS + SMALL
        height = low - np.log1p(-chance * -np.expm1(-0.025 * (high - low))) / 0.025
        place = np.stack([WIDTH * rng.random(400), height], axis=-1)
        runs.append(stretch(dilute_fluid(rng, 400, COUNT, place), 0.0))
    row = buoyancy._measure_free(points[1], SETTINGS)
    bare = low + 1.0 / 0.025 - (high - low) / np.expm1(0.025 * (high - low))
    assert row["height"].value == pytest.approx(bare, abs=4.0 * row["height"].error)
    assert row["lowest"] == low and row["mass"] == 0.5
    # Theory knows of the gas, thin as it is: a disc of mass 0.5 displaces 1.4 at the floor, and rises.
    assert row["expected"] > bare + 1.0
    assert row["expected_spread"] == pytest.approx(row["spread"][0], rel=0.1)
