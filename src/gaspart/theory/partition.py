"""Expected cost of dividing a gas into boxes, and the optimal number of boxes.

The gas is dilute and between walls. A cubic (square) container of side L is divided into n boxes per side.
A particle belongs to the box that contains its centre. Each pair of particles in the same box or in
neighbouring boxes is tested once. Centres are uniform in [r, L - r] and no two centres are closer than a
diameter; otherwise they are independent. For such centres all formulas are exact to first order in the
density, that is for packing fractions below about 0.05.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gaspart.scene.limits import ball_volume
from gaspart.theory.geometry import Numbers, Values, check_ranges, checked_dimension


def _shares(per_side: int, side: float, radius: float) -> np.ndarray:
    """Return the probabilities (n,) that a coordinate, uniform between the walls, is in each box."""
    edges = np.linspace(0.0, side, per_side + 1)
    return np.diff(np.clip(edges, radius, side - radius)) / (side - 2.0 * radius)


def _moments(per_side: int, side: float, radius: float) -> np.ndarray:
    """Return three means along an axis for the neighbourhood of a particle.

    The returned values are the means of the number of boxes, of a probability, and of the square of the
    probability.

    The means are over the position of the particle. The probability is the probability that another particle
    is in the neighbourhood.
    """
    if not (per_side >= 1 and side > 2.0 * radius >= 0.0):
        raise ValueError(
            f"per_side, side, radius: {per_side}, {side}, {radius} (at least one box, room to move)"
        )
    own = _shares(per_side, side, radius)
    near = np.convolve(own, np.ones(3))[1:-1]
    boxes = np.convolve(np.ones(per_side), np.ones(3))[1:-1]
    return np.array([own @ boxes, own @ near, own @ near**2])


@check_ranges
def expected_pair_tests(
    count: float, per_side: int, dimension: int, side: float, radius: float
) -> tuple[float, float]:
    """Compute the expected number of pair tests in a search, and its standard deviation."""
    _, share, square = _moments(per_side, side, radius) ** checked_dimension(dimension)
    excluded = ball_volume(dimension, 2.0 * radius) / (side - 2.0 * radius) ** dimension
    pairs = 0.5 * count * (count - 1.0)
    mean = pairs * (share - excluded) / (1.0 - excluded)
    variance = pairs * (share - share**2) + 2.0 * pairs * max(count - 2.0, 0.0) * (square - share**2)
    return mean, math.sqrt(max(variance, 0.0))


@check_ranges
def neighbour_share(
    per_side: Sequence[int] | np.ndarray, dimension: int, side: float, radius: float
) -> np.ndarray:
    """Compute the probability that two particles are in the same box or in neighbouring boxes."""
    return np.array([_moments(int(n), side, radius)[1] for n in per_side]) ** checked_dimension(dimension)


@check_ranges
def expected_box_visits(per_side: int, dimension: int, side: float, radius: float) -> float:
    """Compute the mean number of boxes that a particle searches."""
    boxes, _, _ = _moments(per_side, side, radius) ** checked_dimension(dimension)
    return 0.5 * (1.0 + boxes)


@check_ranges
def boxes_in_reach(width: Numbers, reach: Numbers, dimension: int) -> Values:
    """Compute the mean number of boxes within a distance of a random point."""
    t = np.asarray(reach) / width
    if checked_dimension(dimension) == 2:
        return 1.0 + 4.0 * t + math.pi * t**2
    return 1.0 + 6.0 * t + 3.0 * math.pi * t**2 + 4.0 / 3.0 * math.pi * t**3


def share_of_contacts_in_a_box(width: Numbers, diameter: Numbers, dimension: int) -> Values:
    """Compute the probability that two particles in contact are in the same box."""
    s = np.asarray(diameter) / width
    if checked_dimension(dimension) == 2:
        return 1.0 - 4.0 * s / math.pi + s**2 / math.pi
    return 1.0 - 1.5 * s + 2.0 * s**2 / math.pi - s**3 / (4.0 * math.pi)


def ideal_boxes_per_particle(test_cost: Numbers, box_cost: Numbers, dimension: int) -> Values:
    """Compute the number of boxes per particle at which a step has the lowest cost."""
    return np.sqrt(0.5 * 3.0 ** checked_dimension(dimension) * np.asarray(test_cost) / box_cost)
