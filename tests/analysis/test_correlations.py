"""Time correlations by Fourier transforms, against the sums over particles and time origins."""

import numpy as np
import pytest

from gaspart.analysis.motion import autocorrelation, correlate, squared_displacement

SHAPES = [(2, 1, 2), (3, 5, 3), (30, 7, 2), (257, 100, 3)]
"""Frames, particles and dimensions, of which the last ones fill more than a block."""


def paths(shape, kind):
    rng = np.random.default_rng(3)
    noise = rng.normal(size=shape)
    return {
        "diffusive": noise.cumsum(axis=0),
        "far from the origin": noise.cumsum(axis=0) + 1e6 * rng.normal(size=shape[1:]),
        "ballistic": noise[:1] * np.arange(float(shape[0]))[:, None, None],
        "at rest": np.broadcast_to(noise[:1], shape),
    }[kind]


def summed(path, lags):
    return np.array(
        [((path[lag:] - path[: len(path) - lag]) ** 2).sum(axis=-1).mean() for lag in range(lags)]
    )


@pytest.mark.parametrize("kind", ["diffusive", "far from the origin", "ballistic", "at rest"])
@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_squared_displacements_are_the_sums_to_ten_digits(shape, kind):
    path = paths(shape, kind)
    expected = summed(path, shape[0])
    assert squared_displacement(path, shape[0]) == pytest.approx(expected, rel=1e-10, abs=1e-20)


def test_short_lags_keep_their_digits_among_long_ways():
    """Particles that hardly move for a while and then fly."""
    path = paths((400, 20, 3), "diffusive") * 1e-4
    path[200:] += 1e3 * paths((200, 20, 3), "ballistic")
    assert squared_displacement(path, 300)[1:] == pytest.approx(summed(path, 300)[1:], rel=1e-10)
    still = path[:200]
    assert squared_displacement(still, 150)[1:] == pytest.approx(summed(still, 150)[1:], rel=1e-10)


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_autocorrelations_are_the_means_of_products(shape):
    values = np.random.default_rng(5).normal(size=shape)
    found = autocorrelation(values, shape[0])
    expected = [np.mean(values[: shape[0] - lag] * values[lag:]) for lag in range(shape[0])]
    assert found == pytest.approx(np.array(expected), abs=1e-13)


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_the_derivative_of_the_msd_is_the_mean_of_its_products(shape):
    r, v = paths(shape, "diffusive"), np.random.default_rng(6).normal(size=shape)
    found = correlate(r, v, 0.5, shape[0])
    for lag in range(shape[0]):
        moved, both = r[lag:] - r[: shape[0] - lag], v[lag:] + v[: shape[0] - lag]
        expected = (moved * both).sum(axis=-1).mean() / (2 * shape[2])
        assert found.running[lag] == pytest.approx(expected, abs=1e-11 * (1.0 + abs(r).max()))
