"""From one event to the next: the kernels of the event-driven engine.

A body's row of 8 numbers, one cache line, holds its position (d), velocity (d), clock and radius, true at
that clock; between its events a body is not touched. Beside it stand its plans (see `calendar.PLAN`) and
`images` (N, d), its laps through periodic faces. So that no bit depends on how events are searched for:

- the time of a pair's contact is always computed from the later of the two clocks, never from "now";
- crossing into another box changes what is searched, never the row;
- crossing a periodic face is an event: the row is advanced to the face and moved to the opposite one.

Events come in the order of their time; simultaneous ones faces first, by body, then pairs by the lower
and the higher index of their bodies.
"""

from math import inf

import numpy as np

from gaspart.engines.ahead import CACHED, look_ahead
from gaspart.engines.big import find_beside
from gaspart.engines.calendar import TURN, fill, is_stale, next_turn, reschedule, slot_of, soonest, time_of
from gaspart.engines.faces import find_face, meet_face
from gaspart.engines.flight import note_still
from gaspart.engines.impact import collide, crowded
from gaspart.engines.layout import (
    COLLAPSE,
    CROSSINGS,
    EDGES,
    EVENTS,
    FULL,
    INNER,
    NOTHING,
    STALE,
    STOP,
    WALLS,
)
from gaspart.engines.lists import move, sort_in
from gaspart.engines.search import find_contact
from gaspart.engines.surfaces import meet_edge
from gaspart.engines.walls import find_wall, meet_wall
from gaspart.fetch import fetch
from gaspart.kernel import inner_helper, kernel


@inner_helper
def plan_face(rows, plans, body, space, partition, now, gravity, walls, surfaces, big):
    """Note the next face or wall that the body comes to."""
    time, face = find_face(rows, plans, body, space, partition, now, gravity, surfaces, big)
    if walls is not None:
        time, face = find_wall(rows, plans, body, space, partition, gravity, walls, time, face)
    plans[body].face_time = time
    plans[body].face = face


@inner_helper
def foresee(rows, plans, body, space, partition, counters, now, turn, crossed, gravity, walls, surfaces, big):
    """Make a body's plans afresh; or, if it has just `crossed` (3,) into the next box, look about in the
    boxes that have become neighbours."""
    if crossed[0] == 0 and crossed[1] == 0 and crossed[2] == 0:
        plans[body].contact = inf
        plans[body].partner = NOTHING
    contact, partner = plans[body].contact, plans[body].partner
    find_contact(rows, plans, body, space, partition, counters, crossed, gravity)
    if big is not None:
        find_beside(rows, plans, body, space, partition, counters, gravity, big, crossed)
    if plans[body].contact != contact or plans[body].partner != partner:
        plans[body].foreseen = turn
    plan_face(rows, plans, body, space, partition, now, gravity, walls, surfaces, big)


@inner_helper
def note_all_still(rows, space, gravity, partition):
    """Note which bodies may not fall."""
    if gravity is not None:
        for body in range(len(rows)):
            note_still(rows, body, space, gravity, partition.still)


@kernel
def foresee_all(rows, plans, calendar, space, partition, counters, now, gravity, walls, surfaces, big):
    """Sort all bodies into their boxes, make all plans and fill the calendar."""
    sort_in(plans, partition)
    note_all_still(rows, space, gravity, partition)
    turn = calendar.cursor[TURN]
    anew = (0, 0, 0)
    for body in range(len(rows)):
        foresee(rows, plans, body, space, partition, counters, now, turn, anew, gravity, walls, surfaces, big)
    fill(calendar, plans, now)


@kernel
def refill(rows, plans, calendar, space, partition, now, gravity):
    """Rebuild lists and calendar from plans that are already made, as after a checkpoint."""
    sort_in(plans, partition)
    note_all_still(rows, space, gravity, partition)
    fill(calendar, plans, now)


@inner_helper
def note(record, time, rows, i, j, lengths, law):
    """Write an event down; j is the partner, or -1 - face for a wall."""
    d = len(lengths)
    n = record.filled[0]
    record.time[n] = time
    record.bodies[n, 0] = i
    record.bodies[n, 1] = j
    for k in range(d):
        record.positions[n, 0, k] = rows[i, k]
        record.velocities[n, 0, k] = rows[i, d + k]
        record.positions[n, 1, k] = rows[j, k] if j >= 0 else np.nan
        record.velocities[n, 1, k] = rows[j, d + k] if j >= 0 else np.nan
    if law is not None:
        for k in range(3):
            record.spins[n, 0, k] = law.spins[i, k]
            record.spins[n, 1, k] = law.spins[j, k] if j >= 0 else np.nan
    record.filled[0] = n + 1


@kernel
def run_boxes(
    rows,
    images,
    plans,
    calendar,
    space,
    partition,
    masses,
    counters,
    record,
    stop,
    most,
    gravity,
    law,
    watch,
    walls,
    surfaces,
    big,
):
    """Process all events up to time `stop`, at most `most` of them (collisions and wall hits).

    masses: (N,), or None if all are 1; record, gravity, law, watch, walls, surfaces, big: a Record, Gravity,
    Law, Watch, Walls, Surfaces and Big, or None each. Returns (reason, number of events, time of the last).
    """
    done = 0
    last = -inf
    seen = -1
    while True:
        if done >= most:
            return EVENTS, done, last
        if record is not None:
            if record.filled[0] == len(record.time):
                return FULL, done, last
        body = soonest(calendar, plans)
        if body < 0:
            return STOP, done, last
        if len(rows) > CACHED:
            seen = look_ahead(rows, plans, calendar, partition, seen)
        time = time_of(plans, body)
        if not time <= stop:
            return STOP, done, last
        face = plans[body].face
        partner = plans[body].partner
        meets_face = plans[body].face_time <= plans[body].contact
        turn = next_turn(calendar)
        happens = changes = True
        first, second = body, NOTHING  # whose plans are to be made anew
        x = y = z = 0
        if meets_face and INNER <= face < EDGES:
            happens = changes = False
            axis = (face - INNER) // 2
            step = 1 if face % 2 else -1
            x, y, z = step if axis == 0 else 0, step if axis == 1 else 0, step if axis == 2 else 0
            move(plans, partition, body, axis, plans[body].at[axis] + step)
            counters.counts[CROSSINGS] += 1
        elif meets_face:
            partner = -1 - face
            if face >= WALLS:
                if walls is not None:
                    m = face - WALLS
                    wall = meet_wall(rows, body, m, time, space, masses, counters, gravity, law, walls)
                    happens = wall != NOTHING
                    partner = -1 - wall
            elif face >= EDGES:
                if surfaces is not None:
                    m = face - EDGES
                    partner = -1 - meet_edge(
                        rows, body, m, time, space, masses, counters, gravity, law, surfaces
                    )
            elif not meet_face(
                rows, images, body, face, time, space, masses, counters, gravity, law, surfaces
            ):
                happens = False
                axis = face // 2
                move(plans, partition, body, axis, 0 if face % 2 else partition.per_side[axis] - 1)
        elif is_stale(plans, body):
            happens = changes = False
            counters.counts[STALE] += 1
        else:
            body, partner = min(body, partner), max(body, partner)
            first, second = body, partner
            collide(rows, body, partner, time, space, masses, counters, gravity, law)
        if gravity is not None:
            note_still(rows, first, space, gravity, partition.still)
            if second >= 0:
                note_still(rows, second, space, gravity, partition.still)
        searcher = first
        while searcher >= 0:
            if changes:
                plans[searcher].changed = turn
            foresee(
                rows, plans, searcher, space, partition, counters, time, turn, (x, y, z), gravity, walls,
                surfaces, big,
            )  # fmt: skip
            fetch(calendar.head, slot_of(calendar, plans, searcher))
            searcher = second if searcher == first else NOTHING
        reschedule(calendar, plans, first)
        if second >= 0:
            reschedule(calendar, plans, second)
        if not happens:
            continue
        last = time
        done += 1
        if record is not None:
            note(record, time, rows, body, partner, space.lengths, law)
        if watch is not None:
            faces = 2 * len(space.lengths)
            if partner >= 0 or partner < -faces:
                if crowded(watch, body, time) or (partner >= 0 and crowded(watch, partner, time)):
                    return COLLAPSE, done, last
