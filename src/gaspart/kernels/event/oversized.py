"""Bodies too big for the boxes of the partition: how they are searched for, and search.

Beside the partition, that is: a small body tests the big ones that are near its box; a big one tests the
bodies in all boxes that are near its own, and all other big ones. Whether two boxes are near, for a big body,
follows from their numbers alone, so it is the same seen from either; and no contact can come between bodies
whose boxes are not. A body that passes into another box looks again at what has become near.
"""

from math import inf, sqrt

from gaspart.kernels.compilation import inner_helper, inner_kernel
from gaspart.kernels.event.box_lists import member
from gaspart.kernels.event.model import BOX_VISITS, NOTHING, PAIR_TESTS
from gaspart.kernels.flight import pair_time

_SLACK = 1e-9  # by which neighbourhoods are drawn wider, lest rounding hide a contact


@inner_helper
def reach_square(rows, body, space, big):
    """Square of the greatest distance between the centre of a big body and of a small one that touches it."""
    reach = (rows[body, 2 * len(space.lengths) + 1] + big.above) * (1.0 + _SLACK)
    return reach * reach


@inner_helper
def gap_square(steps, width):
    """Square of the gap along an axis between boxes that are so many steps apart."""
    gap = max(abs(steps) - 1, 0) * width
    return gap * gap


@inner_helper
def near(x, y, z, widths, square):
    """Whether boxes these steps apart hold points nearer than the root of `square`."""
    return gap_square(x, widths[0]) + gap_square(y, widths[1]) + gap_square(z, widths[2]) < square


@inner_kernel
def laps(axis, space):
    """How many images of the container to look at on either side along an axis."""
    return 1 if axis < len(space.lengths) and space.periodic[axis] else 0


@inner_kernel
def consider(rows, plans, body, other, x, y, z, space, counters, gravity):
    """Note a body's contact with another, displaced by so many containers, if it is the earliest so far."""
    d = len(space.lengths)
    offset = (x * space.lengths[0], y * space.lengths[1], z * space.lengths[d - 1])
    counters.counts[PAIR_TESTS] += 1
    time = pair_time(rows, body, other, offset, space, gravity)
    soon = plans[body].contact
    if time < soon or (time == soon and time < inf and other < plans[body].partner):
        plans[body].contact = time
        plans[body].partner = other


@inner_kernel
def find_big(rows, plans, body, space, partition, counters, gravity, big, crossed):
    """Look for an earlier contact of a small body with the big ones near its box; if it has crossed into that
    box by `crossed` (3,), with those only that were not near before."""
    here, n, widths = plans[body].at, partition.per_side, partition.widths
    anew = crossed[0] == 0 and crossed[1] == 0 and crossed[2] == 0
    lap_x, lap_y, lap_z = laps(0, space), laps(1, space), laps(2, space)
    for b in range(len(big.bodies)):
        other = big.bodies[b]
        there = plans[other].at
        square = reach_square(rows, other, space, big)
        for k in range(-lap_z, lap_z + 1):
            z = there[2] + k * n[2] - here[2]
            for j in range(-lap_y, lap_y + 1):
                y = there[1] + j * n[1] - here[1]
                for i in range(-lap_x, lap_x + 1):
                    x = there[0] + i * n[0] - here[0]
                    if near(x, y, z, widths, square) and (
                        anew or not near(x + crossed[0], y + crossed[1], z + crossed[2], widths, square)
                    ):
                        consider(rows, plans, body, other, i, j, k, space, counters, gravity)


@inner_helper
def span(here, n, width, square, periodic):
    """The first and last coordinate of boxes along an axis that may be near; on a periodic axis they go on
    beyond the container."""
    steps = int(sqrt(square) / width) + 2
    if periodic:
        return here - min(steps, n), here + min(steps, n)
    return max(here - steps, 0), min(here + steps, n - 1)


@inner_helper
def lap_of(coordinate, n):
    """In which image of the container a box coordinate lies."""
    return 1 if coordinate >= n else (-1 if coordinate < 0 else 0)


@inner_kernel
def find_around(rows, plans, body, space, partition, counters, gravity, big, crossed):
    """Look for an earlier contact of a big body with all the bodies in boxes near its own; if it has crossed
    into that box by `crossed` (3,), in those only that were not near before."""
    here, n, widths = plans[body].at, partition.per_side, partition.widths
    anew = crossed[0] == 0 and crossed[1] == 0 and crossed[2] == 0
    square = reach_square(rows, body, space, big)
    first_x, last_x = span(here[0], n[0], widths[0], square, laps(0, space) > 0)
    first_y, last_y = span(here[1], n[1], widths[1], square, laps(1, space) > 0)
    first_z, last_z = span(here[2], n[2], widths[2], square, laps(2, space) > 0)
    for k in range(first_z, last_z + 1):
        z, lap_z = k - here[2], lap_of(k, n[2])
        row = (k - lap_z * n[2]) * partition.strides[2]
        for j in range(first_y, last_y + 1):
            y, lap_y = j - here[1], lap_of(j, n[1])
            line = row + (j - lap_y * n[1]) * partition.strides[1]
            for i in range(first_x, last_x + 1):
                x, lap_x = i - here[0], lap_of(i, n[0])
                if not near(x, y, z, widths, square) or not (
                    anew or not near(x + crossed[0], y + crossed[1], z + crossed[2], widths, square)
                ):
                    continue
                counters.counts[BOX_VISITS] += 1
                box = line + (i - lap_x * n[0]) * partition.strides[0]
                other = NOTHING
                for m in range(partition.filled[box]):
                    other = int(member(partition, box, m, other))
                    if other != body:
                        consider(rows, plans, body, other, lap_x, lap_y, lap_z, space, counters, gravity)


@inner_kernel
def find_other_big(rows, plans, body, space, counters, gravity, big):
    """Look for an earlier contact of a big body with the other big ones."""
    lap_x, lap_y, lap_z = laps(0, space), laps(1, space), laps(2, space)
    for b in range(len(big.bodies)):
        if big.bodies[b] == body:
            continue
        for k in range(-lap_z, lap_z + 1):
            for j in range(-lap_y, lap_y + 1):
                for i in range(-lap_x, lap_x + 1):
                    consider(rows, plans, body, big.bodies[b], i, j, k, space, counters, gravity)


@inner_kernel
def find_beside(rows, plans, body, space, partition, counters, gravity, big, crossed):
    """What `find_contact` leaves to be looked at where there are big bodies; `crossed` (3,): the step into
    the next box that the body has just made, or none."""
    if rows[body, 2 * len(space.lengths) + 1] <= big.above:
        find_big(rows, plans, body, space, partition, counters, gravity, big, crossed)
        return
    find_around(rows, plans, body, space, partition, counters, gravity, big, crossed)
    find_other_big(rows, plans, body, space, counters, gravity, big)
