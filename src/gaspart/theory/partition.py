"""What a partition into boxes costs in a dilute gas between walls: expected counts, and the ideal number.

A cubic (square) container of side L is divided into n boxes a side; particles are kept in the box of their
centre, and every pair of particles in the same or in neighbouring boxes is tested once. All formulas are
exact for centres that are uniform in [r, L - r] and independent but for one thing: no two are closer than a
diameter (first order in the density, so for packing fractions below some 0.05).
"""

import math
from collections.abc import Sequence

import numpy as np

from gaspart.scene.geometry import ball_volume
from gaspart.theory._arguments import Numbers, Values, checked, checked_dimension


def _shares(per_side: int, side: float, radius: float) -> np.ndarray:
    """(n,) Chance that a coordinate, uniform between the walls, lies in each of the n boxes."""
    edges = np.linspace(0.0, side, per_side + 1)
    return np.diff(np.clip(edges, radius, side - radius)) / (side - 2.0 * radius)


def _moments(per_side: int, side: float, radius: float) -> np.ndarray:
    """Along one axis: mean over a particle's place of (boxes in its neighbourhood, its share, its share
    squared).

    The share of a neighbourhood is the chance that another particle is in it.
    """
    if not (per_side >= 1 and side > 2.0 * radius >= 0.0):
        raise ValueError(
            f"per_side, side, radius: {per_side}, {side}, {radius} (at least one box, room to move)"
        )
    own = _shares(per_side, side, radius)
    near = np.convolve(own, np.ones(3))[1:-1]
    boxes = np.convolve(np.ones(per_side), np.ones(3))[1:-1]
    return np.array([own @ boxes, own @ near, own @ near**2])


@checked
def expected_pair_tests(
    count: float, per_side: int, dimension: int, side: float, radius: float
) -> tuple[float, float]:
    """Mean and standard deviation (over random places of the particles) of the pairs tested in one search.

    The mean is N(N-1)/2 times the chance that two particles are neighbours, exactly N(N-1)/2 for one box; the
    variance is that of a sum over pairs of independent particles (Hoeffding 1948; exact for points).
    """
    _, share, square = _moments(per_side, side, radius) ** checked_dimension(dimension)
    excluded = ball_volume(dimension, 2.0 * radius) / (side - 2.0 * radius) ** dimension
    pairs = 0.5 * count * (count - 1.0)
    mean = pairs * (share - excluded) / (1.0 - excluded)
    variance = pairs * (share - share**2) + 2.0 * pairs * max(count - 2.0, 0.0) * (square - share**2)
    return mean, math.sqrt(max(variance, 0.0))


@checked
def neighbour_share(
    per_side: Sequence[int] | np.ndarray, dimension: int, side: float, radius: float
) -> np.ndarray:
    """(n,) Chance that two particles lie in the same box or in neighbouring ones, for `per_side` (n,)."""
    return np.array([_moments(int(n), side, radius)[1] for n in per_side]) ** checked_dimension(dimension)


@checked
def expected_box_visits(per_side: int, dimension: int, side: float, radius: float) -> float:
    """Mean number of boxes that one particle looks into: its own, and half of the others around it."""
    boxes, _, _ = _moments(per_side, side, radius) ** checked_dimension(dimension)
    return 0.5 * (1.0 + boxes)


@checked
def boxes_in_reach(width: Numbers, reach: Numbers, dimension: int) -> Values:
    """Mean number of boxes of side `width` that lie within `reach` of a random point, its own box included.

    The volume within `reach` of a box, over that of the box (Steiner's formula).
    """
    t = np.asarray(reach) / width
    if checked_dimension(dimension) == 2:
        return 1.0 + 4.0 * t + math.pi * t**2
    return 1.0 + 6.0 * t + 3.0 * math.pi * t**2 + 4.0 / 3.0 * math.pi * t**3


def share_of_contacts_in_a_box(width: Numbers, diameter: Numbers, dimension: int) -> Values:
    """Chance that two particles in contact lie in the same box of side `width`, at least a diameter.

    The mean over the directions n of the contact of prod(1 - |n_k| diameter / width): with a place that is
    uniform in the box.
    """
    s = np.asarray(diameter) / width
    if checked_dimension(dimension) == 2:
        return 1.0 - 4.0 * s / math.pi + s**2 / math.pi
    return 1.0 - 1.5 * s + 2.0 * s**2 / math.pi - s**3 / (4.0 * math.pi)


def ideal_boxes_per_particle(test_cost: Numbers, box_cost: Numbers, dimension: int) -> Values:
    """Boxes per particle at which a step costs least, if a pair test and a box cost what is given (same
    unit).

    With M boxes and N particles, away from the walls, there are 3^d N / (2 M) tests per particle, while every
    box must be emptied in every step. The sum of both is least at M / N = sqrt(3^d c_test / (2 c_box)).
    """
    return np.sqrt(0.5 * 3.0 ** checked_dimension(dimension) * np.asarray(test_cost) / box_cost)
