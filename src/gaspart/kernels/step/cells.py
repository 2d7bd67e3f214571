"""The cells of a neighbour list: rows of them along the first axis, and the particles in memory in their
order.

So the particles in three cells of a row, one after another, are one stretch of slots. Around the cells lies a
layer of empty ones; behind a periodic face a row of it holds the slots of the row across the container.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.step.model import part_of

ONE = np.uint32(1)  # whole numbers of this type index arrays without a test for negative ones


class Cells(NamedTuple):
    """per_side (3,) cells along each axis, without the layer around them; inverse (3,) of their widths;
    strides (3,) of the index with that layer, which is two cells deep where a row begins; wraps (3,), whether
    the first and the last cell along an axis are neighbours; ends (cells,), behind which slot each cell's
    particles end; cell (N,), in which cell the particle in each slot was when the list was made; order (N,):
    room for the sort; skin, the distance beyond a contact up to which pairs are listed; origin (d, N), where
    the particle in each slot was when the list was made; held (N,), see `shared_contacts`; listed (threads,),
    how long each thread's list is."""

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
    low, high = part_of(part, len(cells.listed), particles.ordinary)
    cell = cells.cell[low:high]
    cell[:] = 1
    for k in range(len(particles.positions)):
        x = particles.positions[k, low:high]
        locate(x, cells.inverse[k], cells.per_side[k], cells.strides[k], cell)


@inner_kernel
def divide_cells(cells, ordinary, shares):
    """Divide the cells among threads, shares[n] to shares[n + 1] (threads + 1,) each: with about as many
    particles, if these are where they were when they were sorted before."""
    threads = len(cells.listed)
    shares[0], shares[threads] = 0, len(cells.ends)
    for part in range(1, threads):
        first = part_of(part, threads, ordinary)[0]
        shares[part] = max(shares[part - 1], cells.cell[first] if ordinary > 0 else ONE - ONE)


@inner_kernel
def order_part(cells, ordinary, first, end):
    """Put the slots in the cells from `first` to `end`, one thread's share, into the order of these, in each
    cell by number; and find where each cell's slots end then."""
    ends, order, width = cells.ends[first:end], cells.order, np.uint32(end - first)
    ends[:] = 0
    place = ONE - ONE
    for cell in cells.cell[:ordinary]:
        within = np.uint32(cell - first)  # of a cell before the first, a large number
        if within < width:
            ends[within] += ONE
        place += np.uint32(cell < first)
    for within in range(width):
        number = ends[within]
        ends[within] = place
        place += number
    for slot in range(ordinary):
        within = np.uint32(cells.cell[slot] - first)
        if within < width:
            order[ends[within]] = slot
            ends[within] += ONE


@inner_kernel
def copy_periodic_rows(cells):
    """Give the rows behind periodic faces the slots of those across the container."""
    ends = cells.ends
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
