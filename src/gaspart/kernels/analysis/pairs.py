"""Distances between pairs of particles in a periodic container, counted in bins.

The container is divided into columns along its last axis, and columns are divided into boxes. Particles are
sorted by box, so all particles of a column between two heights are adjacent in memory. Each particle is
compared with such a range in half of the neighbouring columns. In this way each pair is found exactly once
for each image that can be close enough. Distances are computed for vectors of `WIDTH` particles. Distances
beyond the end of a range are also computed, and overwritten later. Counts are integers, which do not depend
on the order of the pairs.
"""

from math import floor, sqrt

import numpy as np

from gaspart.kernels.compile.policy import allocating_kernel, inner_allocating_kernel, inner_helper

WIDTH = 16
"""Number of particles whose distances are computed at once; it is fixed, so that the compiler uses vector
instructions.
"""
MARGIN = 1.0 + 1e-9
"""Factor of the largest distance, so that rounding at the edge of a box does not hide a pair."""
_ROOM = 4096  # number of bins of pairs that are buffered before counting
_TABLES = 4  # number of tables of counts, so that consecutive additions to one bin do not wait for each other


@inner_allocating_kernel
def sort_by_box(coordinates, lengths, numbers, start, boxes):
    """Sort particles by box, and store the first particle of each box."""
    count = coordinates.shape[1]
    wrapped, ordered = np.empty((3, count)), np.zeros((3, count + WIDTH))
    start[:] = 0
    for n in range(count):
        box = 0
        for k in range(3):
            x = coordinates[k, n] - lengths[k] * floor(coordinates[k, n] / lengths[k])
            if not 0.0 <= x < lengths[k]:  # because of rounding or NaN
                x = 0.0
            wrapped[k, n] = x
            box = box * numbers[k] + min(int(x * (numbers[k] / lengths[k])), numbers[k] - 1)
        boxes[n] = box
        start[box + 1] += 1
    for box in range(len(start) - 1):
        start[box + 1] += start[box]
    following = start[:-1].copy()
    for n in range(count):
        position = following[boxes[n]]
        following[boxes[n]] += 1
        for k in range(3):
            ordered[k, position] = wrapped[k, n]
    return ordered


@inner_helper
def add_to_tables(indices, number, tables):
    """Add 1 to the counts of the first `number` bins in `indices`."""
    for n in range(number):
        tables[n % _TABLES, indices[n]] += 1


@inner_helper
def find_bins(ordered, first, stop, origin, scale, indices):
    """Store the bins of the distances between a position and a range of particles."""
    per_length, most = scale
    x, y, z = origin
    for begin in range(0, stop - first, WIDTH):
        for n in range(begin, begin + WIDTH):
            u, v, w = ordered[0, first + n] - x, ordered[1, first + n] - y, ordered[2, first + n] - z
            distance = sqrt(u * u + v * v + w * w) * per_length
            indices[n] = np.int32(distance if distance < most else most)


@inner_helper
def wrap_column(column, number, length):
    """Return a column number wrapped into the container, and the displacement of its image."""
    if column < 0:
        return column + number, -length
    if column >= number:
        return column - number, length
    return column, 0.0


@inner_helper
def gap_to_column(x, column, width):
    """Return the distance between a column and a coordinate; 0 inside the column."""
    return max(column * width - x, x - (column + 1) * width, 0.0)


@inner_helper
def count_of_particle(n, ordered, reach, image, boxes, tables, indices, filled):
    """Find the bins of the pairs of a particle with the particles of a column."""
    first_box, shift_x, shift_y, is_own = image
    length, number, start, scale = boxes
    z = ordered[2, n]
    low, high = floor((z - reach) * number / length), floor((z + reach) * number / length)
    for turn in range(0 if is_own else -1, 2):
        bottom, top = max(low - turn * number, 0), min(high - turn * number, number - 1)
        if bottom > top:
            continue
        first, stop = start[first_box + bottom], start[first_box + top + 1]
        if is_own and turn == 0:
            first = n + 1
        if first < stop:
            if filled + stop - first > len(indices) - WIDTH:
                add_to_tables(indices, filled, tables)
                filled = 0
            origin = ordered[0, n] - shift_x, ordered[1, n] - shift_y, z - turn * length
            find_bins(ordered, first, stop, origin, scale, indices[filled:])
            filled += stop - first
    return filled


@allocating_kernel
def count_pairs(coordinates, lengths, numbers, spans, furthest, counts):
    """Add the pairs closer than `furthest` to counts in equal intervals of the distance."""
    count, bins = coordinates.shape[1], len(counts)
    start = np.empty(numbers[0] * numbers[1] * numbers[2] + 1, np.int32)
    ordered = sort_by_box(coordinates, lengths, numbers, start, np.empty(count, np.int32))
    tables = np.zeros((_TABLES, bins + 1), np.int64)
    indices = np.empty(max(count, _ROOM) + WIDTH, np.int32)
    square, filled, widths = (furthest * MARGIN) ** 2, 0, lengths / numbers
    boxes = lengths[2], numbers[2], start, (bins / furthest, float(bins))
    for x in range(numbers[0]):
        for y in range(numbers[1]):
            own = (x * numbers[1] + y) * numbers[2]
            for dx in range(spans[0] + 1):
                other_x, shift_x = wrap_column(x + dx, numbers[0], lengths[0])
                for dy in range(-spans[1] if dx else 0, spans[1] + 1):
                    other_y, shift_y = wrap_column(y + dy, numbers[1], lengths[1])
                    box = (other_x * numbers[1] + other_y) * numbers[2]
                    image = box, shift_x, shift_y, dx == 0 and dy == 0
                    for n in range(start[own], start[own + numbers[2]]):
                        gap_x = gap_to_column(ordered[0, n], x + dx, widths[0]) if dx else 0.0
                        gap_y = gap_to_column(ordered[1, n], y + dy, widths[1]) if dy else 0.0
                        remaining = square - gap_x * gap_x - gap_y * gap_y
                        if remaining > 0.0:
                            filled = count_of_particle(
                                n, ordered, sqrt(remaining), image, boxes, tables, indices, filled
                            )
    add_to_tables(indices, filled, tables)
    for table in range(_TABLES):
        for n in range(bins):
            counts[n] += tables[table, n]
