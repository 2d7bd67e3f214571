"""Boltzmann equation on a grid of energies, against its direct simulation and exact values."""

import numpy as np
import pytest

from gaspart import theory
from gaspart.theory.speeds import RELAXATION_UNCERTAINTY, entropy_deficit, equal_speeds

EDGES = np.linspace(0.0, 2.5, 50)


def test_the_grid_agrees_with_the_direct_simulation():
    gas, table = equal_speeds(4.0), theory.relaxation(3)
    s = gas.collisions
    assert gas.shares.sum(axis=1) == pytest.approx(np.ones(len(s)), abs=1e-12)
    assert gas.never_hit == pytest.approx(table.never_hit(s), abs=3.0 * RELAXATION_UNCERTAINTY)
    assert gas.kurtosis == pytest.approx(table.kurtosis(s), abs=3.0 * RELAXATION_UNCERTAINTY)
    assert np.interp(0.1, s, gas.kurtosis) - 1.0 == pytest.approx(0.1 * 8.0 / 35.0, rel=0.03)


def test_entropy_rises_in_each_step_and_starts_at_that_of_one_class():
    deficit = equal_speeds(8.0).deficit(EDGES)
    assert np.diff(deficit).max() < 0.0
    below = theory.maxwell_cdf(EDGES, 3, 1.0 / 3.0)
    first = np.searchsorted(EDGES, 1.0) - 1
    assert deficit[0] == pytest.approx(-np.log(below[first + 1] - below[first]), rel=1e-3)
    assert 0.0 < deficit[-1] < 3e-4


def test_deficit_of_a_small_deviation_is_half_its_mean_square():
    expected, deviation = np.array([0.2, 0.3, 0.5]), np.array([0.01, -0.01, 0.002])
    deviation -= expected @ deviation
    found = entropy_deficit(expected * (1.0 + deviation), expected)
    assert found == pytest.approx(0.5 * expected @ deviation**2, rel=0.02)
    assert entropy_deficit(np.array([0.0, 1.0, 0.0]), expected) == pytest.approx(-np.log(0.3))
