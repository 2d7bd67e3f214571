"""Overlapping pairs by the boxes of Frederickx & Meerts (2010): any number of them, down to one.

Each pair is tested once: the rest of the body's own box first, then the neighbouring boxes of higher index.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compilation import helper, kernel
from gaspart.kernels.periodic import box_coordinate
from gaspart.kernels.step.model import BOX_VISITS, PAIR_TESTS
from gaspart.kernels.step.resolve import distance_squared, examine


class Partition(NamedTuple):
    """The grid of boxes (see `boxes.Boxes`); each slot's box coordinates at (N, 3), and the boxes' lists.

    near: leave out neighbouring boxes that are farther from a body's centre than `reach`, a contact."""

    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray
    at: np.ndarray
    head: np.ndarray
    following: np.ndarray
    near: bool
    reach: float


@kernel
def sort_in(bodies, partition):
    """Put all ordinary bodies into the lists of their boxes."""
    partition.head[:] = -1
    for slot in range(bodies.ordinary):
        box = 0
        for k in range(bodies.positions.shape[0]):
            c = box_coordinate(bodies.positions[k, slot], partition.widths[k], partition.per_side[k])
            partition.at[slot, k] = c
            box += c * partition.strides[k]
        partition.following[slot] = partition.head[box]
        partition.head[box] = slot


@helper
def gap_squared(bodies, partition, slot, axis, step):
    """The square of the distance of a body from a box's slab, `step` boxes along an axis (-1, 0, 1)."""
    x = bodies.positions[axis, slot]
    width = partition.widths[axis]
    low = partition.at[slot, axis] * width
    away = x - x
    if step == 1:
        away = max(away, low + width - x)
    elif step == -1:
        away = max(away, x - low)
    return away * away


@kernel
def beyond(bodies, partition, slot, dx, dy, dz):
    """Whether a neighbouring box is too far from a body to hold a partner's centre."""
    square = gap_squared(bodies, partition, slot, 0, dx - 1)
    square += gap_squared(bodies, partition, slot, 1, dy - 1)
    if bodies.positions.shape[0] == 3:
        square += gap_squared(bodies, partition, slot, 2, dz - 1)
    return square > partition.reach * partition.reach


@kernel
def search_all(bodies, space, i, dt, parting, found, thread):
    """Test a body against all before it, a loop without branches for each block of them; the tests."""
    size = bodies.radii[i]
    start = 0
    while start < i:
        stop = min(start + 256, i)
        overlaps = 0
        for j in range(start, stop):
            sigma = size + bodies.radii[j]
            overlaps += distance_squared(bodies, space, i, j) < sigma * sigma
        if overlaps:
            for j in range(start, stop):
                sigma = size + bodies.radii[j]
                if distance_squared(bodies, space, i, j) < sigma * sigma:
                    examine(bodies, space, i, j, dt, parting, found, thread)
        start = stop
    return i


@kernel
def search_boxes(bodies, space, partition, dt, parting, found, counters):
    """Write down all pairs to be resolved of ordinary bodies."""
    if len(partition.head) == 1:
        counters.counts[BOX_VISITS] += bodies.ordinary
        for i in range(bodies.ordinary):
            counters.counts[PAIR_TESTS] += search_all(bodies, space, i, dt, parting, found, 0)
        return
    tests = visits = 0
    for i in range(bodies.ordinary):
        ax, ay, az = partition.at[i, 0], partition.at[i, 1], partition.at[i, 2]
        own = ax * partition.strides[0] + ay * partition.strides[1] + az * partition.strides[2]
        size = bodies.radii[i]
        visits += 1
        j = partition.following[i]
        while j >= 0:
            tests += 1
            sigma = size + bodies.radii[j]
            if distance_squared(bodies, space, i, j) < sigma * sigma:
                examine(bodies, space, i, j, dt, parting, found, 0)
            j = partition.following[j]
        for dz in range(3):
            z = partition.neighbour[2, az, dz]
            if z < 0:
                continue
            for dy in range(3):
                y = partition.neighbour[1, ay, dy]
                if y < 0:
                    continue
                for dx in range(3):
                    x = partition.neighbour[0, ax, dx]
                    if x < 0 or x + y + z <= own:
                        continue
                    if partition.near and beyond(bodies, partition, i, dx, dy, dz):
                        continue
                    visits += 1
                    j = partition.head[x + y + z]
                    while j >= 0:
                        tests += 1
                        sigma = size + bodies.radii[j]
                        if distance_squared(bodies, space, i, j) < sigma * sigma:
                            examine(bodies, space, i, j, dt, parting, found, 0)
                        j = partition.following[j]
    counters.counts[PAIR_TESTS] += tests
    counters.counts[BOX_VISITS] += visits
