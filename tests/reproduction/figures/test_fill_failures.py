"""Made-up fills with known answers, and small real ones."""

from __future__ import annotations

import numpy as np
import pytest

from gaspart import theory
from gaspart.reproduction.figures.fill_failures import (
    Fill,
    approach_exponent,
    dilute_failures,
    failures_by_density,
    measure,
    saturation,
)
from gaspart.reproduction.jobs.fill import fill
from gaspart.reproduction.points.point import Point


def fill_to(saturation, amplitude, dimension, particle=1e-4, last_time=5e3, replicas=6, seed=3):
    """Fills whose packing fraction is saturation - amplitude t^(-1/dimension), to a particle, from t = 1 on.

    Each replica's saturation is shifted by a little noise.
    """
    rng = np.random.default_rng(seed)
    ends = saturation + 2e-4 * rng.standard_normal(replicas)
    particles = int((saturation + 0.01) / particle)
    failures = np.full((replicas, particles), -1)
    for row, end in zip(failures, ends, strict=True):
        eta = particle * (np.arange(particles) + 1.0)
        gap = end - eta
        times = np.where(gap > 0.0, (np.maximum(gap, 1e-30) / amplitude) ** -float(dimension), np.inf)
        placed = np.flatnonzero(times <= last_time)
        attempts = np.maximum.accumulate(np.maximum(np.round(times[placed] / particle), placed + 1)).astype(
            int
        )
        row[placed] = np.maximum(np.diff(attempts, prepend=0) - 1, 0)
    return Fill(failures, np.full(replicas, int(last_time / particle)), particle, dimension)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_straight_approach_leads_to_its_end(dimension):
    value, error, slope = saturation(fill_to(0.4, 0.2, dimension), window=10.0)
    assert abs(value - 0.4) < 4.0 * error + 1e-4
    assert 2e-5 < error < 4e-4
    assert slope == pytest.approx(-0.2, rel=0.02)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_exponent_of_the_approach(dimension):
    value, error = approach_exponent(fill_to(theory.RSA_SATURATION[dimension], 0.2, dimension), window=10.0)
    assert value == pytest.approx(1.0 / dimension, abs=4.0 * error + 0.01)


def test_attempts_that_found_no_place_count_where_they_were_made():
    one = Fill(np.array([[0, 3, -1, -1], [1, 1, 5, -1]]), np.array([20, 40]), 0.1, 2)
    failures, successes = one.trials()
    assert failures.tolist() == [[0, 3, 15, 0], [1, 1, 5, 30]]
    assert successes.tolist() == [[1, 1, 0, 0], [1, 1, 1, 0]]
    assert (failures + successes).sum(axis=1).tolist() == [20, 40]


def test_packing_fraction_counts_the_particles_placed_in_time():
    one = Fill(np.array([[0, 3, -1]]), np.array([20]), 0.1, 2)  # placed at attempts 1 and 5
    assert one.packing_fraction(np.array([0.05, 0.1, 0.45, 0.5, 2.0])) == pytest.approx(
        np.array([[0.0, 0.1, 0.1, 0.2, 0.2]])
    )


def test_failures_of_a_geometric_distribution():
    rng = np.random.default_rng(1)
    failures = rng.geometric(0.25, size=(8, 400)) - 1
    one = Fill(failures, failures.sum(axis=1) + 400, 1e-3, 2)
    eta, mean, error = failures_by_density(one, bins=4)
    assert eta == pytest.approx([0.0495, 0.1495, 0.2495, 0.3495])
    assert np.all(np.abs(mean - 3.0) < 4.0 * error)
    assert error == pytest.approx(np.full(4, np.sqrt(12.0 / 800)), rel=0.8)


def test_bins_that_few_replicas_reach_are_left_out():
    one = Fill(np.array([[0] * 10, [0] * 4 + [-1] * 6, [0] * 4 + [-1] * 6]), np.array([10, 50, 50]), 0.01, 2)
    _, mean, _ = failures_by_density(one, bins=5)
    assert np.isfinite(mean[:2]).all() and np.isnan(mean[3:]).all()


def point(tmp_path, name, **settings):
    found = Point(name, "single", "fill", settings, str(tmp_path), 5)
    data = fill(found.scene, settings["attempts"], [found.seed(k) for k in range(found.replicas)])
    (tmp_path / name).mkdir()
    data.write(found.path)
    return found


def test_real_fills(tmp_path):
    periodic = {"radius": 0.5, "boundary": "periodic", "replicas": 4}
    source = {"radius": 1.77, "side": 20, "boundary": "wall", "centres_to_walls": True, "replicas": 4}
    points = [
        point(tmp_path, "discs", dimension=2, count=600, side=27, attempts=300, **periodic),
        point(tmp_path, "source", dimension=3, count=230, attempts=300, **source),
        point(tmp_path, "dilute", dimension=3, count=3000, packing_fraction=0.05, attempts=20, **periodic),
    ]
    settings = {"saturated": ["discs", "source"], "bins": 12, "windows": [10, 3], "dilute": 0.04}
    dataset = measure(points, settings)
    assert dataset["rule"].values.tolist() == ["periodic", "centres_to_walls", "periodic"]
    ends = dataset["saturation"].values[:, 0]
    assert ends[0] == pytest.approx(0.547, abs=0.02) and ends[1] == pytest.approx(0.53, abs=0.04)
    assert np.isnan(ends[2])
    ratio, error = (float(dataset[name][2]) for name in ("dilute_failures", "dilute_failures_error"))
    assert abs(ratio - 1.0) < 4.0 * error
    assert error < 0.05
    assert float(dataset["failures_per_particle"][0, -1]) > 100.0


def test_low_density_failures_are_compared_particle_by_particle():
    expected = theory.failures_per_particle(np.arange(400) * 1e-4, 3)
    rng = np.random.default_rng(2)
    failures = rng.geometric(1.0 / (1.0 + expected), size=(200, 400)) - 1
    ratio, error = dilute_failures(Fill(failures, failures.sum(axis=1) + 400, 1e-4, 3), up_to=0.04)
    assert abs(ratio - 1.0) < 4.0 * error and error < 0.02
