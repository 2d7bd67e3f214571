"""The parts of a step that threads share: the motion, and the search of a list and for it.

With `threads` None there is one thread, and machine code in which others do not exist. Each part writes to
rows of its own, and which contacts are found does not depend on who finds them.
"""

import numpy as np
from numba import prange

from gaspart.engines.step_cells import Places, begin_cells, count_part, place_part, tidy
from gaspart.engines.step_layout import PAIR_TESTS, REBUILDS, SPENT, Found, Space, share
from gaspart.engines.step_list import list_part, search_pairs, search_stirred
from gaspart.engines.step_motion import move, note_fastest
from gaspart.kernel import allocating_kernel, helper, parallel_kernel

_BLOCK = 256  # pairs that are tested before those that touch are looked at
_TIDY = 8  # every so many lists the bodies are sorted in memory


@allocating_kernel
def room_for(threads, room, like):
    """Empty arrays for contacts to resolve."""
    return Found(
        np.empty((threads, room, 2), np.uint32),
        np.empty((threads, room), like.dtype),
        np.zeros(threads, np.int64),
        np.zeros(threads, np.int64),
        np.empty((threads, _BLOCK), np.uint32),
    )


@helper
def numbers_of(space):
    """What a space is made of beside its tuples: numba passes no tuples in tuples to threads."""
    return space.margin, space.normal, space.push


@helper
def space_of(lengths, periodic, numbers):
    """The space that these are parts of."""
    return Space(lengths, periodic, numbers[0], numbers[1], numbers[2])


@parallel_kernel
def move_shared(bodies, lengths, periodic, numbers, gravity, inset, dt, counters, threads):
    """`move` for all slots."""
    count = bodies.positions.shape[1]
    for part in prange(threads):
        low, high = share(part, threads, count), share(part + 1, threads, count)
        space = space_of(lengths, periodic, numbers)
        move(bodies, space, gravity, inset, dt, low, high, counters, part)


@parallel_kernel
def count_shared(bodies, lengths, periodic, numbers, cells, cell, edge):
    """`count_part` for all parts."""
    for part in prange(len(cells.ends)):
        count_part(bodies, space_of(lengths, periodic, numbers), cells, cell, edge, part)


@parallel_kernel
def place_shared(bodies, lengths, periodic, numbers, cells, places):
    """`place_part` for all parts."""
    for part in prange(len(cells.ends)):
        place_part(bodies, space_of(lengths, periodic, numbers), cells, places, part)


@parallel_kernel
def list_shared(bodies, cells, places, pairs, tests):
    """`list_part` for all parts."""
    for part in prange(len(pairs)):
        list_part(bodies, cells, places, part, pairs, tests)


@helper
def search_part(bodies, space, cells, pairs, watch, before, dt, parting, found, part):
    """Search one thread's list: all of it, or, with a turn `before`, what was stirred then."""
    listed = pairs[part, : cells.listed[part]]
    if before < 0:
        search_pairs(bodies, space, listed, dt, parting, found, part)
    else:
        search_stirred(bodies, space, listed, watch, before, dt, parting, found, part)


@parallel_kernel
def search_shared(bodies, lengths, periodic, numbers, cells, pairs, watch, before, dt, parting, found):
    """`search_part` for the whole list."""
    for part in prange(len(pairs)):
        space = space_of(lengths, periodic, numbers)
        search_part(bodies, space, cells, pairs, watch, before, dt, parting, found, part)


@allocating_kernel
def search_list(bodies, space, cells, pairs, watch, before, dt, parting, found, threads):
    """Search the whole list."""
    if threads is None:
        search_part(bodies, space, cells, pairs, watch, before, dt, parting, found, 0)
    else:
        apart = space.lengths, space.periodic, numbers_of(space)
        search_shared(bodies, *apart, cells, pairs, watch, before, dt, parting, found)


@allocating_kernel
def settle(bodies, space, cells, threads):
    """Give all ordinary bodies and their ghosts their places."""
    count = bodies.ordinary
    cell, place = np.empty(count, np.uint32), np.empty(count, np.uint32)
    edge = np.empty(count, np.uint8)
    if threads is None:
        count_part(bodies, space, cells, cell, edge, 0)
    else:
        count_shared(bodies, space.lengths, space.periodic, numbers_of(space), cells, cell, edge)
    total = begin_cells(cells.ends)
    spots, own = np.empty((total, 4), cells.origin.dtype), np.empty((count, 4), cells.origin.dtype)
    places = Places(spots, np.empty(total, np.uint32), own, cell, place, edge)
    if threads is None:
        place_part(bodies, space, cells, places, 0)
    else:
        place_shared(bodies, space.lengths, space.periodic, numbers_of(space), cells, places)
    return places


@allocating_kernel
def make_list(bodies, space, cells, pairs, watch, counters, threads):
    """Make the list anew: its pairs (threads, room, 2), in the old room or in more."""
    places = settle(bodies, space, cells, threads)
    if counters.counts[REBUILDS] % _TIDY == 0:
        tidy(bodies, places, watch)
        places = settle(bodies, space, cells, threads)
    tests = np.zeros(len(pairs), np.int64)
    while True:
        if threads is None:
            list_part(bodies, cells, places, 0, pairs, tests)
        else:
            list_shared(bodies, cells, places, pairs, tests)
        if cells.listed.min() >= 0:
            break
        room = max(pairs.shape[1] * 3 // 2, bodies.ordinary // len(pairs)) + 8192
        pairs = np.empty((len(pairs), room, 2), np.uint32)
    cells.origin[:] = bodies.positions
    note_fastest(bodies, watch)
    watch.reach[SPENT] = 0.0
    counters.counts[REBUILDS] += 1
    counters.counts[PAIR_TESTS] += tests.sum()
    return pairs


@allocating_kernel
def gathered(found):
    """What the threads have found: pairs (n, 2) and times (n,)."""
    number = found.number.sum()
    pairs = np.empty((number, 2), np.uint32)
    times = np.empty(number, found.times.dtype)
    start = 0
    for part in range(len(found.number)):
        stop = start + found.number[part]
        pairs[start:stop] = found.pairs[part, : found.number[part]]
        times[start:stop] = found.times[part, : found.number[part]]
        start = stop
    return pairs, times
