"""Pairs counted by boxes, against the sum over all pairs, and against freud."""

import freud
import numpy as np
import pytest

from gaspart.analysis.pairs import pair_counts, radial_distribution

CONTAINERS = {
    "square": (4.0, 4.0),
    "strip": (40.0, 3.0),
    "column of discs": (3.0, 40.0),
    "cube": (5.0, 5.0, 5.0),
    "slab": (12.0, 3.0, 9.0),
    "needle along x": (90.0, 2.0, 2.0),
    "needle along z": (2.0, 2.5, 90.0),
}
BINS = 40


def summed(frames, lengths, bins, furthest):
    """The counts, by the nearest image of each of all pairs."""
    counts = np.zeros(bins, dtype=int)
    for frame in frames:
        i, j = np.triu_indices(len(frame), 1)
        apart = frame[j] - frame[i]
        apart -= lengths * np.round(apart / lengths)
        distance = np.sqrt((apart**2).sum(axis=1))
        counts += np.histogram(distance[distance < furthest], bins, (0.0, furthest))[0]
    return counts


def random_frames(lengths, count, number=3):
    return np.random.default_rng(count).random((number, count, len(lengths))) * lengths


@pytest.mark.parametrize("name", CONTAINERS)
@pytest.mark.parametrize("count", [2, 3, 40, 500])
def test_the_counts_are_those_of_all_pairs(name, count):
    """At distances from far below the spacing of particles to half of the shortest side."""
    lengths = np.array(CONTAINERS[name])
    frames = random_frames(lengths, count)
    for part in (0.5, 0.499, 0.34, 0.1, 0.01):
        furthest = part * lengths.min()
        expected = summed(frames, lengths, BINS, furthest)
        assert np.array_equal(pair_counts(frames, lengths, BINS, furthest), expected), part
        assert count < 500 or part < 0.1 or expected.sum() > 0


@pytest.mark.parametrize("name", ["square", "slab"])
def test_positions_may_be_on_faces_and_beyond(name):
    """Coordinates 0 and L, and any number of lengths outside, as of continued paths."""
    lengths = np.array(CONTAINERS[name])
    inside = random_frames(lengths, 60)
    inside[:, :10, 0], inside[:, 5:15, 1] = 0.0, 0.0
    outside = inside.copy()
    outside[:, :5, 0] = lengths[0]
    far = 4.0 * np.random.default_rng(1).integers(-9, 9, inside.shape)
    expected = pair_counts(inside, lengths, BINS, 1.4)
    assert expected.sum() > 60
    assert np.array_equal(pair_counts(outside, lengths, BINS, 1.4), expected)
    moved = pair_counts(inside + far * lengths, lengths, BINS, 1.4)
    assert np.abs(moved - expected).sum() <= 2  # a pair at the edge of a bin


def test_pairs_at_one_place_and_in_a_dense_cluster_are_counted():
    frames = np.full((2, 70, 3), 2.5)
    assert pair_counts(frames, (5.0,) * 3, 10, 2.5).tolist() == [2 * 35 * 69] + [0] * 9
    clustered = 2.4 + 0.2 * random_frames(np.ones(3), 300)
    expected = summed(clustered, np.full(3, 5.0), 10, 0.3)
    assert expected.sum() > 0.9 * 3 * 150 * 299
    assert np.array_equal(pair_counts(clustered, (5.0,) * 3, 10, 0.3), expected)


@pytest.mark.parametrize("threads", [2, 3])
def test_the_counts_do_not_depend_on_the_number_of_threads(threads):
    lengths = np.array(CONTAINERS["slab"])
    frames = random_frames(lengths, 200, 7)
    one, shared = (pair_counts(frames, lengths, BINS, 1.4, number) for number in (1, threads))
    assert np.array_equal(one, shared) and one.sum() > 1000


def test_too_large_a_distance_is_an_error():
    with pytest.raises(ValueError, match=r"furthest: 2\.01 \(must be positive, and at most 2\.0\)"):
        pair_counts(np.zeros((1, 5, 2)), (4.0, 5.0), 10, 2.01)


@pytest.mark.parametrize("name", ["square", "strip", "cube", "slab"])
@pytest.mark.parametrize("count", [2, 200])
def test_g_is_that_of_freud(name, count):
    """In single precision: a few pairs are in the next bin."""
    lengths = np.array(CONTAINERS[name])
    frames = random_frames(lengths, count, 10)
    box = freud.box.Box(*lengths, is2D=len(lengths) == 2)
    rdf = freud.density.RDF(bins=12, r_max=1.4, normalization_mode="finite_size")
    for frame in frames:
        points = np.zeros((count, 3), dtype=np.float32)
        points[:, : len(lengths)] = frame - 0.5 * lengths
        rdf.compute((box, box.wrap(points)), reset=False)
    distance, g = radial_distribution(frames, lengths, 12, 1.4)
    assert distance == pytest.approx(rdf.bin_centers)
    counts = pair_counts(frames, lengths, 12, 1.4)
    assert np.abs(rdf.bin_counts - 2 * counts).sum() <= 8  # freud counts each pair twice
    same = rdf.bin_counts == 2 * counts
    assert same.sum() >= 9 and g[same] == pytest.approx(rdf.rdf[same], rel=1e-5, abs=1e-6)


def test_digits_are_not_lost_far_from_the_origin_or_in_long_containers():
    """Pairs 1e-6 of a bin from an edge, in a container 1e6 times as long as their distance."""
    lengths = np.array([1e6, 4.0, 4.0])
    apart = np.array([0.5 - 1e-7, 0.5 + 1e-7])
    start = np.array([3.0, 999_990.0])
    frame = np.zeros((4, 3))
    frame[:2, 0], frame[2:, 0] = start, start + apart
    assert pair_counts(frame[None], lengths, 2, 1.0).tolist() == [1, 1]
