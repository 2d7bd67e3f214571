"""Bodies that grow while they fly and collide: the kernels of a compression (`compression`).

Smooth bodies of mass 1, all growing in proportion, in a container of hard or periodic faces: a row's radius
is that at time 0 of the clocks, and 1 + rate t times that at time t. Queue, boxes and rows are those of
`event_kernels`; here every event plans its bodies afresh.
"""

from math import inf, sqrt

from gaspart.contact import time_to_growing_contact, time_to_plane
from gaspart.coordinates import nearest
from gaspart.engines.calendar import TURN, fill, is_stale, next_turn, reschedule, soonest, time_of
from gaspart.engines.flight import advance_row, synchronise
from gaspart.engines.layout import COLLISIONS, NOTHING, VIRIAL
from gaspart.engines.lists import member, move, sort_in
from gaspart.engines.running_sum import add
from gaspart.kernel import inner_helper, inner_kernel, kernel

_PART = 2.0**-30  # of the rate of growth: bodies part at least so fast


@inner_helper
def pair_time(rows, i, j, offset, space, rate):
    """When two growing bodies touch, the second displaced by `offset` (d,); inf if they do not."""
    d = len(space.lengths)
    start = max(rows[i, 2 * d], rows[j, 2 * d])
    late_i = start - rows[i, 2 * d]
    late_j = start - rows[j, 2 * d]
    rr = rv = vv = 0.0
    for k in range(d):
        v = rows[j, d + k] - rows[i, d + k]
        r = (rows[j, k] + rows[j, d + k] * late_j) - (rows[i, k] + rows[i, d + k] * late_i) + offset[k]
        rr += r * r
        rv += r * v
        vv += v * v
    sigma = rows[i, 2 * d + 1] + rows[j, 2 * d + 1]
    return start + time_to_growing_contact(rr, rv, vv, sigma * (1.0 + rate * start), sigma * rate)


@inner_kernel
def find_face(rows, plans, body, space, partition, rate):
    """The next face of its box or of the container that a body comes to: (time, 2 axis + side)."""
    d = len(space.lengths)
    clock = rows[body, 2 * d]
    growth = space.margin * rows[body, 2 * d + 1] * rate
    radius = space.margin * rows[body, 2 * d + 1] * (1.0 + rate * clock)
    soon = inf
    face = NOTHING
    for k in range(d):
        at, x, v = plans[body].at[k], rows[body, k], rows[body, d + k]
        for upper in range(2):
            time = inf
            if at == (partition.per_side[k] - 1 if upper else 0) and not space.periodic[k]:
                speed = (v if upper else -v) + growth
                if speed > 0.0:
                    time = max(0.0, (space.lengths[k] - x if upper else x) - radius) / speed
            elif (v > 0.0) if upper else (v < 0.0):
                # the outermost plane exactly where the container ends, whatever rounding makes of its boxes
                plane = (
                    space.lengths[k]
                    if at + upper == partition.per_side[k]
                    else ((at + upper) * partition.widths[k])
                )
                time = max(0.0, time_to_plane(x, v, plane))
            if clock + time < soon:
                soon = clock + time
                face = 2 * k + upper
    return soon, face


@inner_kernel
def foresee(rows, plans, body, space, partition, rate, turn):
    """Make a body's plans afresh."""
    d = len(space.lengths)
    at = plans[body].at
    best = inf
    partner = NOTHING
    for dz in range(3):
        for dy in range(3):
            for dx in range(3):
                z = partition.neighbour[2, at[2], dz]
                y = partition.neighbour[1, at[1], dy]
                x = partition.neighbour[0, at[0], dx]
                if x < 0 or y < 0 or z < 0:
                    continue
                offset = (
                    partition.shift[0, at[0], dx] * space.lengths[0],
                    partition.shift[1, at[1], dy] * space.lengths[1],
                    partition.shift[2, at[2], dz] * space.lengths[d - 1],
                )
                box = x + y + z
                other = NOTHING
                for n in range(partition.filled[box]):
                    other = int(member(partition, box, n, other))
                    if other != body:
                        time = pair_time(rows, body, other, offset, space, rate)
                        if time < best or (time == best and time < inf and other < partner):
                            best = time
                            partner = other
    plans[body].contact = best
    plans[body].partner = partner
    plans[body].foreseen = turn
    plans[body].face_time, plans[body].face = find_face(rows, plans, body, space, partition, rate)


@kernel
def start(rows, plans, calendar, space, partition, rate):
    """Bring the temperature back to 1 and the centre of mass to rest, and make all plans."""
    d = len(space.lengths)
    square = 0.0
    for k in range(d):
        total = 0.0
        for body in range(len(rows)):
            total += rows[body, d + k]
        for body in range(len(rows)):
            rows[body, d + k] -= total / len(rows) if len(rows) > 1 else 0.0
            square += rows[body, d + k] * rows[body, d + k]
    factor = sqrt(d * len(rows) / square)
    sort_in(plans, partition)
    for body in range(len(rows)):
        for k in range(d):
            rows[body, d + k] *= factor
    for body in range(len(rows)):
        foresee(rows, plans, body, space, partition, rate, calendar.cursor[TURN])
    fill(calendar, plans, 0.0)


@inner_kernel
def meet_face(rows, plans, body, face, time, space, partition, rate):
    """Let a body pass into the next box, or reflect it at a wall that its growing surface touches. Returns
    whether its flight has changed."""
    d = len(space.lengths)
    axis, upper = face // 2, face % 2
    outermost = plans[body].at[axis] == (partition.per_side[axis] - 1 if upper else 0)
    if outermost:
        advance_row(rows, body, time, space, None)
    if outermost and not space.periodic[axis]:
        growth = space.margin * rows[body, 2 * d + 1] * rate
        speed = (rows[body, d + axis] if upper else -rows[body, d + axis]) + growth
        speed = max(speed, _PART * growth) + growth
        rows[body, d + axis] = -speed if upper else speed
        return True
    to = plans[body].at[axis] + 2 * upper - 1
    if outermost:
        rows[body, axis] = 0.0 if upper else space.lengths[axis]
        to = 0 if upper else partition.per_side[axis] - 1
    move(plans, partition, body, axis, to)
    return outermost


@inner_kernel
def collide(rows, i, j, time, space, rate, counters):
    """Advance two bodies to their contact and let their growing surfaces push them apart."""
    d = len(space.lengths)
    advance_row(rows, i, time, space, None)
    advance_row(rows, j, time, space, None)
    rr = rv = 0.0
    for k in range(d):
        gap = nearest(rows[j, k] - rows[i, k], space.lengths[k], space.periodic[k])
        rr += gap * gap
        rv += gap * (rows[j, d + k] - rows[i, d + k])
    growth = (rows[i, 2 * d + 1] + rows[j, 2 * d + 1]) * rate
    length = sqrt(rr)
    approach = max(growth - rv / length, _PART * growth)
    for k in range(d):
        push = approach * nearest(rows[j, k] - rows[i, k], space.lengths[k], space.periodic[k]) / length
        rows[i, d + k] -= push
        rows[j, d + k] += push
    counters.counts[COLLISIONS] += 1
    add(counters.sums, VIRIAL, approach * length)


@kernel
def run_growing(rows, plans, calendar, space, partition, rate, counters, stop, most):
    """Process all events up to time `stop`, or `most` collisions. Returns the time that is reached."""
    last = 0.0
    while counters.counts[COLLISIONS] < most:
        body = soonest(calendar, plans)
        if body < 0 or not time_of(plans, body) <= stop:
            return stop
        time = time_of(plans, body)
        last = max(last, time)
        turn = next_turn(calendar)
        if plans[body].face_time <= plans[body].contact:
            if meet_face(rows, plans, body, plans[body].face, time, space, partition, rate):
                plans[body].changed = turn
        elif not is_stale(plans, body):
            partner = plans[body].partner
            collide(rows, min(body, partner), max(body, partner), time, space, rate, counters)
            plans[body].changed = plans[partner].changed = turn
            foresee(rows, plans, partner, space, partition, rate, turn)
            reschedule(calendar, plans, partner)
        foresee(rows, plans, body, space, partition, rate, turn)
        reschedule(calendar, plans, body)
    return last


@kernel
def closest(rows, plans, space, partition):
    """The least r^2/sigma^2 of all pairs in neighbouring boxes, all at one time; inf if there is none."""
    d = len(space.lengths)
    least = inf
    for body in range(len(rows)):
        at = plans[body].at
        for n in range(27):
            x = partition.neighbour[0, at[0], n % 3]
            y = partition.neighbour[1, at[1], n // 3 % 3]
            z = partition.neighbour[2, at[2], n // 9]
            if x < 0 or y < 0 or z < 0:
                continue
            box = x + y + z
            other = NOTHING
            for m in range(partition.filled[box]):
                other = int(member(partition, box, m, other))
                if other != body:
                    rr = 0.0
                    for k in range(d):
                        gap = nearest(rows[other, k] - rows[body, k], space.lengths[k], space.periodic[k])
                        rr += gap * gap
                    sigma = rows[body, 2 * d + 1] + rows[other, 2 * d + 1]
                    least = min(least, rr / (sigma * sigma))
    return least


__all__ = ["closest", "run_growing", "start", "synchronise"]
