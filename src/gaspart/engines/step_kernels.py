"""One small step after another: the canonical step of the time-stepped engine.

A step moves all bodies, reflects those that left through a wall, finds all pairs that overlap and approach,
and resolves them in the order of their contact time and indices, testing each again; further passes look for
what the first has left or made. Which search finds the pairs changes no bit of the result. All arithmetic
keeps the precision of the positions (float32 or float64): hence dt - dt for 0 and x + x for 2x.
"""

import numpy as np

from gaspart.engines.step_boxes import search_all, search_boxes, sort_in
from gaspart.engines.step_contacts import count_left, in_order, resolve_all
from gaspart.engines.step_layout import FASTEST, PAIR_TESTS, PENDING, SPENT, STRAYED, Found
from gaspart.engines.step_list import is_stale, make_list, search_pairs
from gaspart.engines.step_motion import move
from gaspart.kernel import allocating_kernel


@allocating_kernel
def room_for(threads, room, like):
    """Empty arrays for contacts to resolve."""
    return Found(
        np.empty((threads, room, 2), np.int32),
        np.empty((threads, room), like.dtype),
        np.zeros(threads, np.int64),
    )


@allocating_kernel
def run_steps(
    bodies,
    space,
    partition,
    cells,
    pairs,
    gravity,
    inset,
    dt,
    steps,
    rewind,
    passes,
    parting,
    watch,
    counters,
):
    """Make `steps` steps of length `dt`. partition: the boxes to search, or cells: those of a list; the
    other is None. gravity: (d,) or None; inset: the largest radius that a wall stops."""
    count = bodies.positions.shape[1]
    found = room_for(1, count + 16, bodies.positions)
    listed = len(pairs[0])
    watch.met[:] = -1
    pull = 0.0
    if gravity is not None:
        for component in gravity:
            pull += abs(component)
    for step in range(steps):
        watch.reach[FASTEST] += pull * dt
        watch.reach[PENDING] = 1.0
        move(bodies, space, gravity, inset, dt, 0, count, counters, 0)
        for _ in range(passes):
            if cells is not None:
                if is_stale(cells, watch, dt):
                    pairs, listed = make_list(bodies, space, cells, pairs, watch, counters)
            if partition is not None:
                sort_in(bodies, partition)
            while True:
                found.number[0] = 0
                if cells is not None:
                    search_pairs(bodies, space, pairs, 0, listed, dt, parting, found, 0)
                    counters.counts[PAIR_TESTS] += listed
                if partition is not None:
                    search_boxes(bodies, space, partition, dt, parting, found, counters)
                for slot in range(bodies.ordinary, count):
                    counters.counts[PAIR_TESTS] += search_all(bodies, space, slot, dt, parting, found, 0)
                if found.number[0] <= found.times.shape[1]:
                    break
                found = room_for(1, 2 * found.number[0], bodies.positions)
            number = found.number[0]
            if number == 0:
                break
            order = in_order(bodies.index, found.pairs[0, :number], found.times[0, :number])
            resolve_all(bodies, space, found, order, dt, step, rewind, parting, watch, counters)
        if found.number[0] > 0:
            count_left(bodies, space, found, counters)
        watch.reach[SPENT] += watch.reach[PENDING] * watch.reach[FASTEST] * dt + watch.reach[STRAYED]
        watch.reach[STRAYED] = 0.0
    return pairs[0][:listed], pairs[1][:listed]
