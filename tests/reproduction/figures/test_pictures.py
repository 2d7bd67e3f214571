"""Overlaps that are counted, and what is kept of a scene."""

import numpy as np
import pytest

from gaspart.reproduction.figures import pictures

CUBE = np.full(3, 10.0)


@pytest.mark.parametrize(
    ("second", "periodic", "expected"),
    [
        ([2.9, 2.0, 2.0], False, 1),
        ([3.0 - 1e-6, 2.0, 2.0], False, 0),  # rounding
        ([2.0, 2.0, 11.1], True, 1),
    ],
)
def test_overlapping_pairs(second, periodic, expected):
    places = np.array([[2.0, 2.0, 2.0], second, [7.0, 7.0, 7.0]])
    assert pictures.overlapping(places, np.full(3, 0.5), CUBE, (periodic,) * 3) == expected


def test_overlaps_across_a_face_and_with_a_large_particle():
    places = np.array([[0.2, 5.0, 5.0], [9.6, 5.0, 5.0], [5.0, 5.0, 5.0], [5.0, 7.4, 5.0], [5.0, 8.1, 5.0]])
    radii = np.array([0.5, 0.5, 2.0, 0.5, 0.5])
    assert pictures.overlapping(places, radii, CUBE, (False,) * 3) == 2
    assert pictures.overlapping(places, radii, CUBE, (True, False, False)) == 3
