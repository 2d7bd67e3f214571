"""Cells, and sorting of particles in memory by cell.

The sort is a counting sort with threads. Each thread counts the particles of its slots in each cell, and puts
them into the cell after the particles of the preceding threads. So the order within a cell is the order of
the previous slots, for any number of threads.
"""

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.dsmc.model import number_at, number_row, position_row

_ONE = np.uint32(1)  # unsigned indices need no test for negative values


@inner_helper
def coordinate(x, origin, inverse, per_side):
    """Return the index along an axis of the cell that contains x; outside, the outermost cell."""
    return min(max(np.int32((x - origin) * inverse), np.int32(0)), np.int32(per_side - 1))


@inner_kernel
def add_coordinates(x, origin, inverse, per_side, stride, cell):
    """Add the contribution of one axis to the cell numbers (n,) of particles at x (n,)."""
    for n in range(len(x)):
        cell[n] += np.uint32(coordinate(x[n], origin, inverse, per_side) * stride)


@inner_kernel
def locate(particles, first, end, grid):
    """Find the cells of the slots from `first` to `end`."""
    cell = grid.cell[first:end]
    cell[:] = 0
    for k in range(len(grid.per_side)):
        x = particles.data[position_row(particles, k), first:end]
        stride, per_side = np.int32(grid.strides[k]), np.int32(grid.per_side[k])
        add_coordinates(x, grid.origin[k], grid.inverse[k], per_side, stride, cell)


@inner_helper
def leave_out_absent(particles, first, end, grid, present):
    """Remove empty slots, among those from `first` to `end`, from their cells."""
    if present is not None:
        for slot in range(first, end):
            if not present[number_at(particles, slot)]:
                grid.cell[slot] = len(grid.starts) - 1


@inner_kernel
def count(first, end, part, grid):
    """Count the slots of one thread, from `first` to `end`, in each cell."""
    counts = grid.counts[part]
    counts[:] = 0
    for cell in grid.cell[first:end]:
        counts[cell] += _ONE


@inner_kernel
def find_starts(grid):
    """Find the first slot of each cell, and in `counts` of each thread in it. Empty slots count as one
    additional cell, so that the last cell ends before them.
    """
    counts, starts = grid.counts, grid.starts
    offset = np.uint32(0)
    for cell in range(counts.shape[1]):
        starts[cell] = offset
        for part in range(len(counts)):
            number = counts[part, cell]
            counts[part, cell] = offset
            offset += number
    if counts.shape[1] < len(starts):
        starts[counts.shape[1]] = offset


@inner_kernel
def put_in_order(first, end, part, grid):
    """Write one thread's slots, from `first` to `end`, to their new positions in `order`."""
    counts, order = grid.counts[part], grid.order
    for slot in range(first, end):
        cell = grid.cell[slot]
        position = counts[cell]
        counts[cell] = position + _ONE
        order[position] = slot


@inner_kernel
def gather(values, order, permuted):
    """Set permuted[n] to values[order[n]] for all n."""
    for n in range(len(order)):
        permuted[n] = values[order[n]]


@inner_helper
def gather_row(particles, row, first, end, grid):
    """Write a row of positions or velocities in the new order, slots `first` to `end`, to the spare row."""
    rows = particles.rows
    spare = particles.data[rows[len(rows) - 2]]
    gather(particles.data[rows[row]], grid.order[first:end], spare[first:end])


@inner_helper
def gather_numbers(particles, first, end, grid):
    """Write the particles' numbers in the new order to the other row, from `first` to `end`."""
    row = number_row(particles)
    other = particles.numbers[1 - row]
    gather(particles.numbers[row], grid.order[first:end], other[first:end])


@inner_helper
def swap_row(particles, row):
    """Exchange the spare row with a row of positions or velocities."""
    rows = particles.rows
    spare = rows[len(rows) - 2]
    rows[len(rows) - 2] = rows[row]
    rows[row] = spare


@inner_kernel
def share_cells(grid, shares):
    """Divide the cells among threads so that each has about the same number of particles. `shares`: (threads
    + 1,), cells shares[n] to shares[n + 1] belong to thread n.
    """
    parts, cells = len(shares) - 1, len(grid.starts) - 1
    total = np.int64(grid.starts[cells])
    shares[0], shares[parts] = 0, cells
    for part in range(1, parts):
        target = total * part // parts
        low, high = shares[part - 1], cells
        while low < high:
            middle = (low + high) // 2
            if grid.starts[middle] < target:
                low = middle + 1
            else:
                high = middle
        shares[part] = low


LEAST_PART = 1.0 / 16.0
"""Smallest part of a cell by which a collision rate is divided, because more trials are needed."""


@inner_helper
def accessible_part(cell, radius, periodic, grid, workspace):
    """Return the part of a cell that the centres of particles of a radius can reach, at least `LEAST_PART`.
    The cells cover what the smallest particles can reach. `periodic`: (d,), True for periodic axes.
    """
    part, gap = 1.0, (radius - workspace.radius[0]) * workspace.margin
    for k in range(len(periodic)):
        if not periodic[k]:
            at, low = np.float64(cell // grid.strides[k] % grid.per_side[k]), gap * grid.inverse[k]
            covered = min(at + 1.0, grid.per_side[k] - low) - max(at, low)
            part *= min(max(covered, LEAST_PART), 1.0)
    return part
