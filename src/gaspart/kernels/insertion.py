"""Random sequential insertion: the kernel that tests positions one after another.

Placed particles do not move, so a position that is occupied once remains occupied. Therefore trials are
rejected in blocks, by the particles in the nearest boxes of each trial; these data have been fetched from
memory in the meantime. The few remaining trials are tested one by one against all particles near them.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, kernel
from gaspart.kernels.obstacles.distance import to_wall
from gaspart.kernels.physics.periodic import box_coordinate
from gaspart.kernels.prefetch import fetch

BLOCK = 256  # number of trials in a block
PLACES = 4  # number of particles of a box that are read at once
_NEAREST = (0, 1, 2, 4, 3, 5, 6, 7)
"""Boxes around the corner nearest to a trial, with a bit for each axis along which a box is not the trial's
own box.

The box that most probably contains an overlapping particle is first.
"""


class Placed(NamedTuple):
    """Particles, of which the first ones are placed, and the boxes that contain them."""

    positions: np.ndarray
    radii: np.ndarray
    failures: np.ndarray
    near: np.ndarray
    filled: np.ndarray
    head: np.ndarray
    following: np.ndarray


class PeriodicBoxes(NamedTuple):
    """Boxes (`state.boxes.Boxes`), and periods (d,), beyond every distance for a nonperiodic axis."""

    periods: tuple[float, ...]
    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray


class Block(NamedTuple):
    """Working arrays for the trials of one block."""

    positions: np.ndarray
    at: np.ndarray
    own: np.ndarray
    beside: np.ndarray
    remaining: np.ndarray
    box: np.ndarray


class Task(NamedTuple):
    """Particles to place, from `first` to `stop`, all of equal radius."""

    first: int
    stop: int
    failures: int
    patience: int
    lower: tuple[float, ...]
    upper: tuple[float, ...]


def put(placed, box, i):
    """Insert a particle with its position into a box."""
    slot = placed.filled[box]
    if slot < PLACES:
        placed.filled[box] += 1
        for k in range(placed.positions.shape[1]):
            placed.near[box, k, slot] = placed.positions[i, k]
        placed.near[box, 3, slot] = placed.radii[i]
    else:
        placed.following[i] = placed.head[box]
        placed.head[box] = i


_put = inner_helper(put)


@inner_helper
def gap_between(x, other, period):
    """Return the distance of two coordinates, by the nearest image."""
    gap = abs(x - other)
    return min(gap, period - gap)


@inner_helper
def overlaps(position, radius, other, placed, periods):
    """Return True if a particle at a position (3,) would overlap another."""
    square = 0.0
    for k in range(len(periods)):
        gap = gap_between(position[k], placed.positions[other, k], periods[k])
        square += gap * gap
    reach = radius + placed.radii[other]
    return square < reach * reach


@inner_helper
def overlaps_near(position, radius, box, placed, periods):
    """Return True if a particle would overlap one of the first particles of a box."""
    overlap = 0
    for n in range(placed.near.shape[2]):  # PLACES; as a constant it would prevent vectorization
        square = 0.0
        for k in range(len(periods)):
            gap = gap_between(position[k], placed.near[box, k, n], periods[k])
            square += gap * gap
        reach = radius + placed.near[box, 3, n]
        overlap |= square < reach * reach
    return overlap != 0


@inner_helper
def fetch_box(placed, box):
    """Prefetch the first particles of a box: two cache lines."""
    fetch(placed.near[box], 0)
    fetch(placed.near[box], 2)


@inner_helper
def fetch_around(at, placed, boxes):
    """Prefetch the first particles of all nonempty boxes around a box. `at`: (3,), coordinates of the box."""
    for dz in range(3):
        z = boxes.neighbour[2, at[2], dz]
        for dy in range(3):
            y = boxes.neighbour[1, at[1], dy]
            for dx in range(3):
                x = boxes.neighbour[0, at[0], dx]
                if x >= 0 and y >= 0 and z >= 0 and placed.filled[x + y + z]:
                    fetch_box(placed, x + y + z)


@inner_helper
def nearest_box(block, n, which):
    """Return one of the eight boxes that are nearest to trial n."""
    box = 0
    for k in range(3):
        box += block.beside[n, k] if which >> k & 1 else block.own[n, k]
    return box


@inner_helper
def draw_trials(draws, boxes, block, task):
    """Convert draws (n, d) to positions, and find their boxes."""
    lower, upper = task.lower, task.upper
    for n in range(len(draws)):
        for k in range(len(lower)):
            x = lower[k] + draws[n, k] * (upper[k] - lower[k])
            at = box_coordinate(x, boxes.widths[k], boxes.per_side[k])
            step = 2 if x > (at + 0.5) * boxes.widths[k] else 0
            block.positions[n, k], block.at[n, k], block.own[n, k] = x, at, at * boxes.strides[k]
            neighbour = boxes.neighbour[k, at, step]
            block.beside[n, k] = neighbour if neighbour >= 0 else block.own[n, k]
        block.remaining[n] = n


@inner_helper
def reject_overlapping(count, radius, placed, boxes, block):
    """Reject the trials that overlap particles of the nearest boxes; return the number that remain."""
    number = count
    for which in _NEAREST:
        if which < 1 << len(boxes.periods):
            for m in range(number):
                block.box[m] = nearest_box(block, block.remaining[m], which)
                fetch_box(placed, block.box[m])
            kept = 0
            for m in range(number):
                n = block.remaining[m]
                block.remaining[kept] = n
                kept += not overlaps_near(block.positions[n], radius, block.box[m], placed, boxes.periods)
            if kept > 0.9 * number:  # in a dilute gas a complete test of each trial costs less
                return kept
            number = kept
    return number


@inner_helper
def is_clear_of_walls(position, radius, periods, walls):
    """Return True if no interior wall is too close to a position (3,)."""
    if walls is not None:
        for m in range(len(walls)):
            x, y, z = to_wall(walls, m, position, periods)
            square = x * x + y * y + z * z
            if square < radius * radius:
                return False
    return True


@inner_helper
def is_free(position, at, radius, placed, boxes, oversized, walls):
    """Return True if no particle and no interior wall is too close to a position (3,). `at`: (3,),
    coordinates of the box of the position.
    """
    if not is_clear_of_walls(position, radius, boxes.periods, walls):
        return False
    for other in oversized:
        if overlaps(position, radius, other, placed, boxes.periods):
            return False
    for dz in range(3):
        z = boxes.neighbour[2, at[2], dz]
        for dy in range(3):
            y = boxes.neighbour[1, at[1], dy]
            for dx in range(3):
                x = boxes.neighbour[0, at[0], dx]
                if x < 0 or y < 0 or z < 0:
                    continue
                box = x + y + z
                if not placed.filled[box]:
                    continue
                if overlaps_near(position, radius, box, placed, boxes.periods):
                    return False
                other = placed.head[box] if placed.filled[box] == PLACES else -1
                while other >= 0:
                    if overlaps(position, radius, other, placed, boxes.periods):
                        return False
                    other = placed.following[other]
    return True


@inner_helper
def enter(placed, i, block, n):
    """Place a particle at the position of trial n."""
    box = 0
    for k in range(3):
        box += block.own[n, k]
    for k in range(placed.positions.shape[1]):
        placed.positions[i, k] = block.positions[n, k]
    _put(placed, box, i)


@kernel
def place(draws, placed, boxes, block, task, oversized, walls):
    """Test the `draws` (M, d) in [0, 1) as positions for the particles of a task. A position is free if no
    placed particle is closer than the sum of the radii. Returns (next particle to place, its failed attempts
    so far, number of draws used). `oversized`: (K,), placed particles that may reach beyond neighbouring
    boxes. `walls`: (M,), interior walls that must not be too close (see `obstacles`), or None.
    """
    used = 0
    i, failures = task.first, task.failures
    radius = placed.radii[i]
    while used < len(draws) and i < task.stop and failures < task.patience:
        count = min(BLOCK, len(draws) - used)
        draw_trials(draws[used : used + count], boxes, block, task)
        number = reject_overlapping(count, radius, placed, boxes, block)
        for n in block.remaining[:number]:
            fetch_around(block.at[n], placed, boxes)
        tried = 0
        for n in block.remaining[:number]:
            if i == task.stop or failures + n - tried >= task.patience:
                break
            if is_free(block.positions[n], block.at[n], radius, placed, boxes, oversized, walls):
                enter(placed, i, block, n)
                placed.failures[i] = failures + n - tried
                failures, tried = 0, n + 1
                i += 1
        if i < task.stop:
            failures += count - tried
            tried = count
        used += tried
    return i, failures, used
