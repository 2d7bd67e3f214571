"""Contacts of packings, and what a packing is refused for."""

import math

import numpy as np
import pytest

from gaspart.errors import SceneError
from gaspart.reproduction.figures.densest_fill import contacts
from gaspart.reproduction.jobs.pack import arguments
from gaspart.reproduction.points.point import Point


def test_contacts_of_a_crystal_are_twelve_and_a_loose_sphere_has_none():
    places, lengths = crystal(4), np.full(3, 4.0)
    radius = math.sqrt(1 / 8)
    assert contacts(places, radius, lengths) == 12.0
    holes = places[1:]
    assert contacts(holes, radius, lengths) == pytest.approx((12 * 243 + 11 * 12) / 255)
    assert contacts(places[::5], radius, lengths) == 0.0


def crystal(cells):
    """Centres (4 cells^3, 3) of a face-centred cubic crystal, with cells of side 1."""
    basis = np.array([[0, 0, 0], [0, 1, 1], [1, 0, 1], [1, 1, 0]]) / 2
    corners = np.stack(np.meshgrid(*[np.arange(cells)] * 3), axis=-1).reshape(-1, 1, 3)
    return (corners + basis).reshape(-1, 3)


def test_attempts_of_insertion_have_no_rate_of_growth():
    with pytest.raises(SceneError, match="growth_rate = 0.1: excludes attempts"):
        arguments(Point("fill", "one", "pack", {"attempts": 9, "growth_rate": 0.1}, "points", 1))
