"""Expected counts of a partition, against brute force on random points."""

import numpy as np
import pytest

from gaspart.reproduction.figures import box_count as partition


def neighbours(positions, per_side, side):
    """(N, N) whether two particles are in the same box or in neighbouring ones."""
    at = np.floor(positions / side * per_side).astype(int)
    return np.abs(at[:, None] - at[None]).max(axis=-1) <= 1


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("per_side", [1, 2, 3, 7])
def test_counts_of_points(dimension, per_side):
    rng = np.random.default_rng(1)
    side, radius, count = 10.0, 1e-3, 200
    counts, visits = [], []
    for _ in range(60):
        near = neighbours(rng.uniform(radius, side - radius, (count, dimension)), per_side, side)
        counts.append((near.sum() - count) / 2)
    mean, spread = partition.expected_pair_tests(count, per_side, dimension, side, radius)
    assert np.mean(counts) == pytest.approx(mean, abs=4.0 * spread / np.sqrt(60) + 1e-6 * mean)
    if per_side > 2:
        assert np.std(counts, ddof=1) == pytest.approx(spread, rel=0.4)
    places = rng.uniform(radius, side - radius, (20000, dimension))
    at = np.floor(places / side * per_side).astype(int)
    visits = np.prod(np.minimum(at + 1, per_side - 1) - np.maximum(at - 1, 0) + 1, axis=1)
    expected = partition.expected_box_visits(per_side, dimension, side, radius)
    assert (1.0 + visits).mean() / 2.0 == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("reach", [0.2, 0.9])
def test_boxes_in_reach(dimension, reach):
    """Counted for random points of a box, of it and its neighbours."""
    places = np.random.default_rng(2).random((20000, dimension))
    beyond = np.stack([places, 0.0 * places, 1.0 - places], axis=-1) ** 2  # to the box below, in it, above
    squares = beyond[:, 0]
    for k in range(1, dimension):
        squares = (squares[..., None] + beyond[:, k].reshape(20000, *[1] * k, 3)).reshape(
            20000, *[3] * (k + 1)
        )
    within = (squares.reshape(20000, -1) <= reach**2).sum(axis=1)
    error = within.std() / np.sqrt(20000)
    assert within.mean() == pytest.approx(
        partition.boxes_in_reach(2.0, 2.0 * reach, dimension), abs=4.0 * error
    )


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("width", [1.0, 2.5])
def test_share_of_contacts_in_a_box(dimension, width):
    """Counted for pairs in contact in random directions, the first one at random places of a box."""
    rng = np.random.default_rng(3)
    places, directions = rng.random((20000, dimension)) * width, rng.normal(size=(20000, dimension))
    others = places + directions / np.linalg.norm(directions, axis=1, keepdims=True)
    share = ((others >= 0.0) & (others < width)).all(axis=1).mean()
    expected = partition.share_of_contacts_in_a_box(width, 1.0, dimension)
    assert share == pytest.approx(expected, abs=4.0 * np.sqrt(expected / 20000))
