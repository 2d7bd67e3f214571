"""Random sequential insertion: the kernel that tries places one after another.

Bodies that stand stay where they are, so a place that is taken once is taken for good. Places are therefore
thrown out a block at a time, by what stands in the boxes that are nearest to each, which by then have been
fetched from memory. The few that are left are tried in turn, and in full.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compilation import inner_helper, kernel
from gaspart.kernels.obstacles.distance import to_wall
from gaspart.kernels.periodic import box_coordinate
from gaspart.kernels.prefetch import fetch

BLOCK = 256  # places tried together
PLACES = 4  # of a box, for bodies that are found in one go
_NEAREST = (0, 1, 2, 4, 3, 5, 6, 7)
"""The eight boxes that meet at the corner which is nearest to a place, the likeliest to hold a body too near
first: a bit for each axis along which it is not the place's own box."""


class Standing(NamedTuple):
    """The bodies that stand, and where they are found.

    positions (N, d); radii (N,); near (boxes, 4, PLACES): coordinates along three axes and radii of the first
    few bodies of each box, infinite where there is none; filled (boxes,), how many of these places are; head
    (boxes,), following (N,): a list of any others.
    """

    positions: np.ndarray
    radii: np.ndarray
    near: np.ndarray
    filled: np.ndarray
    head: np.ndarray
    following: np.ndarray


class Space(NamedTuple):
    """The boxes (see `Boxes`), and the periods (d,) of the container, beyond reach on an axis without one."""

    periods: tuple[float, ...]
    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray


class Block(NamedTuple):
    """Room for places that are tried together.

    places (BLOCK, 3); at (BLOCK, 3), the coordinates of their boxes; own and beside (BLOCK, 3), what the box,
    and its neighbour on the nearer side, adds to the index along each axis; left (BLOCK,), which may be free;
    box (BLOCK,), where each of these is compared next.
    """

    places: np.ndarray
    at: np.ndarray
    own: np.ndarray
    beside: np.ndarray
    left: np.ndarray
    box: np.ndarray


def put(standing, box, body):
    """Let a body stand where `positions` says, which is in this box."""
    place = standing.filled[box]
    if place < PLACES:
        standing.filled[box] += 1
        for k in range(standing.positions.shape[1]):
            standing.near[box, k, place] = standing.positions[body, k]
        standing.near[box, 3, place] = standing.radii[body]
    else:
        standing.following[body] = standing.head[box]
        standing.head[box] = body


_put = inner_helper(put)


@inner_helper
def gap_between(x, other, period):
    """How far apart two coordinates are, by the nearest image."""
    gap = abs(x - other)
    return min(gap, period - gap)


@inner_helper
def overlaps(place, radius, other, standing, periods):
    """Whether a body at a place (3,) would overlap another."""
    square = 0.0
    for k in range(len(periods)):
        gap = gap_between(place[k], standing.positions[other, k], periods[k])
        square += gap * gap
    reach = radius + standing.radii[other]
    return square < reach * reach


@inner_helper
def overlaps_near(place, radius, box, standing, periods):
    """The same for any of the first bodies of a box."""
    found = 0
    for n in range(standing.near.shape[2]):  # PLACES, but were that told, no vectors would be made of it
        square = 0.0
        for k in range(len(periods)):
            gap = gap_between(place[k], standing.near[box, k, n], periods[k])
            square += gap * gap
        reach = radius + standing.near[box, 3, n]
        found |= square < reach * reach
    return found != 0


@inner_helper
def fetch_box(standing, box):
    """Let the first bodies of a box be fetched: two cache lines."""
    fetch(standing.near[box], 0)
    fetch(standing.near[box], 2)


@inner_helper
def fetch_around(at, standing, space):
    """The same for all boxes about the one of coordinates at (3,) that hold bodies."""
    for dz in range(3):
        z = space.neighbour[2, at[2], dz]
        for dy in range(3):
            y = space.neighbour[1, at[1], dy]
            for dx in range(3):
                x = space.neighbour[0, at[0], dx]
                if x >= 0 and y >= 0 and z >= 0 and standing.filled[x + y + z]:
                    fetch_box(standing, x + y + z)


@inner_helper
def nearest_box(block, n, which):
    """One of the eight boxes that are nearest to place n."""
    box = 0
    for k in range(3):
        box += block.beside[n, k] if which >> k & 1 else block.own[n, k]
    return box


@inner_helper
def lay_out(draws, used, count, lower, upper, space, block):
    """Turn so many draws into places, and find their boxes."""
    for n in range(count):
        for k in range(len(lower)):
            x = lower[k] + draws[used + n, k] * (upper[k] - lower[k])
            at = box_coordinate(x, space.widths[k], space.per_side[k])
            step = 2 if x > (at + 0.5) * space.widths[k] else 0
            block.places[n, k], block.at[n, k], block.own[n, k] = x, at, at * space.strides[k]
            neighbour = space.neighbour[k, at, step]
            block.beside[n, k] = neighbour if neighbour >= 0 else block.own[n, k]
        block.left[n] = n


@inner_helper
def throw_out(count, radius, standing, space, block):
    """Throw out places that a body of the nearest boxes takes; returns how many are left."""
    left = count
    for which in _NEAREST:
        if which < 1 << len(space.periods):
            for m in range(left):
                block.box[m] = nearest_box(block, block.left[m], which)
                fetch_box(standing, block.box[m])
            still = 0
            for m in range(left):
                n = block.left[m]
                block.left[still] = n
                still += not overlaps_near(block.places[n], radius, block.box[m], standing, space.periods)
            if still > 0.9 * left:  # so thin a gas that a look at each place in full costs less
                return still
            left = still
    return left


@inner_helper
def is_free(place, at, radius, standing, space, walls, beside):
    """Whether no body and no interior wall is too near to a place (3,) in the box of coordinates at (3,)."""
    if walls is not None:
        for m in range(len(walls)):
            x, y, z = to_wall(walls, m, place, space.periods)
            square = x * x + y * y + z * z
            if square < radius * radius:
                return False
    for other in beside:
        if overlaps(place, radius, other, standing, space.periods):
            return False
    for dz in range(3):
        z = space.neighbour[2, at[2], dz]
        for dy in range(3):
            y = space.neighbour[1, at[1], dy]
            for dx in range(3):
                x = space.neighbour[0, at[0], dx]
                if x < 0 or y < 0 or z < 0:
                    continue
                box = x + y + z
                if not standing.filled[box]:
                    continue
                if overlaps_near(place, radius, box, standing, space.periods):
                    return False
                other = standing.head[box] if standing.filled[box] == PLACES else -1
                while other >= 0:
                    if overlaps(place, radius, other, standing, space.periods):
                        return False
                    other = standing.following[other]
    return True


@kernel
def place(
    draws, standing, space, block, body, stop, lower, upper, failures, patience, attempts_at, walls, beside
):
    """Try the `draws` (M, d) in [0, 1) as places for bodies body, body + 1, ... stop - 1, of one radius, in
    that order.

    A place is free if no body already there is nearer than the sum of the radii. lower, upper: (d,) corners
    of the region for the centres. `failures` counts the current body's failed attempts across calls; at
    `patience` the search gives up. attempts_at: (N,) number of failed attempts of each placed body.
    walls: (M,) interior walls to keep clear of (see `obstacles`), or None. beside: (K,)
    bodies that may reach further than the boxes tell.

    Returns (next body to place, failures so far, draws used).
    """
    used = 0
    radius = standing.radii[body]
    while used < len(draws) and body < stop and failures < patience:
        count = min(BLOCK, len(draws) - used)
        lay_out(draws, used, count, lower, upper, space, block)
        left = throw_out(count, radius, standing, space, block)
        for n in block.left[:left]:
            fetch_around(block.at[n], standing, space)
        tried = 0
        for n in block.left[:left]:
            if body == stop or failures + n - tried >= patience:
                break
            if is_free(block.places[n], block.at[n], radius, standing, space, walls, beside):
                box = 0
                for k in range(3):
                    box += block.own[n, k]
                for k in range(len(lower)):
                    standing.positions[body, k] = block.places[n, k]
                _put(standing, box, body)
                attempts_at[body] = failures + n - tried
                failures, tried = 0, n + 1
                body += 1
        if body < stop:
            failures += count - tried
            tried = count
        used += tried
    return body, failures, used
