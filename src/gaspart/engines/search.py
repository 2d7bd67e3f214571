"""Whom does a body touch next: the search of the boxes about it.

In three passes, so that the processor has little to guess: gather everybody there, drop those that part or
miss, eight at a time (`eight`), and work out the times of the few that are left (`flight.pair_time`, which
alone decides). Indices are unsigned, since for signed ones numba looks at every access whether it counts from
the end.
"""

from math import inf

from numpy import int64, uint64

from gaspart.engines.eight import LAP_BITS, LAP_FIRST, WIDTH, lowest, which_meet
from gaspart.engines.flight import pair_time
from gaspart.engines.layout import BOX_VISITS, PAIR_TESTS, PLACES
from gaspart.kernel import helper, kernel

MOST = 64  # candidates gathered before they are looked at: a bit of a word for each
_WIDTH, _PLACES, _FULL = uint64(WIDTH), uint64(PLACES), uint64(MOST - PLACES - 1)
_BODY = uint64((1 << LAP_FIRST) - 1)
_X, _Y, _Z = (uint64(LAP_FIRST + LAP_BITS * k) for k in range(3))
_LAP = uint64((1 << LAP_BITS) - 1)


@helper
def offset_of(candidate, space):
    """Where the image of a candidate stands (3,)."""
    x, y, z = (candidate >> _X) & _LAP, (candidate >> _Y) & _LAP, (candidate >> _Z) & _LAP
    lengths = space.lengths
    return (
        (int64(x) - 1) * lengths[0],
        (int64(y) - 1) * lengths[1],
        (int64(z) - 1) * lengths[len(lengths) - 1],
    )


@helper
def consider(rows, plans, body, met, space, partition, gravity):
    """Note the body's contact with one of `met` candidates, if one is earlier than it has planned."""
    near = partition.near
    for n in range(_WIDTH):
        near[met + n] = body  # no body meets itself
    left = uint64(0)
    for n in range(uint64(0), met, _WIDTH):
        left |= which_meet(rows, near, n, body, space, gravity) << n
    best = plans[body].contact
    partner = int64(plans[body].partner)
    found = False
    while left:
        candidate = near[lowest(left)]
        left &= left - uint64(1)
        other = candidate & _BODY
        time = pair_time(rows, body, other, offset_of(candidate, space), space, gravity)
        if time < best or (time == best and time < inf and int64(other) < partner):
            best = time
            partner = int64(other)
            found = True
    if found:
        plans[body].contact = best
        plans[body].partner = partner
        plans[body].partner_changes = plans[uint64(partner)].changes


@kernel
def make_room(rows, plans, body, met, space, partition, gravity):
    """Look at the candidates if there may be no room for another box's. Returns how many are left."""
    consider(rows, plans, body, met, space, partition, gravity)
    return uint64(0)


@helper
def find_contact(rows, plans, searcher, space, partition, counters, crossed, gravity):
    """Look for an earlier contact of the body in the boxes about its own; if it has just `crossed` (3,) into
    this one, in those only that were not neighbours before.

    All places of a box are written down whether they are filled or not, which costs less than to ask.
    """
    body = uint64(searcher)
    at = plans[body].at
    ax, ay, az = uint64(at[0]), uint64(at[1]), uint64(at[2])
    own = uint64(plans[body].box)
    near, following = partition.near, partition.following
    neighbour, shift = partition.neighbour, partition.shift
    x, y, z = crossed
    low_x, low_y, low_z = uint64(1 + x if x else 0), uint64(1 + y if y else 0), uint64(1 + z if z else 0)
    end_x, end_y, end_z = uint64(2 + x if x else 3), uint64(2 + y if y else 3), uint64(2 + z if z else 3)
    met = uint64(0)
    visits = 0
    tests = uint64(0)
    for dz in range(low_z, end_z):
        beside_z = neighbour[2, az, dz]
        if beside_z < 0:
            continue
        lap_z = uint64(shift[2, az, dz] + 1) << _Z
        for dy in range(low_y, end_y):
            beside_y = neighbour[1, ay, dy]
            if beside_y < 0:
                continue
            lap_y = lap_z | uint64(shift[1, ay, dy] + 1) << _Y
            for dx in range(low_x, end_x):
                beside_x = neighbour[0, ax, dx]
                if beside_x < 0:
                    continue
                lap = lap_y | uint64(shift[0, ax, dx] + 1) << _X
                visits += 1
                box = uint64(beside_x + beside_y + beside_z)
                filled = uint64(partition.filled[box])
                tests += filled - uint64(box == own)
                first, second = partition.places[box, 0], partition.places[box, 1]
                third, fourth = partition.places[box, 2], partition.places[box, 3]
                near[met] = uint64(first) | lap
                near[met + uint64(1)] = uint64(second) | lap
                near[met + uint64(2)] = uint64(third) | lap
                near[met + uint64(3)] = uint64(fourth) | lap
                met += min(filled, _PLACES)
                if filled > _PLACES:
                    other = uint64(partition.head[box])
                    for _ in range(_PLACES, filled):
                        near[met] = other | lap
                        met += uint64(1)
                        if met > _FULL:
                            met = make_room(rows, plans, body, met, space, partition, gravity)
                        other = uint64(following[other])
                if met > _FULL:
                    met = make_room(rows, plans, body, met, space, partition, gravity)
    consider(rows, plans, body, met, space, partition, gravity)
    counters.counts[PAIR_TESTS] += int64(tests)
    counters.counts[BOX_VISITS] += visits
