"""The cells of a neighbour list: which bodies lie in each, and which lie near in memory.

Around the cells lies a layer for ghosts, the images of bodies through periodic faces; so the partners of a
body fill a few unbroken stretches of one array.
"""

from typing import NamedTuple

import numpy as np

from gaspart.engines.step_layout import share
from gaspart.kernel import allocating_kernel, helper, kernel

ONE = np.uint32(1)  # whole numbers of this type index arrays without a test for negative ones
_GHOSTS = 7  # at most: through three faces, three edges and a corner


class Cells(NamedTuple):
    """per_side (3,) cells along each axis, without the ghosts' layers; inverse (3,) of their widths; strides
    (3,) of the index with those layers; ends (threads, cells), of which the last row tells behind which
    place each cell's bodies end; skin, the distance that bodies may spend; origin (d, N), where the bodies in
    each slot were when the list was made; listed (threads,), how long each thread's list is."""

    per_side: np.ndarray
    inverse: np.ndarray
    strides: np.ndarray
    ends: np.ndarray
    skin: float
    origin: np.ndarray
    listed: np.ndarray


class Places(NamedTuple):
    """All ordinary bodies and their ghosts, cell by cell: spots (S, 4), where they are (three axes, 0 for one
    that is not there) and, last, their radii; slot (S,). Of a slot: own (N, 4), where it is and, last, minus
    the sum of its radius and the skin; cell (N,), place (N,), and whether it has ghosts (N,)."""

    spots: np.ndarray
    slot: np.ndarray
    own: np.ndarray
    cell: np.ndarray
    place: np.ndarray
    edge: np.ndarray


@helper
def coordinate(x, inverse, per_side):
    """Which cell along an axis holds coordinate x; the outermost one for x outside."""
    return min(max(int(x * inverse), 0), per_side - 1)


@kernel
def locate(x, inverse, per_side, stride, periodic, cell, edge):
    """Add to the cells (n,) of bodies what their coordinates x (n,) along one axis make; tell which have
    ghosts through its faces."""
    for n in range(len(x)):
        c = coordinate(x[n], inverse, per_side)
        cell[n] += np.uint32((c + 1) * stride)
        edge[n] |= periodic & ((c == 0) | (c == per_side - 1))


@helper
def ghosts_of(bodies, space, cells, slot, cell, ghosts):
    """The cells in which a body has ghosts, and the axes that those are moved along (1 up, 2 down, by two
    bits an axis), into ghosts (7, 2); their number."""
    number = 0
    for k in range(len(space.lengths)):
        if space.periodic[k]:
            c = coordinate(bodies.positions[k, slot], cells.inverse[k], cells.per_side[k])
            way = 1 if c == 0 else (2 if c == cells.per_side[k] - 1 else 0)
            if way > 0:
                across = cells.per_side[k] * cells.strides[k]
                for n in range(-1, number):
                    ghosts[number, 0] = (cell if n < 0 else ghosts[n, 0]) + (across if way == 1 else -across)
                    ghosts[number, 1] = (0 if n < 0 else ghosts[n, 1]) + (way << (2 * k))
                    number += 1
    return number


@allocating_kernel
def count_part(bodies, space, cells, cell, edge, part):
    """Find the cells of one thread's slots, and count into ends[part] how many bodies and ghosts are in
    each."""
    parts = len(cells.ends)
    low, high = share(part, parts, bodies.ordinary), share(part + 1, parts, bodies.ordinary)
    cell[low:high] = 0
    edge[low:high] = 0
    for k in range(len(space.lengths)):
        x = bodies.positions[k, low:high]
        per_side, stride = cells.per_side[k], cells.strides[k]
        locate(x, cells.inverse[k], per_side, stride, space.periodic[k], cell[low:high], edge[low:high])
    number = cells.ends[part]
    number[:] = 0
    for c in cell[low:high]:
        number[c] += ONE
    ghosts = np.empty((_GHOSTS, 2), np.int64)
    for slot in range(low, high):
        if edge[slot]:
            for n in range(ghosts_of(bodies, space, cells, slot, np.int64(cell[slot]), ghosts)):
                number[ghosts[n, 0]] += ONE


@kernel
def begin_cells(ends):
    """From how many each thread puts into each cell to where it begins; returns how many there are."""
    place = np.uint32(0)
    if len(ends) == 1:
        only = ends[0]
        for cell in range(len(only)):
            number = only[cell]
            only[cell] = place
            place += number
        return place
    for cell in range(ends.shape[1]):
        for part in range(len(ends)):
            number = ends[part, cell]
            ends[part, cell] = place
            place += number
    return place


@allocating_kernel
def place_part(bodies, space, cells, places, part):
    """Put one thread's slots and their ghosts into their places."""
    parts, dimension = len(cells.ends), len(space.lengths)
    low, high = share(part, parts, bodies.ordinary), share(part + 1, parts, bodies.ordinary)
    ends = cells.ends[part]
    place, cell = places.place[low:high], places.cell[low:high]
    own, edge = places.own[low:high], places.edge[low:high]
    radii = bodies.radii[low:high]
    for n in range(len(place)):
        found = ends[cell[n]]
        ends[cell[n]] = found + ONE
        place[n] = found
        places.slot[found] = low + n
        places.spots[found, 3] = radii[n]
        own[n, 3] = -(radii[n] + cells.skin)
    for k in range(3):
        if k < dimension:
            values = bodies.positions[k, low:high]
            for n in range(len(place)):
                own[n, k] = values[n]
                places.spots[place[n], k] = values[n]
        else:
            for n in range(len(place)):
                own[n, k] = 0.0
                places.spots[place[n], k] = 0.0
    ghosts = np.empty((_GHOSTS, 2), np.int64)
    for n in range(len(place)):
        if edge[n]:
            number = ghosts_of(bodies, space, cells, low + n, np.int64(cell[n]), ghosts)
            for m in range(number):
                found = ends[ghosts[m, 0]]
                ends[ghosts[m, 0]] = found + ONE
                places.slot[found] = low + n
                places.spots[found, 2] = 0.0
                places.spots[found, 3] = radii[n]
                for k in range(dimension):
                    way = (ghosts[m, 1] >> (2 * k)) & 3
                    x = bodies.positions[k, low + n]
                    if way == 1:
                        x += space.lengths[k]
                    elif way == 2:
                        x -= space.lengths[k]
                    places.spots[found, k] = x


@allocating_kernel
def tidy(bodies, places, watch):
    """Bring the ordinary bodies' slots into the order of their cells."""
    order = np.empty(bodies.ordinary + 1, np.uint32)
    number = 0
    for place in range(len(places.slot)):
        slot = places.slot[place]
        order[number] = slot
        number += np.int64(places.place[slot] == place)  # a ghost's is not
    order = order[:number]
    for k in range(len(bodies.positions)):
        permute(bodies.positions[k], order)
        permute(bodies.velocities[k], order)
    permute(bodies.radii, order)
    permute(bodies.index, order)
    permute(watch.met, order)


@allocating_kernel
def permute(values, order):
    """values[n] becomes values[order[n]]; what lies beyond the order stays."""
    taken = np.empty(len(order), values.dtype)
    for n in range(len(order)):
        taken[n] = values[order[n]]
    values[: len(order)] = taken
