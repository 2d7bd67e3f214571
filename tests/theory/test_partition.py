"""Expected counts of a partition, against brute force on random points."""

import numpy as np
import pytest

from gaspart.theory import partition


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


def test_one_box_holds_all_pairs():
    assert partition.expected_pair_tests(1000, 1, 3, 50.0, 0.0) == (499500.0, 0.0)
    assert partition.expected_box_visits(1, 3, 50.0, 0.5) == 1.0


def test_wide_reach():
    rng = np.random.default_rng(2)
    width, reach = 1.0, 0.3
    low = np.floor(rng.random((20000, 3)) * width - reach)
    assert partition.boxes_in_reach(width, reach, 3) == pytest.approx(1.6**3)
    assert low.min() == -1.0  # the cube around a point near the face meets the box beyond it


def test_touched_boxes_do_not_suffice():
    """Two overlapping spheres across an edge, neither of which touches the box of the other's centre."""
    radius = 1.0
    one, other = np.array([-1.01, -0.01]), np.array([0.01, 1.01])  # boxes: the quadrants
    assert np.linalg.norm(one - other) < 2.0 * radius
    for centre, sign in ((one, 1.0), (other, -1.0)):
        into = np.maximum(-sign * centre, 0.0)  # from the centre to the nearest point of the other's quadrant
        assert np.linalg.norm(into) > radius


def test_the_ideal_number_is_the_minimum():
    tests, boxes = 3.0, 0.2
    ideal = partition.ideal_boxes_per_body(tests, boxes, 3)
    density = ideal * np.array([0.9, 1.0, 1.1])
    cost = tests * 13.5 / density + boxes * density
    assert cost.argmin() == 1


@pytest.mark.parametrize("call", [(10, 0, 3, 1.0, 0.1), (10, 2, 4, 1.0, 0.1), (10, 2, 3, 1.0, 0.6)])
def test_refuses_what_cannot_be(call):
    with pytest.raises(ValueError):
        partition.expected_pair_tests(*call)
