"""The cells of a neighbour list: rows of them along the first axis, and the particles in memory in their
order.

So the particles in three cells of a row, one after another, are one stretch of slots. Around the cells lies a
layer of empty ones; behind a periodic face a row of it holds the slots of the row across the container.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compilation import inner_helper, inner_kernel
from gaspart.kernels.step.model import part_of

ONE = np.uint32(1)  # whole numbers of this type index arrays without a test for negative ones


class Cells(NamedTuple):
    """per_side (3,) cells along each axis, without the layer around them; inverse (3,) of their widths;
    strides (3,) of the index with that layer, which is two cells deep where a row begins; wraps (3,), whether
    the first and the last cell along an axis are neighbours; ends (threads, cells), of which the last row
    holds behind which slot each cell's particles end; cell, order (N,): room for the sort; skin, the distance
    beyond a contact up to which pairs are listed; origin (d, N), where the particle in each slot was when the
    list was made; held (N,), see `shared_contacts`; listed (threads,), how long each thread's list is."""

    per_side: np.ndarray
    inverse: np.ndarray
    strides: np.ndarray
    wraps: np.ndarray
    ends: np.ndarray
    cell: np.ndarray
    order: np.ndarray
    skin: float
    origin: np.ndarray
    held: np.ndarray
    listed: np.ndarray


@inner_helper
def coordinate(x, inverse, per_side):
    """Which cell along an axis holds coordinate x; the outermost one for x outside."""
    return min(max(int(x * inverse), 0), per_side - 1)


@inner_kernel
def locate(x, inverse, per_side, stride, cell):
    """Add to the cells (n,) of particles the term of their coordinates x (n,) along one axis."""
    for n in range(len(x)):
        cell[n] += np.uint32((coordinate(x[n], inverse, per_side) + 1) * stride)


@inner_kernel
def locate_part(particles, part, cells):
    """Find the cells of one thread's slots."""
    low, high = part_of(part, len(cells.ends), particles.ordinary)
    cell = cells.cell[low:high]
    cell[:] = 1
    for k in range(len(particles.positions)):
        x = particles.positions[k, low:high]
        locate(x, cells.inverse[k], cells.per_side[k], cells.strides[k], cell)


@inner_kernel
def count_part(particles, part, cells):
    """Count into ends[part] how many particles of one thread's slots are in each cell."""
    low, high = part_of(part, len(cells.ends), particles.ordinary)
    number = cells.ends[part]
    number[:] = 0
    for c in cells.cell[low:high]:
        number[c] += ONE


@inner_kernel
def total_of_part(ends, part):
    """How many particles one thread's share of the cells holds."""
    low, high = part_of(part, len(ends), ends.shape[1])
    total = np.uint32(0)
    for row in range(len(ends)):
        for number in ends[row, low:high]:
            total += number
    return total


@inner_kernel
def begin_part(ends, part, place):
    """Replace how many slots each thread has in each cell of one thread's share of them by where these
    begin. place: how many lie before."""
    low, high = part_of(part, len(ends), ends.shape[1])
    if len(ends) == 1:
        only = ends[0]
        for cell in range(len(only)):
            number = only[cell]
            only[cell] = place
            place += number
        return
    for cell in range(low, high):
        for row in range(len(ends)):
            number = ends[row, cell]
            ends[row, cell] = place
            place += number


@inner_kernel
def order_part(particles, part, cells):
    """Put one thread's slots into the order of their cells."""
    low, high = part_of(part, len(cells.ends), particles.ordinary)
    ends, order = cells.ends[part], cells.order
    for slot in range(low, high):
        cell = cells.cell[slot]
        order[ends[cell]] = slot
        ends[cell] += ONE


@inner_kernel
def copy_periodic_rows(cells):
    """Give the rows behind periodic faces the slots of those across the container."""
    ends = cells.ends[len(cells.ends) - 1]
    for k in range(1, 3):
        if cells.wraps[k]:
            stride, across = cells.strides[k], cells.strides[k] * cells.per_side[k]
            for low in range(0, len(ends), across + 2 * stride):
                for n in range(low, low + stride):
                    ends[n] = ends[n + across]
                    ends[n + across + stride] = ends[n + stride]


@inner_kernel
def permute(values, order, slots, permuted):
    """permuted[n] becomes values[order[n]] for n from slots[0] to slots[1]."""
    source, permuted = order[slots[0] : slots[1]], permuted[slots[0] : slots[1]]
    for n in range(len(source)):
        permuted[n] = values[source[n]]


@inner_kernel
def copy(permuted, slots, values):
    """values[n] becomes permuted[n] for n from slots[0] to slots[1]."""
    values, permuted = values[slots[0] : slots[1]], permuted[slots[0] : slots[1]]
    for n in range(len(permuted)):
        values[n] = permuted[n]
