"""Overlapping pairs by a neighbour list: all pairs nearer than a contact and a `skin`, made anew when bodies
may have crossed the skin.

To make it the bodies are sorted into cells, in memory too, so that neighbours lie near each other. Around the
cells lies a layer of ghosts, the images of bodies through periodic faces; so a body's partners fill a few
unbroken stretches of slots, and the search for them needs hardly a branch.
"""

from typing import NamedTuple

import numpy as np

from gaspart.boxes import box_coordinate
from gaspart.engines.step_contacts import distance_squared, examine
from gaspart.engines.step_layout import (
    FASTEST,
    PENDING,
    SPENT,
    STRAYED,
    share,
)
from gaspart.kernel import allocating_kernel, helper, kernel

_BLOCK = 128  # bodies whose candidates are gathered before any is tested
_AHEAD = 3  # candidates taken from each stretch whether it has them or not
_SAFE = 0.99  # of the skin, so that rounding spends none of it


class Cells(NamedTuple):
    """per_side (3,) cells along each axis, without the ghosts' layers; widths (3,); strides (3,) of the index
    with them; start (cells + 1,), the first slot of each; skin, the distance bodies may spend."""

    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    start: np.ndarray
    skin: float


class Sorted(NamedTuple):
    """All ordinary bodies and ghosts in the order of their cells: spots (d, S), cell (S,), -1 for a
    ghost's, and slot (S,)."""

    spots: np.ndarray
    cell: np.ndarray
    slot: np.ndarray


@helper
def cell_of(bodies, cells, slot, dimension):
    """The index of a body's cell."""
    found = 0
    for k in range(dimension):
        c = box_coordinate(bodies.positions[k, slot], cells.widths[k], cells.per_side[k])
        found += (c + 1) * cells.strides[k]
    return found


@kernel
def images_of(bodies, space, cells, slot, cell, images):
    """The cells in which a body has ghosts, and the axes that those are moved along (1 up, 2 down, by two
    bits an axis), into images (26, 2); their number."""
    number = 0
    for k in range(len(space.lengths)):
        if space.periodic[k]:
            c = box_coordinate(bodies.positions[k, slot], cells.widths[k], cells.per_side[k])
            way = 1 if c == 0 else (2 if c == cells.per_side[k] - 1 else 0)
            if way > 0:
                across = cells.per_side[k] * cells.strides[k]
                for n in range(-1, number):
                    images[number, 0] = (cell if n < 0 else images[n, 0]) + (across if way == 1 else -across)
                    images[number, 1] = (0 if n < 0 else images[n, 1]) + (way << (2 * k))
                    number += 1
    return number


@allocating_kernel
def sort_by_cell(bodies, space, cells):
    """Bring the ordinary bodies' slots into the order of their cells, and place the ghosts among them."""
    dimension = len(space.lengths)
    images = np.empty((26, 2), np.int64)
    own = np.empty(bodies.ordinary, np.int32)
    start = cells.start
    start[:] = 0
    for slot in range(bodies.ordinary):
        cell = cell_of(bodies, cells, slot, dimension)
        own[slot] = cell
        start[cell + 1] += 1
        for n in range(images_of(bodies, space, cells, slot, cell, images)):
            start[images[n, 0] + 1] += 1
    for cell in range(len(start) - 1):
        start[cell + 1] += start[cell]
    total = start[-1]
    spots = np.empty((dimension, total), bodies.positions.dtype)
    cell_at = np.empty(total, np.int32)
    old = np.empty(total, np.int32)
    for slot in range(bodies.ordinary):
        cell = own[slot]
        number = images_of(bodies, space, cells, slot, cell, images)
        for n in range(-1, number):
            at = cell if n < 0 else images[n, 0]
            through = 0 if n < 0 else images[n, 1]
            s = start[at]
            start[at] = s + 1
            cell_at[s] = at if n < 0 else -1
            old[s] = slot if n < 0 else -1 - slot
            for k in range(dimension):
                x = bodies.positions[k, slot]
                way = (through >> (2 * k)) & 3
                if way == 1:
                    x += space.lengths[k]
                elif way == 2:
                    x -= space.lengths[k]
                spots[k, s] = x
    for cell in range(len(start) - 1, 0, -1):  # each now lies where the next one begins
        start[cell] = start[cell - 1]
    start[0] = 0
    order = np.empty(bodies.ordinary, np.int32)
    new = own  # no longer needed
    number = 0
    for s in range(total):
        if old[s] >= 0:
            order[number] = old[s]
            new[old[s]] = number
            number += 1
    for s in range(total):
        old[s] = new[old[s]] if old[s] >= 0 else new[-1 - old[s]]
    for k in range(dimension):
        permute(bodies.positions[k], order)
        permute(bodies.velocities[k], order)
        permute(bodies.images[k], order)
    permute(bodies.radii, order)
    permute(bodies.index, order)
    return Sorted(spots, cell_at, old)


@allocating_kernel
def permute(values, order):
    """values[n] becomes values[order[n]]; what lies beyond the order stays."""
    taken = np.empty(len(order), values.dtype)
    for n in range(len(order)):
        taken[n] = values[order[n]]
    values[: len(order)] = taken


@helper
def near(bodies, arranged, s, t, skin):
    """Whether two of the sorted bodies are nearer than a contact and the skin."""
    square = skin - skin
    for k in range(bodies.positions.shape[0]):
        r = arranged.spots[k, t] - arranged.spots[k, s]
        square += r * r
    reach = bodies.radii[arranged.slot[s]] + bodies.radii[arranged.slot[t]] + skin
    return square < reach * reach


@allocating_kernel
def list_pairs(bodies, cells, arranged, part, pairs, done):
    """Write down all pairs of slots nearer than a contact and the skin whose first is of one part of the
    sorted, into pairs[part] (room, 2). done[part] (2,): their number, or -1 if there is not room enough; and
    the number of tests."""
    first, second = pairs[part, :, 0], pairs[part, :, 1]
    dimension = bodies.positions.shape[0]
    low = share(part, len(pairs), len(arranged.slot))
    high = share(part + 1, len(pairs), len(arranged.slot))
    from_ = np.empty(_BLOCK * 5 * _AHEAD + 1, np.int32)
    to = np.empty(_BLOCK * 5 * _AHEAD + 1, np.int32)
    begin = np.empty(5, np.int64)
    end = np.empty(5, np.int64)
    room = len(first)
    last = len(arranged.slot) - 1
    tests = found = 0
    done[part, 0] = -1
    block = low
    while block < high:
        stop = min(block + _BLOCK, high)
        number = 0
        for s in range(block, stop):
            cell = arranged.cell[s]
            if cell < 0:
                continue
            begin[0], end[0] = s + 1, cells.start[cell + 2]
            stretches = 2
            row = cell + cells.strides[1]
            begin[1], end[1] = cells.start[row - 1], cells.start[row + 2]
            if dimension == 3:
                stretches = 5
                for n in range(3):
                    row = cell + cells.strides[2] + (n - 1) * cells.strides[1]
                    begin[2 + n], end[2 + n] = cells.start[row - 1], cells.start[row + 2]
            for n in range(stretches):
                t, after = begin[n], end[n]
                for _ in range(_AHEAD):
                    from_[number] = s
                    to[number] = min(t, last)
                    number += t < after
                    t += 1
                if t < after:
                    if found + after - t > room:
                        return
                    tests += after - t
                    for other in range(t, after):
                        first[found] = arranged.slot[s]
                        second[found] = arranged.slot[other]
                        found += near(bodies, arranged, s, other, cells.skin)
        if found + number > room:
            return
        tests += number
        for n in range(number):
            s, t = from_[n], to[n]
            first[found] = arranged.slot[s]
            second[found] = arranged.slot[t]
            found += near(bodies, arranged, s, t, cells.skin)
        block = stop
    done[part, 0], done[part, 1] = found, tests


@helper
def is_stale(cells, watch, dt):
    """Whether two bodies may have come nearer by more than the skin since the list was made."""
    way = watch.reach[SPENT] + watch.reach[PENDING] * watch.reach[FASTEST] * dt + watch.reach[STRAYED]
    return not way + way < _SAFE * cells.skin


@kernel
def search_pairs(bodies, space, pairs, low, high, dt, parting, found, thread):
    """Write down the pairs (n, 2) of the list, from `low` to `high`, that are to be resolved."""
    for n in range(low, high):
        i, j = pairs[n, 0], pairs[n, 1]
        sigma = bodies.radii[i] + bodies.radii[j]
        if distance_squared(bodies, space, i, j) < sigma * sigma:
            examine(bodies, space, i, j, dt, parting, found, thread)
