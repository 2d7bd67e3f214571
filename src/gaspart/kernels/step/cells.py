"""The cells of a neighbour list: rows of them along the first axis, and the bodies in memory in their order.

So the bodies in three cells of a row, one after another, are one stretch of slots. Around the cells lies a
layer of empty ones; behind a periodic face a row of it tells the slots of the row across the container.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compilation import helper, kernel
from gaspart.kernels.step.model import share

ONE = np.uint32(1)  # whole numbers of this type index arrays without a test for negative ones


class Cells(NamedTuple):
    """per_side (3,) cells along each axis, without the layer around them; inverse (3,) of their widths;
    strides (3,) of the index with that layer, which is two cells deep where a row begins; wraps (3,), whether
    the first and the last cell along an axis are neighbours; ends (threads, cells), of which the last row
    tells behind which slot each cell's bodies end; cell, order (N,): room for the sort; skin, the distance
    that bodies may spend; origin (d, N), where the bodies in each slot were when the list was made; listed
    (threads,), how long each thread's list is."""

    per_side: np.ndarray
    inverse: np.ndarray
    strides: np.ndarray
    wraps: np.ndarray
    ends: np.ndarray
    cell: np.ndarray
    order: np.ndarray
    skin: float
    origin: np.ndarray
    listed: np.ndarray


@helper
def coordinate(x, inverse, per_side):
    """Which cell along an axis holds coordinate x; the outermost one for x outside."""
    return min(max(int(x * inverse), 0), per_side - 1)


@kernel
def locate(x, inverse, per_side, stride, cell):
    """Add to the cells (n,) of bodies what their coordinates x (n,) along one axis make."""
    for n in range(len(x)):
        cell[n] += np.uint32((coordinate(x[n], inverse, per_side) + 1) * stride)


@kernel
def find_part(bodies, cells, part):
    """Find the cells of one thread's slots."""
    parts = len(cells.ends)
    low, high = share(part, parts, bodies.ordinary), share(part + 1, parts, bodies.ordinary)
    cell = cells.cell[low:high]
    cell[:] = 1
    for k in range(len(bodies.positions)):
        x = bodies.positions[k, low:high]
        locate(x, cells.inverse[k], cells.per_side[k], cells.strides[k], cell)


@kernel
def count_part(bodies, cells, part):
    """Count into ends[part] how many bodies of one thread's slots are in each cell."""
    parts = len(cells.ends)
    low, high = share(part, parts, bodies.ordinary), share(part + 1, parts, bodies.ordinary)
    number = cells.ends[part]
    number[:] = 0
    for c in cells.cell[low:high]:
        number[c] += ONE


@kernel
def begin_cells(ends):
    """From how many each thread puts into each cell to where it begins."""
    place = np.uint32(0)
    if len(ends) == 1:
        only = ends[0]
        for cell in range(len(only)):
            number = only[cell]
            only[cell] = place
            place += number
        return
    for cell in range(ends.shape[1]):
        for part in range(len(ends)):
            number = ends[part, cell]
            ends[part, cell] = place
            place += number


@kernel
def order_part(bodies, cells, part):
    """Put one thread's slots into the order of their cells."""
    parts = len(cells.ends)
    low, high = share(part, parts, bodies.ordinary), share(part + 1, parts, bodies.ordinary)
    ends, order = cells.ends[part], cells.order
    for slot in range(low, high):
        cell = cells.cell[slot]
        order[ends[cell]] = slot
        ends[cell] += ONE


@kernel
def mirror(cells):
    """Let the rows behind periodic faces tell the slots of those across the container."""
    ends = cells.ends[len(cells.ends) - 1]
    for k in range(1, 3):
        if cells.wraps[k]:
            stride, across = cells.strides[k], cells.strides[k] * cells.per_side[k]
            for low in range(0, len(ends), across + 2 * stride):
                for n in range(low, low + stride):
                    ends[n] = ends[n + across]
                    ends[n + across + stride] = ends[n + stride]


@kernel
def take(values, order, low, high, taken):
    """taken[n] becomes values[order[n]] from `low` to `high`."""
    of, taken = order[low:high], taken[low:high]
    for n in range(len(of)):
        taken[n] = values[of[n]]


@kernel
def copy(taken, low, high, values):
    """values[n] becomes taken[n] from `low` to `high`."""
    values, taken = values[low:high], taken[low:high]
    for n in range(len(taken)):
        values[n] = taken[n]
