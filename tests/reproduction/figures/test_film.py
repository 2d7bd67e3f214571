"""Slits with known answers: insertion, and the period of the pressure."""

import numpy as np
import pytest

from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.figures import film


def slit(rng, density, width, samples, side=6.0):
    """Particles that do not interact, uniform between the walls."""
    sides = np.array([side, side, width])
    count = round(density * side**2 * (width - 1.0))
    positions = rng.random((samples, count, 3)) * (sides - [0.0, 0.0, 1.0]) + [0.0, 0.0, 0.5]
    return film.Slit(positions, sides, np.full(samples, density))


def test_insertion_into_a_dilute_gas_of_points_counts_their_spheres():
    # Each of the 29 points forbids a ball of radius 1, on average 3/16 less of it within 1 of either wall.
    potential = slit(np.random.default_rng(2), 0.1, 9.0, 64).chemical_potential(64_000, 3)
    forbidden = 4.0 / 3.0 * np.pi * (1.0 - 2.0 * (3.0 / 16.0) / 8.0)
    expected = np.log(30 / 288.0) - 29 * np.log(1.0 - forbidden / 288.0)
    assert potential.value == pytest.approx(expected, abs=4.0 * potential.error + 0.005)
    assert potential.error < 0.01


def test_the_period_of_a_damped_cosine_is_its_own():
    widths = np.arange(2.1, 6.0, 0.23)
    excess = 1.2 * np.exp((2.0 - widths) / 1.1) * np.cos(2.0 * np.pi * widths / 0.97)
    found = film._period(widths, Estimate(excess, np.full(widths.size, 0.01)))
    assert found.value == pytest.approx(0.97, abs=1e-6) and 0.0 < found.error < 0.1
    assert np.isnan(film._period(widths[:5], Estimate(excess[:5], np.full(5, 0.01))).value)
