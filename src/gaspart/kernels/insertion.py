"""Random sequential insertion: the kernel that tries places one after another.

Particles that are placed stay where they are, so a place that is taken once is taken for good. Trials are
therefore rejected a block at a time, by the particles in the boxes that are nearest to each, which by then
have been fetched from memory. The few that remain are tested in turn, against all particles near them.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, kernel
from gaspart.kernels.obstacles.interior_wall import to_wall
from gaspart.kernels.physics.flight import box_coordinate
from gaspart.kernels.prefetch import fetch

BLOCK = 256  # trials of one block
PLACES = 4  # of a box, for particles that are read in one go
_NEAREST = (0, 1, 2, 4, 3, 5, 6, 7)
"""The eight boxes that meet at the corner which is nearest to a trial, the likeliest to hold a particle too
near first: a bit for each axis along which it is not the trial's own box."""


class Placed(NamedTuple):
    """The particles, of which the first are placed, and where they are found.

    positions (N, d); radii (N,); failures (N,), the failed attempts before each found its place; near (boxes,
    4, PLACES): coordinates along three axes and radii of the first few particles of each box, infinite where
    there is none; filled (boxes,), how many of these there are; head (boxes,), following (N,): a list of any
    others.
    """

    positions: np.ndarray
    radii: np.ndarray
    failures: np.ndarray
    near: np.ndarray
    filled: np.ndarray
    head: np.ndarray
    following: np.ndarray


class PeriodicBoxes(NamedTuple):
    """The boxes (see `state.boxes.Boxes`), and the periods (d,) of the container, beyond reach on an axis
    without one."""

    periods: tuple[float, ...]
    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray


class Block(NamedTuple):
    """Room for the trials of one block.

    places (BLOCK, 3); at (BLOCK, 3), the coordinates of their boxes; own and beside (BLOCK, 3), what the box,
    and its neighbour on the nearer side, adds to the index along each axis; remaining (BLOCK,), the trials
    not rejected; box (BLOCK,), with which each of these is compared next.
    """

    places: np.ndarray
    at: np.ndarray
    own: np.ndarray
    beside: np.ndarray
    remaining: np.ndarray
    box: np.ndarray


class Task(NamedTuple):
    """Which particles to place, those from `first` to `stop` of one radius; the failed attempts of the first
    before, and the `patience`: the number of them at which the search gives up; lower, upper (d,): corners of
    the region for the centres."""

    first: int
    stop: int
    failures: int
    patience: int
    lower: tuple[float, ...]
    upper: tuple[float, ...]


def put(placed, box, i):
    """Enter a particle, which `positions` places there, into a box."""
    place = placed.filled[box]
    if place < PLACES:
        placed.filled[box] += 1
        for k in range(placed.positions.shape[1]):
            placed.near[box, k, place] = placed.positions[i, k]
        placed.near[box, 3, place] = placed.radii[i]
    else:
        placed.following[i] = placed.head[box]
        placed.head[box] = i


_put = inner_helper(put)


@inner_helper
def gap_between(x, other, period):
    """How far apart two coordinates are, by the nearest image."""
    gap = abs(x - other)
    return min(gap, period - gap)


@inner_helper
def overlaps(place, radius, other, placed, periods):
    """Whether a particle at a place (3,) would overlap another."""
    square = 0.0
    for k in range(len(periods)):
        gap = gap_between(place[k], placed.positions[other, k], periods[k])
        square += gap * gap
    reach = radius + placed.radii[other]
    return square < reach * reach


@inner_helper
def overlaps_near(place, radius, box, placed, periods):
    """The same for any of the first particles of a box."""
    found = 0
    for n in range(placed.near.shape[2]):  # PLACES, but with that constant no vectors would be made of it
        square = 0.0
        for k in range(len(periods)):
            gap = gap_between(place[k], placed.near[box, k, n], periods[k])
            square += gap * gap
        reach = radius + placed.near[box, 3, n]
        found |= square < reach * reach
    return found != 0


@inner_helper
def fetch_box(placed, box):
    """Begin to load the first particles of a box: two cache lines."""
    fetch(placed.near[box], 0)
    fetch(placed.near[box], 2)


@inner_helper
def fetch_around(at, placed, boxes):
    """The same for all boxes about the one of coordinates at (3,) that hold particles."""
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
    """One of the eight boxes that are nearest to trial n."""
    box = 0
    for k in range(3):
        box += block.beside[n, k] if which >> k & 1 else block.own[n, k]
    return box


@inner_helper
def draw_trials(draws, boxes, block, task):
    """Turn draws (n, d) into places, and find their boxes."""
    lower, upper = task.lower, task.upper
    for n in range(len(draws)):
        for k in range(len(lower)):
            x = lower[k] + draws[n, k] * (upper[k] - lower[k])
            at = box_coordinate(x, boxes.widths[k], boxes.per_side[k])
            step = 2 if x > (at + 0.5) * boxes.widths[k] else 0
            block.places[n, k], block.at[n, k], block.own[n, k] = x, at, at * boxes.strides[k]
            neighbour = boxes.neighbour[k, at, step]
            block.beside[n, k] = neighbour if neighbour >= 0 else block.own[n, k]
        block.remaining[n] = n


@inner_helper
def reject_overlapping(count, radius, placed, boxes, block):
    """Reject the trials that a particle of the nearest boxes overlaps; returns how many remain."""
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
                kept += not overlaps_near(block.places[n], radius, block.box[m], placed, boxes.periods)
            if kept > 0.9 * number:  # so thin a gas that a complete test of each trial costs less
                return kept
            number = kept
    return number


@inner_helper
def is_clear_of_walls(place, radius, periods, walls):
    """Whether no interior wall is too near to a place (3,)."""
    if walls is not None:
        for m in range(len(walls)):
            x, y, z = to_wall(walls, m, place, periods)
            square = x * x + y * y + z * z
            if square < radius * radius:
                return False
    return True


@inner_helper
def is_free(place, at, radius, placed, boxes, oversized, walls):
    """Whether no particle and no interior wall is too near to a place (3,) in the box of coordinates at
    (3,)."""
    if not is_clear_of_walls(place, radius, boxes.periods, walls):
        return False
    for other in oversized:
        if overlaps(place, radius, other, placed, boxes.periods):
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
                if overlaps_near(place, radius, box, placed, boxes.periods):
                    return False
                other = placed.head[box] if placed.filled[box] == PLACES else -1
                while other >= 0:
                    if overlaps(place, radius, other, placed, boxes.periods):
                        return False
                    other = placed.following[other]
    return True


@inner_helper
def enter(placed, i, block, n):
    """Place a particle where trial n is."""
    box = 0
    for k in range(3):
        box += block.own[n, k]
    for k in range(placed.positions.shape[1]):
        placed.positions[i, k] = block.places[n, k]
    _put(placed, box, i)


@kernel
def place(draws, placed, boxes, block, task, oversized, walls):
    """Try the `draws` (M, d) in [0, 1) as places for the particles of a `Task`, in their order.

    A place is free if no particle already there is nearer than the sum of the radii. oversized (K,): placed
    particles that may reach further than neighbouring boxes; walls (M,): interior walls to keep clear of (see
    `obstacles`), or None.

    Returns (next particle to place, its failed attempts so far, draws used).
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
            if is_free(block.places[n], block.at[n], radius, placed, boxes, oversized, walls):
                enter(placed, i, block, n)
                placed.failures[i] = failures + n - tried
                failures, tried = 0, n + 1
                i += 1
        if i < task.stop:
            failures += count - tried
            tried = count
        used += tried
    return i, failures, used
