"""From one event to the next: the kernels of the event-driven engine.

A body's row holds its position, velocity, clock and radius, true at that clock; between its events a body
is not touched. So that no bit depends on how events are searched for:

- the time of a pair's contact is always computed from the later of the two clocks, never from "now";
- crossing into another box changes what is searched, never the row;
- crossing a periodic face is an event: the row is advanced to the face and moved to the opposite one.

Events come in the order of their time; simultaneous ones faces first, by body, then pairs by the lower
and the higher index of their bodies.
"""

from math import inf
from typing import NamedTuple

import numpy as np

from gaspart.boxes import nearest, put, take
from gaspart.contact import exchange, exchange_equal, time_to_contact, time_to_plane
from gaspart.engines.calendar import restart, schedule, soonest
from gaspart.kernel import kernel

COLLISIONS, CROSSINGS, STALE, PAIR_TESTS, BOX_VISITS = range(5)
VIRIAL, WORST = range(2)
NOTHING = -1
INNER = 6  # face codes: 2 axis + side for the container's faces, INNER more for those between boxes
STOP, EVENTS, FULL = range(3)  # why a run ended: the time, the number of events, the record


class Space(NamedTuple):
    """lengths (d,), periodic (d,); margin: 1 if walls stop surfaces, 0 if they stop centres."""

    lengths: tuple
    periodic: tuple
    margin: float


class Bodies(NamedTuple):
    """rows (N, 2d + 2): position, velocity, clock, radius; images (N, d); changes (N,), events so far."""

    rows: np.ndarray
    images: np.ndarray
    changes: np.ndarray


class Plans(NamedTuple):
    """What is foreseen for each body: the time of its next contact, with whom, and that partner's number
    of changes when this was foreseen; the time of its next face, and which."""

    contact: np.ndarray
    partner: np.ndarray
    partner_changes: np.ndarray
    face_time: np.ndarray
    face: np.ndarray


class Partition(NamedTuple):
    """The grid of boxes (see `boxes.Boxes`), each body's box coordinates at (N, 3), and the boxes' lists."""

    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray
    shift: np.ndarray
    at: np.ndarray
    head: np.ndarray
    following: np.ndarray
    preceding: np.ndarray


class Counters(NamedTuple):
    """counts (5,), sums (2,), wall_hits (2d,), wall_impulse (2d,); see the names at the module's top."""

    counts: np.ndarray
    sums: np.ndarray
    wall_hits: np.ndarray
    wall_impulse: np.ndarray


class Record(NamedTuple):
    """Room for events: filled (1,), time (M,), bodies (M, 2), positions and velocities (M, 2, d)."""

    filled: np.ndarray
    time: np.ndarray
    bodies: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray


@kernel
def pair_time(rows, i, j, offset, lengths):
    """When bodies i and j touch, j displaced by `offset` (d,); inf if they do not."""
    d = len(lengths)
    start = max(rows[i, 2 * d], rows[j, 2 * d])
    late_i = start - rows[i, 2 * d]
    late_j = start - rows[j, 2 * d]
    rr = 0.0
    rv = 0.0
    vv = 0.0
    for k in range(d):
        v = rows[j, d + k] - rows[i, d + k]
        r = (rows[j, k] + rows[j, d + k] * late_j) - (rows[i, k] + rows[i, d + k] * late_i) + offset[k]
        rr += r * r
        rv += r * v
        vv += v * v
    sigma = rows[i, 2 * d + 1] + rows[j, 2 * d + 1]
    return start + time_to_contact(rr, rv, vv, sigma * sigma)


@kernel
def face_plane(rows, body, axis, upper, space):
    """Where a face of the container stops, or on a periodic axis passes on, this body's centre."""
    inset = 0.0 if space.periodic[axis] else space.margin * rows[body, 2 * len(space.lengths) + 1]
    return space.lengths[axis] - inset if upper else inset


@kernel
def find_face(rows, body, space, partition):
    """The next face that the body comes to, of its box or of the container: (time, face code)."""
    d = len(space.lengths)
    soon = inf
    face = NOTHING
    for k in range(d):
        v = rows[body, d + k]
        if v == 0.0:
            continue
        upper = v > 0.0
        at = partition.at[body, k]
        code = 2 * k + (1 if upper else 0)
        if at == (partition.per_side[k] - 1 if upper else 0):
            plane = face_plane(rows, body, k, upper, space)
        else:
            plane = (at + 1 if upper else at) * partition.widths[k]
            code += INNER
        time = rows[body, 2 * d] + time_to_plane(rows[body, k], v, plane)
        if time < soon:
            soon = time
            face = code
    return soon, face


@kernel
def find_contact(bodies, plans, body, space, partition, counters, low, high):
    """Look for an earlier contact of the body in the boxes at steps low..high (3,) from its own."""
    d = len(space.lengths)
    rows = bodies.rows
    at = partition.at
    best = plans.contact[body]
    partner = plans.partner[body]
    found = False
    tests = 0
    visits = 0
    for dz in range(low[2], high[2] + 1):
        z = partition.neighbour[2, at[body, 2], dz + 1]
        if z < 0:
            continue
        far_z = partition.shift[2, at[body, 2], dz + 1] * space.lengths[d - 1]  # 0 in two dimensions
        for dy in range(low[1], high[1] + 1):
            y = partition.neighbour[1, at[body, 1], dy + 1]
            if y < 0:
                continue
            far_y = partition.shift[1, at[body, 1], dy + 1] * space.lengths[1]
            for dx in range(low[0], high[0] + 1):
                x = partition.neighbour[0, at[body, 0], dx + 1]
                if x < 0:
                    continue
                offset = (partition.shift[0, at[body, 0], dx + 1] * space.lengths[0], far_y, far_z)
                visits += 1
                other = partition.head[x + y + z]
                while other >= 0:
                    if other != body:
                        tests += 1
                        time = pair_time(rows, body, other, offset, space.lengths)
                        if time < best or (time == best and time < inf and other < partner):
                            best = time
                            partner = other
                            found = True
                    other = partition.following[other]
    if found:
        plans.contact[body] = best
        plans.partner[body] = partner
        plans.partner_changes[body] = bodies.changes[partner]
    counters.counts[PAIR_TESTS] += tests
    counters.counts[BOX_VISITS] += visits


@kernel
def enter(calendar, plans, body):
    """Put the sooner of the body's two plans into the calendar."""
    count = len(plans.contact)
    if plans.face_time[body] <= plans.contact[body]:
        schedule(calendar, body, plans.face_time[body], body - count)
    else:
        partner = plans.partner[body]
        tie = min(body, partner) * count + max(body, partner)
        schedule(calendar, body, plans.contact[body], tie)


EVERYWHERE = (-1, -1, -1), (1, 1, 1)


@kernel
def foresee(bodies, plans, body, space, partition, counters):
    """Make a body's plans afresh."""
    plans.contact[body] = inf
    plans.partner[body] = NOTHING
    find_contact(bodies, plans, body, space, partition, counters, *EVERYWHERE)
    plans.face_time[body], plans.face[body] = find_face(bodies.rows, body, space, partition)


@kernel
def foresee_all(bodies, plans, calendar, space, partition, counters, now):
    """Sort all bodies into their boxes, make all plans and fill the calendar. `partition.at` is given."""
    partition.head[:] = -1
    count = len(bodies.rows)
    for body in range(count):
        put(partition.head, partition.following, partition.preceding, box_of(partition, body), body)
    for body in range(count):
        foresee(bodies, plans, body, space, partition, counters)
        enter(calendar, plans, body)
    restart(calendar, now)


@kernel
def refill(plans, calendar, partition, now):
    """Rebuild lists and calendar from plans that are already made, as after a checkpoint."""
    partition.head[:] = -1
    count = len(plans.contact)
    for body in range(count):
        put(partition.head, partition.following, partition.preceding, box_of(partition, body), body)
        enter(calendar, plans, body)
    restart(calendar, now)


@kernel
def box_of(partition, body):
    """The linear index of the body's box."""
    at = partition.at
    strides = partition.strides
    return at[body, 0] * strides[0] + at[body, 1] * strides[1] + at[body, 2] * strides[2]


@kernel
def cross(bodies, plans, calendar, body, space, partition, counters):
    """Let a body pass into the next box, and look about in the boxes that have become neighbours."""
    code = plans.face[body] - INNER
    axis = code // 2
    step = 1 if code % 2 else -1
    take(partition.head, partition.following, partition.preceding, box_of(partition, body), body)
    partition.at[body, axis] += step
    put(partition.head, partition.following, partition.preceding, box_of(partition, body), body)
    counters.counts[CROSSINGS] += 1
    x = step if axis == 0 else 0
    y = step if axis == 1 else 0
    z = step if axis == 2 else 0
    low = (x if x else -1, y if y else -1, z if z else -1)
    high = (x if x else 1, y if y else 1, z if z else 1)
    find_contact(bodies, plans, body, space, partition, counters, low, high)
    plans.face_time[body], plans.face[body] = find_face(bodies.rows, body, space, partition)
    enter(calendar, plans, body)


@kernel
def advance_row(rows, body, time, lengths):
    """Move a body along its flight to `time`."""
    d = len(lengths)
    late = time - rows[body, 2 * d]
    for k in range(d):
        rows[body, k] += rows[body, d + k] * late
    rows[body, 2 * d] = time


@kernel
def meet_face(bodies, body, face, time, space, masses, counters):
    """Reflect a body at a wall, or take it from a periodic face to the opposite one. True if a wall."""
    d = len(space.lengths)
    rows = bodies.rows
    axis = face // 2
    upper = face % 2 == 1
    advance_row(rows, body, time, space.lengths)
    bodies.changes[body] += 1
    if space.periodic[axis]:
        rows[body, axis] = 0.0 if upper else space.lengths[axis]
        bodies.images[body, axis] += 1 if upper else -1
        return False
    rows[body, axis] = face_plane(rows, body, axis, upper, space)
    mass = 1.0 if masses is None else masses[body]
    counters.wall_hits[face] += 1
    counters.wall_impulse[face] += 2.0 * mass * abs(rows[body, d + axis])
    rows[body, d + axis] = -rows[body, d + axis]
    return True


@kernel
def collide(bodies, i, j, time, space, masses, counters):
    """Advance two bodies to their contact and pass the momentum."""
    d = len(space.lengths)
    rows = bodies.rows
    advance_row(rows, i, time, space.lengths)
    advance_row(rows, j, time, space.lengths)
    rr = 0.0
    rv = 0.0
    for k in range(d):
        gap = nearest(rows[j, k] - rows[i, k], space.lengths[k], space.periodic[k])
        rr += gap * gap
        rv += gap * (rows[j, d + k] - rows[i, d + k])
    if masses is None:
        to_i = to_j = exchange_equal(rr, rv)
        counters.sums[VIRIAL] += abs(rv)
    else:
        to_i, to_j = exchange(rr, rv, masses[i], masses[j])
        counters.sums[VIRIAL] += masses[i] * abs(to_i) * rr
    for k in range(d):
        gap = nearest(rows[j, k] - rows[i, k], space.lengths[k], space.periodic[k])
        rows[i, d + k] += to_i * gap
        rows[j, d + k] -= to_j * gap
    bodies.changes[i] += 1
    bodies.changes[j] += 1
    sigma = rows[i, 2 * d + 1] + rows[j, 2 * d + 1]
    counters.sums[WORST] = max(counters.sums[WORST], abs(rr / (sigma * sigma) - 1.0))
    counters.counts[COLLISIONS] += 1


@kernel
def note(record, time, bodies, i, j, lengths):
    """Write an event down; j is the partner, or -1 - face for a wall."""
    d = len(lengths)
    n = record.filled[0]
    record.time[n] = time
    record.bodies[n, 0] = i
    record.bodies[n, 1] = j
    for k in range(d):
        record.positions[n, 0, k] = bodies.rows[i, k]
        record.velocities[n, 0, k] = bodies.rows[i, d + k]
        record.positions[n, 1, k] = bodies.rows[j, k] if j >= 0 else np.nan
        record.velocities[n, 1, k] = bodies.rows[j, d + k] if j >= 0 else np.nan
    record.filled[0] = n + 1


@kernel
def run_boxes(bodies, plans, calendar, space, partition, masses, counters, record, stop, most):
    """Process all events up to time `stop`, at most `most` of them (collisions and wall hits).

    masses: (N,), or None if all are 1; record: a Record, or None. Returns (reason, number
    of events, time of the last).
    """
    done = 0
    last = -inf
    while True:
        if done >= most:
            return EVENTS, done, last
        if record is not None:
            if record.filled[0] == len(record.time):
                return FULL, done, last
        body = soonest(calendar)
        if body < 0 or not calendar.time[body] <= stop:
            return STOP, done, last
        time = calendar.time[body]
        if plans.face_time[body] <= plans.contact[body]:
            face = plans.face[body]
            if face >= INNER:
                cross(bodies, plans, calendar, body, space, partition, counters)
                continue
            wall = meet_face(bodies, body, face, time, space, masses, counters)
            if not wall:
                take(partition.head, partition.following, partition.preceding, box_of(partition, body), body)
                axis = face // 2
                partition.at[body, axis] = 0 if face % 2 else partition.per_side[axis] - 1
                put(partition.head, partition.following, partition.preceding, box_of(partition, body), body)
            foresee(bodies, plans, body, space, partition, counters)
            enter(calendar, plans, body)
            if wall:
                last = time
                done += 1
                if record is not None:
                    note(record, time, bodies, body, -1 - face, space.lengths)
            continue
        partner = plans.partner[body]
        if bodies.changes[partner] != plans.partner_changes[body]:
            counters.counts[STALE] += 1
            foresee(bodies, plans, body, space, partition, counters)
            enter(calendar, plans, body)
            continue
        i = min(body, partner)
        j = max(body, partner)
        collide(bodies, i, j, time, space, masses, counters)
        foresee(bodies, plans, i, space, partition, counters)
        foresee(bodies, plans, j, space, partition, counters)
        enter(calendar, plans, i)
        enter(calendar, plans, j)
        last = time
        done += 1
        if record is not None:
            note(record, time, bodies, i, j, space.lengths)


@kernel
def run_pairs(bodies, space, partition, masses, counters, record, stop, most):
    """The same by the first algorithm of Spencer 2021: look at all pairs before every event.

    `partition` has one box; it stores no plans, so nothing can be out of date: the referee of `run_boxes`.
    """
    d = len(space.lengths)
    count = len(bodies.rows)
    images = 3**d
    offset = np.zeros(3)
    done = 0
    last = -inf
    while True:
        if done >= most:
            return EVENTS, done, last
        if record is not None:
            if record.filled[0] == len(record.time):
                return FULL, done, last
        soon = inf
        first = NOTHING
        second = NOTHING
        face = NOTHING
        for i in range(count):
            time, code = find_face(bodies.rows, i, space, partition)
            if time < soon:
                soon, first, face = time, i, code
        for i in range(count):
            for j in range(i + 1, count):
                for image in range(images):
                    rest = image
                    absent = False
                    for k in range(d):
                        step = rest % 3 - 1
                        rest //= 3
                        absent = absent or (step != 0 and not space.periodic[k])
                        offset[k] = step * space.lengths[k]
                    if absent:
                        continue
                    counters.counts[PAIR_TESTS] += 1
                    time = pair_time(bodies.rows, i, j, offset, space.lengths)
                    if time < soon:
                        soon, first, second = time, i, j
        if not soon <= stop or first == NOTHING:
            return STOP, done, last
        if second != NOTHING:
            collide(bodies, first, second, soon, space, masses, counters)
        else:
            if not meet_face(bodies, first, face, soon, space, masses, counters):
                continue
            second = -1 - face
        last = soon
        done += 1
        if record is not None:
            note(record, soon, bodies, first, second, space.lengths)


@kernel
def synchronise(bodies, time, lengths):
    """Advance all bodies to `time`, and let that be time 0 of their clocks."""
    clock = 2 * len(lengths)
    for body in range(len(bodies.rows)):
        advance_row(bodies.rows, body, time, lengths)
        bodies.rows[body, clock] = 0.0
