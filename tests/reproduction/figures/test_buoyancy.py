"""A made-up run of a large disc in a fluid under gravity, with known answers."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.reproduction.figures import buoyancy
from gaspart.reproduction.figures._columns import Stretch
from gaspart.reproduction.points.point import Point

WIDTH, HEIGHT, STRENGTH, RADIUS, SMALL = 24.0, 60.0, 0.05, 3.0, 0.5


COUNT, PLACE, FRAMES = 30, np.array([12.0, 20.0]), 1500
SETTINGS = {"bins": 30, "blocks": 8, "clear": 2, "far": 5.0, "near": 3.0}


def stretch(rng, displaced):
    """Frames of an ideal gas at temperature 1 around the large disc, which bears the weight of so many."""
    positions = np.empty((FRAMES, 1 + COUNT, 2))
    for frame in range(FRAMES):
        chance = rng.random(4 * COUNT) * -np.expm1(-STRENGTH * HEIGHT)
        points = np.stack([WIDTH * rng.random(4 * COUNT), -np.log1p(-chance) / STRENGTH], axis=-1)
        across = np.abs(points[:, 0] - PLACE[0])
        across = np.minimum(across, WIDTH - across)
        outside = across**2 + (points[:, 1] - PLACE[1]) ** 2 > (RADIUS + SMALL) ** 2
        positions[frame] = [PLACE, *points[outside][:COUNT]]
    energies = np.ones((FRAMES, 1 + COUNT))
    energies[:, 0] = 0.0
    floor = STRENGTH * COUNT + 2.0 + displaced * STRENGTH
    return Stretch(positions, energies, floor, 2.0, 0.0, 1.0)


def test_in_a_dilute_gas_the_radius_that_counts_is_r_more(tmp_path, monkeypatch):
    scene = gp.Scene(
        gp.Container((WIDTH, HEIGHT + 2 * SMALL), ("periodic", "wall")),
        [gp.Species(COUNT, SMALL)],
        particles=[gp.Particle((12.0, 20.0 + SMALL), (0.0, 0.0), RADIUS, mass=0.5, fixed=True)],
        gravity=(0.0, -STRENGTH),
    )
    scene.to_file(tmp_path / "scene.yaml")
    settings = {"scene": str(tmp_path / "scene.yaml"), "duration": 40.0, "samples": 20, "equilibration": 10.0}
    rng = np.random.default_rng(1)
    density = COUNT * STRENGTH / -np.expm1(-STRENGTH * HEIGHT) * np.exp(-STRENGTH * 20.0) / WIDTH
    displaced = density * np.pi * (RADIUS + SMALL) ** 2
    made = [stretch(rng, displaced * factor) for factor in rng.normal(1.0, 0.02, 8)]
    monkeypatch.setattr(buoyancy, "stretches", lambda point, number: made)
    row = buoyancy._measure_fixed(Point("column", "one", "simulate", settings, "results", 1), SETTINGS)
    missing = row["missing"]
    assert row["force"].value == pytest.approx(displaced, rel=0.03)
    assert missing.value == pytest.approx(displaced, abs=4.0 * missing.error + 0.03 * displaced)
    assert missing.error < 0.05 * displaced
    for radius in (row["force_radius"], row["count_radius"]):
        assert radius.value == pytest.approx(1.0, abs=4.0 * radius.error + 0.1)
        assert 0.0 < radius.error < 0.25 and radius.freedom == 7
    assert row["radius_expected"] == pytest.approx(1.0, abs=0.05)
    assert row["packing_fraction"].value == pytest.approx(density * np.pi / 4.0, rel=0.05)
