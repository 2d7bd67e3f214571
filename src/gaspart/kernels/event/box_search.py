"""Whom does a body touch next: the search of the boxes about it.

First everybody there is written down, then the times of all of them are worked out, eight at once (`eight`):
with hardly a branch, so that the processor has little to guess. Indices are unsigned, since for signed ones
numba looks at every access whether it counts from the end.
"""

from math import inf

from numpy import int64, uint64

from gaspart.kernels.compilation import inner_helper, inner_kernel
from gaspart.kernels.event.model import BOX_VISITS, PAIR_TESTS, PLACES
from gaspart.kernels.flight import pair_time
from gaspart.kernels.simd import LAP_BITS, LAP_FIRST, WIDTH, earliest, lowest, write_down

MOST = 64  # candidates gathered before they are looked at: a bit of a word for each
_WIDTH, _PLACES, _FULL = uint64(WIDTH), uint64(PLACES), uint64(MOST - 3 * PLACES - 1)
_BODY = uint64((1 << LAP_FIRST) - 1)
_X, _Y, _Z = (uint64(LAP_FIRST + LAP_BITS * k) for k in range(3))
_HERE = uint64(1)  # the lap of who stands in the container itself
_LAP = uint64((1 << LAP_BITS) - 1)


@inner_helper
def offset_of(candidate, space):
    """Where the image of a candidate stands (3,)."""
    x, y, z = (candidate >> _X) & _LAP, (candidate >> _Y) & _LAP, (candidate >> _Z) & _LAP
    lengths = space.lengths
    return (
        (int64(x) - 1) * lengths[0],
        (int64(y) - 1) * lengths[1],
        (int64(z) - 1) * lengths[len(lengths) - 1],
    )


@inner_helper
def consider(rows, plans, body, met, space, partition, counters, gravity):
    """Note the body's contact with one of `met` candidates, if one is earlier than it has planned."""
    near = partition.near
    counters.counts[PAIR_TESTS] += int64(met)
    for n in range(_WIDTH):
        near[met + n] = body  # no body meets itself
    soon, partner = plans[body].contact, int64(plans[body].partner)
    best, who, left = earliest(rows, near, met, body, soon, partner, space, gravity, partition.still)
    if gravity is not None:
        while left:
            candidate = near[lowest(left)]
            left &= left - uint64(1)
            other = candidate & _BODY
            time = pair_time(rows, body, other, offset_of(candidate, space), space, gravity)
            if time < best or (time == best and time < inf and int64(other) < who):
                best = time
                who = int64(other)
    if best < soon or who != partner:
        plans[body].contact = best
        plans[body].partner = who


@inner_kernel
def settle(rows, plans, body, met, row, lap, low, end, space, partition, counters, gravity):
    """Write down whom the boxes at steps low..end - 1 of a row could not give a place, and look at the
    candidates whenever there may be no room for another row's. Returns how many are left."""
    near, neighbour = partition.near, partition.neighbour
    x = uint64(plans[body].at[0])
    for step in range(low, end):
        beside = neighbour[0, x, step]
        if beside < 0:
            continue
        box = uint64(row + beside)
        lap_x = lap | uint64(partition.shift[0, x, step] + 1) << _X
        other = uint64(partition.head[box])
        for _ in range(_PLACES, uint64(partition.filled[box])):
            near[met] = other | lap_x
            met += uint64(1)
            if met > _FULL:
                consider(rows, plans, body, met, space, partition, counters, gravity)
                met = uint64(0)
            other = uint64(partition.following[other])
    if met > _FULL:
        consider(rows, plans, body, met, space, partition, counters, gravity)
        met = uint64(0)
    return met


@inner_helper
def span(partition, axis, at, crossed):
    """Which boxes to look into along an axis, about that at a coordinate: first step and end (0..3), how many
    there are, and how many of them are that box itself."""
    low, end = uint64(0), uint64(3)
    if crossed:
        low = uint64(1 + crossed)
        end = low + uint64(1)
    visits = itself = 0
    own = partition.neighbour[axis, at, 1]
    for step in range(low, end):
        beside = partition.neighbour[axis, at, step]
        visits += int64(beside >= 0)
        itself += int64(beside == own)
    return low, end, visits, itself


@inner_helper
def note_box(near, met, partition, box, lap, crowd):
    """Write down whom a box has places for, after `met` others: how many there now are, and how many bodies
    the fullest box so far holds, `crowd`."""
    write_down(near, met, partition.places, box, lap)
    filled = uint64(partition.filled[box])
    return met + min(filled, _PLACES), max(crowd, filled)


@inner_helper
def find_contact(rows, plans, searcher, space, partition, counters, crossed, gravity):
    """Look for an earlier contact of the body in the boxes about its own; if it has just `crossed` (3,) into
    this one, in those only that were not neighbours before.

    All places of a box are written down whether they are filled or not, which costs less than to ask.
    """
    body = uint64(searcher)
    at = plans[body].at
    ax, ay, az = uint64(at[0]), uint64(at[1]), uint64(at[2])
    neighbour, shift = partition.neighbour, partition.shift
    low_x, end_x, visits_x, itself_x = span(partition, 0, ax, crossed[0])
    low_y, end_y, visits_y, itself_y = span(partition, 1, ay, crossed[1])
    low_z, end_z, visits_z, itself_z = span(partition, 2, az, crossed[2])
    counters.counts[BOX_VISITS] += visits_x * visits_y * visits_z
    counters.counts[PAIR_TESTS] -= itself_x * itself_y * itself_z
    near = partition.near
    within = crossed[0] == 0 and 0 < at[0] < partition.per_side[0] - 1  # a row's three lie side by side
    met = uint64(0)
    for dz in range(low_z, end_z):
        beside_z = neighbour[2, az, dz]
        if beside_z < 0:
            continue
        lap_z = uint64(shift[2, az, dz] + 1) << _Z
        for dy in range(low_y, end_y):
            beside_y = neighbour[1, ay, dy]
            if beside_y < 0:
                continue
            row = beside_y + beside_z
            lap = lap_z | uint64(shift[1, ay, dy] + 1) << _Y
            crowd = uint64(0)
            if within:
                first = uint64(row + at[0] - 1)
                for box in range(first, first + uint64(3)):
                    met, crowd = note_box(near, met, partition, box, lap | _HERE << _X, crowd)
            else:
                for dx in range(low_x, end_x):
                    beside_x = neighbour[0, ax, dx]
                    if beside_x >= 0:
                        box, lap_x = uint64(row + beside_x), lap | uint64(shift[0, ax, dx] + 1) << _X
                        met, crowd = note_box(near, met, partition, box, lap_x, crowd)
            if crowd > _PLACES or met > _FULL:
                met = settle(
                    rows, plans, body, met, row, lap, low_x, end_x, space, partition, counters, gravity
                )
    consider(rows, plans, body, met, space, partition, counters, gravity)
