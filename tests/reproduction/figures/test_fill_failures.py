"""Made-up fills with known answers."""

import numpy as np
import pytest

from gaspart.reproduction.figures.fill_failures import (
    Fill,
    failures_by_density,
)


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
