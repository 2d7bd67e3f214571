"""Free flights: the rate at a speed against a mean over partners, the distribution against its moments."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from gaspart import theory

GAS = {"packing_fraction": 0.1, "diameter": 2.0, "temperature": 3.0, "mass": 0.5}


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_mean_over_speeds_is_the_collision_rate(dimension):
    def weighted(v):
        pdf = theory.maxwell_pdf(v, dimension, GAS["temperature"], GAS["mass"])
        return pdf * theory.collision_rate_at_speed(v, dimension=dimension, **GAS)

    mean, _ = quad(weighted, 0.0, 40.0, epsabs=1e-12)
    assert mean == pytest.approx(float(theory.collision_rate(dimension=dimension, **GAS)), rel=1e-9)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("speed", [0.0, 0.7, 2.0, 9.0])
def test_the_rate_is_that_of_partners_of_all_velocities(dimension, speed):
    """S sigma^(d-1) rho chi / S' times the mean relative speed, drawn instead of integrated."""
    partners = np.random.default_rng(1).normal(size=(400_000, dimension)) * math.sqrt(3.0 / 0.5)
    partners[:, 0] -= speed
    relative = np.sqrt((partners**2).sum(axis=1))
    section = {2: 2.0 * 2.0, 3: math.pi * 2.0**2}[dimension]  # of a pair: 2 sigma, pi sigma^2
    density = theory.number_density(0.1, dimension, 2.0) * theory.contact_value(0.1, dimension)
    expected, error = section * density * relative.mean(), section * density * relative.std() / 632.0
    assert abs(theory.collision_rate_at_speed(speed, dimension=dimension, **GAS) - expected) < 4.0 * error


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_distribution_of_free_times_has_its_moments(dimension):
    rate = float(theory.collision_rate(dimension=dimension, **GAS))

    def pdf(t):
        return float(theory.free_time_pdf(t, dimension=dimension, **GAS))

    whole, mean, square = (
        quad(lambda t, n=n: t**n * pdf(t), 0.0, 60.0 / rate, limit=200)[0] for n in (0, 1, 2)
    )
    assert whole == pytest.approx(1.0, abs=1e-7)
    assert mean == pytest.approx(1.0 / rate, rel=1e-6)
    assert 1.02 < square / (2.0 * mean**2) < 1.2  # broader than an exponential
    assert pdf(0.0) > rate
    values = theory.free_time_pdf(np.array([[0.0, 1.0], [2.0, 3.0]]), dimension=dimension, **GAS)
    assert values.shape == (2, 2) and values[0, 0] == pytest.approx(pdf(0.0))
