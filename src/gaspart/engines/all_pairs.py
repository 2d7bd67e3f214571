"""The first algorithm of Spencer 2021, section 3.1: look at all pairs before every event. The referee."""

from math import inf

import numpy as np

from gaspart.engines.event_kernels import note
from gaspart.engines.faces import find_face, meet_face
from gaspart.engines.flight import pair_time
from gaspart.engines.impact import collide, crowded
from gaspart.engines.layout import COLLAPSE, EDGES, EVENTS, FULL, NOTHING, PAIR_TESTS, STOP, WALLS
from gaspart.engines.surfaces import meet_edge
from gaspart.engines.walls import find_wall, meet_wall
from gaspart.kernel import allocating_kernel


@allocating_kernel
def run_pairs(
    rows,
    images,
    plans,
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
):
    """What `run_boxes` does, with the same arguments and answers but for the calendar and big bodies.

    `partition` has one box and the plans are not used, so nothing can be out of date: the referee of
    `run_boxes`.
    """
    d = len(space.lengths)
    count = len(rows)
    images_of_pair = 3**d
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
            time, code = find_face(rows, plans, i, space, partition, -inf, gravity, surfaces, None)
            if walls is not None:
                time, code = find_wall(rows, plans, i, space, partition, gravity, walls, time, code)
            if time < soon:
                soon, first, face = time, i, code
        for i in range(count):
            for j in range(i + 1, count):
                for image in range(images_of_pair):
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
                    time = pair_time(rows, i, j, offset, space, gravity)
                    if time < soon:
                        soon, first, second = time, i, j
        if not soon <= stop or first == NOTHING:
            return STOP, done, last
        if second != NOTHING:
            collide(rows, first, second, soon, space, masses, counters, gravity, law)
        else:
            second = -1 - face
            if face >= WALLS:
                if walls is not None:
                    m = face - WALLS
                    wall = meet_wall(rows, first, m, soon, space, masses, counters, gravity, law, walls)
                    if wall == NOTHING:
                        continue
                    second = -1 - wall
            elif face >= EDGES:
                if surfaces is not None:
                    m = face - EDGES
                    second = -1 - meet_edge(
                        rows, first, m, soon, space, masses, counters, gravity, law, surfaces
                    )
            elif not meet_face(
                rows, images, first, face, soon, space, masses, counters, gravity, law, surfaces
            ):
                continue
        last = soon
        done += 1
        if record is not None:
            note(record, soon, rows, first, second, space.lengths, law)
        if watch is not None:
            if second >= 0 or second < -2 * d:
                if crowded(watch, first, soon) or (second >= 0 and crowded(watch, second, soon)):
                    return COLLAPSE, done, last
