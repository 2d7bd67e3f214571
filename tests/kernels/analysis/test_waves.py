"""Sums over waves, against the definition."""

import numpy as np
import pytest

from gaspart.analysis.structure_factors import amplitudes, factors, shells_of, wave_vectors
from gaspart.kernels.analysis.waves import BLOCK

CONTAINERS = [(5.0, 9.0), (30.0, 2.0), (4.0, 5.0, 7.0), (2.0, 2.0, 30.0)]


def summed(frames, lengths, waves):
    """The amplitudes by the definition, with angles reduced to one turn before they are rounded."""
    turns = frames / lengths
    angles = np.zeros((*frames.shape[:2], len(waves)))
    for axis in range(len(lengths)):
        angles += turns[..., axis, None] * waves[:, axis] % 1.0
    return np.exp(2j * np.pi * angles).sum(axis=1)


def random_frames(lengths, count, number=2):
    return np.random.default_rng(count).random((number, count, len(lengths))) * lengths


@pytest.mark.parametrize("lengths", CONTAINERS)
@pytest.mark.parametrize("count", [1, 2, BLOCK - 1, BLOCK, BLOCK + 1, 300])
def test_the_sums_are_those_of_the_definition(lengths, count):
    waves, _ = wave_vectors(lengths, 6.0)
    frames = random_frames(lengths, count)
    expected = summed(frames, lengths, waves)
    found = amplitudes(frames, lengths, waves)
    assert np.abs(found - expected).max() < 1e-12 * count
    assert factors(frames, lengths, waves) == pytest.approx(abs(expected) ** 2 / count, abs=1e-11 * count)


def test_large_wave_numbers_keep_their_digits():
    lengths = np.array([90.0, 80.0])
    waves, _, _ = shells_of(lengths, 40.0, 30, 6)
    assert np.abs(waves).max() > 500
    frames = random_frames(lengths, 100)
    assert np.abs(amplitudes(frames, lengths, waves) - summed(frames, lengths, waves)).max() < 1e-10


@pytest.mark.parametrize("threads", [2, 3])
def test_the_bits_do_not_depend_on_the_number_of_threads(threads):
    lengths = (4.0, 5.0, 7.0)
    waves, _ = wave_vectors(lengths, 5.0)
    frames = random_frames(lengths, 150, 7)
    one, shared = (amplitudes(frames, lengths, waves, number) for number in (1, threads))
    assert np.array_equal(one, shared)
