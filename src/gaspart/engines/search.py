"""Whom does a body touch next: the search of the boxes about it.

In three passes, so that the processor has little to guess: gather everybody there, drop those that part or
miss, and work out the times of the few that are left (`flight.pair_time`, which alone decides). Indices are
unsigned, since for signed ones numba looks at every access whether it counts from the end.
"""

from math import inf

from numpy import int64, uint64

from gaspart.engines.flight import may_touch, pair_time
from gaspart.engines.layout import BOX_VISITS, PAIR_TESTS
from gaspart.kernel import helper, kernel

ROOM = 192  # candidates gathered before they are looked at
_SPARE = 4  # that one box may add unasked
_BODY, _LAP = uint64(0xFFFFFFFF), uint64(32)  # a candidate: the body, and above it the number of its image


@kernel
def consider(rows, plans, body, met, space, partition, counters, gravity):
    """Note the body's contact with one of the first `met` candidates, if one is earlier than it has planned.
    Returns 0, the number of candidates that are left."""
    near, offset = partition.near, partition.offset
    counters.counts[PAIR_TESTS] += int64(met)
    left = uint64(0)
    for n in range(met):
        candidate = near[n]
        near[left] = candidate
        meets = may_touch(rows, body, candidate & _BODY, offset[candidate >> _LAP], space, gravity)
        left += uint64(meets)
    best = plans[body].contact
    partner = int64(plans[body].partner)
    found = False
    for n in range(left):
        other = near[n] & _BODY
        time = pair_time(rows, body, other, offset[near[n] >> _LAP], space, gravity)
        if time < best or (time == best and time < inf and int64(other) < partner):
            best = time
            partner = int64(other)
            found = True
    if found:
        plans[body].contact = best
        plans[body].partner = partner
        plans[body].partner_changes = plans[uint64(partner)].changes
    return uint64(0)


@helper
def offer(near, met, other, lap, body, nobody):
    """Write down a candidate, to stay if it is somebody else. Returns how many there are."""
    near[met] = uint64(other) | lap
    return met + uint64((other != body) & (other != nobody))


@kernel
def find_contact(rows, plans, searcher, space, partition, counters, low, high, gravity):
    """Look for an earlier contact of the body in the boxes at steps low..high (3,) from its own.

    The first three bodies of a box are read whether they are there or not, which costs less than to ask.
    """
    body = uint64(searcher)
    at = plans[body].at
    ax, ay, az = uint64(at[0]), uint64(at[1]), uint64(at[2])
    near, following = partition.near, partition.following
    nobody = uint64(len(rows))
    met = uint64(0)
    visits = 0
    for dz in range(uint64(low[2] + 1), uint64(high[2] + 2)):
        z = partition.neighbour[2, az, dz]
        if z < 0:
            continue
        lap_z = 13 + 9 * partition.shift[2, az, dz]
        for dy in range(uint64(low[1] + 1), uint64(high[1] + 2)):
            y = partition.neighbour[1, ay, dy]
            if y < 0:
                continue
            lap_y = lap_z + 3 * partition.shift[1, ay, dy]
            for dx in range(uint64(low[0] + 1), uint64(high[0] + 2)):
                x = partition.neighbour[0, ax, dx]
                if x < 0:
                    continue
                lap = uint64(lap_y + partition.shift[0, ax, dx]) << _LAP
                visits += 1
                first = partition.head[uint64(x + y + z)]
                second = following[first]
                other = following[second]
                met = offer(near, met, first, lap, body, nobody)
                met = offer(near, met, second, lap, body, nobody)
                met = offer(near, met, other, lap, body, nobody)
                other = following[other]
                while other != nobody:
                    met = offer(near, met, other, lap, body, nobody)
                    other = following[other]
                    if met > ROOM - _SPARE:
                        met = consider(rows, plans, body, met, space, partition, counters, gravity)
                if met > ROOM - _SPARE:
                    met = consider(rows, plans, body, met, space, partition, counters, gravity)
    consider(rows, plans, body, met, space, partition, counters, gravity)
    counters.counts[BOX_VISITS] += visits
