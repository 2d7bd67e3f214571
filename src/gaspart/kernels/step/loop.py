"""One small step after another: the canonical step of the time-stepped engine.

A step moves all bodies, reflects those that left through a wall, finds all pairs that overlap and approach,
and resolves them in the order of their contact time and indices, testing each again; further passes look for
what the first has left or made. Which search finds the pairs changes no bit of the result. All arithmetic
keeps the precision of the positions (float32 or float64): hence dt - dt for 0 and x + x for 2x.
"""

from gaspart.kernels.compilation import allocating_kernel
from gaspart.kernels.step.box_search import search_all, search_boxes, sort_in
from gaspart.kernels.step.model import FASTEST, PAIR_TESTS, SPENT, Turn
from gaspart.kernels.step.motion import move, move_by_rules
from gaspart.kernels.step.neighbour_list import is_stale
from gaspart.kernels.step.resolve import count_left, in_order, resolve_all
from gaspart.kernels.step.threads import gathered, make_list, move_shared, numbers_of, room_for, search_list


@allocating_kernel
def run_steps(
    bodies, space, partition, cells, pairs, gravity, inset, rules, law, dt, steps, rewind, passes, watch,
    counters, threads,
):  # fmt: skip
    """Make `steps` steps of length `dt`.

    partition: the boxes to search, or cells: those of a list; the other is None. pairs (threads, room):
    the list as it stands. gravity: (d,) or None; inset: the largest radius that a wall stops; rules, law: of
    faces and contacts that know more than momenta (see `step_rules`), or None; threads: their number, or None
    for one. Returns the list as it stands then.
    """
    count = bodies.positions.shape[1]
    parts = 1 if threads is None else threads
    found = room_for(parts, count // parts + 16, bodies.positions)
    parting = passes > 1
    watch.met[:] = 0
    pull = 0.0
    if gravity is not None:
        for component in gravity:
            pull += abs(component)
    for step in range(steps):
        watch.reach[FASTEST] += pull * dt
        watch.reach[SPENT] += watch.reach[FASTEST] * dt
        if rules is not None:
            move_by_rules(bodies, space, gravity, dt, rules, law, cells, watch, counters)
        elif threads is None:
            move(bodies, space, gravity, inset, dt, 0, count, counters, 0)
        else:
            apart = space.lengths, space.periodic, numbers_of(space)
            move_shared(bodies, *apart, gravity, inset, dt, counters, threads)
        number, before = 0, 0
        for again in range(passes):
            turn = Turn(step * passes + again + 1, step * passes + 1)
            if cells is not None:
                if is_stale(bodies, space, cells, watch):
                    pairs = make_list(bodies, space, cells, pairs, watch, counters, threads)
                    before = 0
            if partition is not None:
                sort_in(bodies, partition)
            while True:
                found.number[:] = 0
                found.tests[:] = 0
                if cells is not None:
                    search_list(bodies, space, cells, pairs, watch, before, dt, parting, found, threads)
                if partition is not None:
                    search_boxes(bodies, space, partition, dt, parting, found, counters)
                for slot in range(bodies.ordinary, count):
                    found.tests[0] += search_all(bodies, space, slot, dt, parting, found, 0)
                if found.number.max() <= found.times.shape[1]:
                    break
                found = room_for(parts, 2 * found.number.max(), bodies.positions)
            counters.counts[PAIR_TESTS] += found.tests.sum()
            number = found.number.sum()
            if number == 0:
                break
            contacts, times = gathered(found)
            order = in_order(bodies.index, contacts, times)
            resolve_all(
                bodies, space, contacts, order, dt, turn, rewind, parting, rules, law, cells, watch, counters
            )
            before = turn.now
        if number > 0:
            count_left(bodies, space, contacts, counters)
    return pairs
