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


def test_waves_of_both_signs_along_each_axis_are_conjugate():
    waves = np.array([(3, -2, 5), (-3, 2, -5), (0, 0, 1), (0, 0, -1), (1, 0, 0), (0, 0, 0)])
    frames = random_frames((4.0, 5.0, 6.0), 50)
    found = amplitudes(frames, (4.0, 5.0, 6.0), waves)
    assert np.array_equal(found[:, 0], found[:, 1].conj()) and np.array_equal(found[:, 2], found[:, 3].conj())
    assert np.array_equal(found[:, 5], np.full(2, 50.0 + 0.0j))


def test_a_crystal_scatters_in_its_reciprocal_lattice_alone():
    sites = np.stack(np.meshgrid(*[np.arange(6.0)] * 3), axis=-1).reshape(1, -1, 3) + 0.3
    waves, _ = wave_vectors((6.0,) * 3, 7.0)
    found = factors(sites, (6.0,) * 3, waves)[0]
    bragg = (waves % 6 == 0).all(axis=1)
    assert bragg.sum() == 3 and found[bragg] == pytest.approx(216.0)
    assert found[~bragg].max() < 1e-24


@pytest.mark.parametrize("threads", [2, 3])
def test_the_bits_do_not_depend_on_the_number_of_threads(threads):
    lengths = (4.0, 5.0, 7.0)
    waves, _ = wave_vectors(lengths, 5.0)
    frames = random_frames(lengths, 150, 7)
    one, shared = (amplitudes(frames, lengths, waves, number) for number in (1, threads))
    assert np.array_equal(one, shared)
