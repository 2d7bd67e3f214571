"""Made-up fills with known answers."""

from __future__ import annotations

import numpy as np
import pytest

from gaspart import theory
from gaspart.reproduction.figures.fill_failures import (
    Fill,
    approach_exponent,
    failures_by_density,
    saturation,
)


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
