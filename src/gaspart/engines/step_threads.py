"""The parts of a step that threads share: the motion, and the search of a list and for it.

With `threads` None there is one thread, and machine code in which others do not exist. Each part writes to
rows of its own, and which contacts are found does not depend on who finds them.
"""

import numpy as np
from numba import prange

from gaspart.engines.step_layout import PAIR_TESTS, PENDING, REBUILDS, SPENT, STRAYED, Found, Space, share
from gaspart.engines.step_list import list_pairs, search_pairs, sort_by_cell
from gaspart.engines.step_motion import move, note_fastest
from gaspart.kernel import allocating_kernel, parallel_kernel


@allocating_kernel
def room_for(threads, room, like):
    """Empty arrays for contacts to resolve."""
    return Found(
        np.empty((threads, room, 2), np.int32),
        np.empty((threads, room), like.dtype),
        np.zeros(threads, np.int64),
    )


@parallel_kernel
def move_shared(bodies, lengths, periodic, margin, gravity, inset, dt, counters, threads):
    """`move` for all slots. The space comes in parts, for numba passes no tuples in tuples to threads."""
    count = bodies.positions.shape[1]
    for part in prange(threads):
        low, high = share(part, threads, count), share(part + 1, threads, count)
        space = Space(lengths, periodic, margin)
        move(bodies, space, gravity, inset, dt, low, high, counters, part)


@parallel_kernel
def list_shared(bodies, cells, arranged, pairs, done):
    """`list_pairs` for all parts."""
    for part in prange(len(pairs)):
        list_pairs(bodies, cells, arranged, part, pairs, done)


@parallel_kernel
def search_shared(bodies, lengths, periodic, margin, pairs, dt, parting, found):
    """`search_pairs` for the whole list."""
    parts = len(found.number)
    for part in prange(parts):
        low, high = share(part, parts, len(pairs)), share(part + 1, parts, len(pairs))
        space = Space(lengths, periodic, margin)
        search_pairs(bodies, space, pairs, low, high, dt, parting, found, part)


@allocating_kernel
def make_list(bodies, space, cells, watch, counters, threads):
    """Make the list anew: its pairs (n, 2)."""
    arranged = sort_by_cell(bodies, space, cells)
    parts = 1 if threads is None else threads
    room = bodies.ordinary // parts + 64
    done = np.empty((parts, 2), np.int64)
    pairs = np.empty((parts, room, 2), np.int32)
    while True:
        if threads is None:
            list_pairs(bodies, cells, arranged, 0, pairs, done)
        else:
            list_shared(bodies, cells, arranged, pairs, done)
        if done[:, 0].min() >= 0:
            break
        room *= 2
        pairs = np.empty((parts, room, 2), np.int32)
    note_fastest(bodies, watch)
    watch.reach[SPENT] = watch.reach[STRAYED] = watch.reach[PENDING] = 0.0
    counters.counts[REBUILDS] += 1
    counters.counts[PAIR_TESTS] += done[:, 1].sum()
    whole = np.empty((done[:, 0].sum(), 2), np.int32)
    start = 0
    for part in range(parts):
        number = done[part, 0]
        whole[start : start + number] = pairs[part, :number]
        start += number
    return whole


@allocating_kernel
def gathered(found):
    """What the threads have found: pairs (n, 2) and times (n,)."""
    number = found.number.sum()
    pairs = np.empty((number, 2), np.int32)
    times = np.empty(number, found.times.dtype)
    start = 0
    for part in range(len(found.number)):
        stop = start + found.number[part]
        pairs[start:stop] = found.pairs[part, : found.number[part]]
        times[start:stop] = found.times[part, : found.number[part]]
        start = stop
    return pairs, times
