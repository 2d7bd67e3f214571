import numpy as np
import pytest

from gaspart.analysis.series import plateau

VOLUME = np.linspace(1.0, 2.0, 15)


def loop(volume, depth=0.2):
    """A cubic about (1.5, 9): falls, rises by some `depth` between 1.3 and 1.7, falls. Equal areas: at 9."""
    x = (volume - 1.5) / 0.35
    return 9.0 + depth * (x - x**3)


def test_equal_areas_of_a_symmetric_loop_are_at_its_middle():
    value, error, ends = plateau(VOLUME, loop(VOLUME), np.full(15, 0.005))
    assert value == pytest.approx(9.0, abs=0.005)
    assert ends == pytest.approx((1.85, 1.15), abs=0.01)
    assert 0.0005 < error < 0.01


def test_the_error_is_the_scatter_of_repeated_measurements():
    rng = np.random.default_rng(1)
    found = [
        plateau(VOLUME, loop(VOLUME) + 0.02 * rng.standard_normal(15), np.full(15, 0.02)) for _ in range(20)
    ]
    values, errors = (np.array([one[k] for one in found]) for k in (0, 1))
    assert np.nanstd(values) == pytest.approx(np.nanmean(errors), rel=0.5)
    assert np.nanmean(values) == pytest.approx(9.0, abs=0.02)


def test_an_asymmetric_loop_weighs_areas_not_heights():
    pressure = loop(VOLUME) + 0.3 * np.exp(-(((VOLUME - 1.7) / 0.05) ** 2))
    value, _, _ = plateau(VOLUME, pressure, np.full(15, 1e-4))
    assert 9.01 < value < 9.1  # an area of 0.3 x 0.05 x 1.77 over a width of 0.7


def test_without_a_loop_there_is_no_plateau():
    value, error, ends = plateau(VOLUME, 10.0 - VOLUME, np.full(15, 0.001))
    assert np.isnan([value, error, *ends]).all()


def test_order_of_points_does_not_matter():
    back = plateau(VOLUME[::-1], loop(VOLUME[::-1]), np.full(15, 0.005))
    assert back == plateau(VOLUME, loop(VOLUME), np.full(15, 0.005))
