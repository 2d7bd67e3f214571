"""The parts of a step that threads share: the motion, and the search of a list and for it.

With `threads` None there is one thread, and machine code in which others do not exist. Each part writes to
rows of its own, and which contacts are found does not depend on who finds them.
"""

import numpy as np
from numba import prange

from gaspart.kernels.compilation import allocating_kernel, helper, kernel, parallel_kernel
from gaspart.kernels.step.cells import begin_cells, copy, count_part, find_part, mirror, order_part, take
from gaspart.kernels.step.model import PAIR_TESTS, REBUILDS, SPENT, Found, Space, share
from gaspart.kernels.step.motion import move, note_fastest
from gaspart.kernels.step.neighbour_list import list_part, search_pairs
from gaspart.kernels.step.simd import WIDTH

_BLOCK = 1024  # pairs that are tested before those that touch are looked at


@allocating_kernel
def room_for(threads, room, like):
    """Empty arrays for contacts to resolve."""
    return Found(
        np.empty((threads, room, 2), np.uint32),
        np.empty((threads, room), like.dtype),
        np.zeros(threads, np.int64),
        np.zeros(threads, np.int64),
        np.empty((threads, _BLOCK), np.uint64),
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
def find_shared(bodies, cells):
    """`find_part` for all parts."""
    for part in prange(len(cells.ends)):
        find_part(bodies, cells, part)


@parallel_kernel
def count_shared(bodies, cells):
    """`find_part` and `count_part` for all parts."""
    for part in prange(len(cells.ends)):
        find_part(bodies, cells, part)
        count_part(bodies, cells, part)


@parallel_kernel
def order_shared(bodies, cells):
    """`order_part` for all parts."""
    for part in prange(len(cells.ends)):
        order_part(bodies, cells, part)


@parallel_kernel
def take_shared(values, order, taken, threads):
    """`take` for all slots."""
    for part in prange(threads):
        take(values, order, share(part, threads, len(order)), share(part + 1, threads, len(order)), taken)


@parallel_kernel
def copy_shared(taken, values, threads):
    """`copy` for all slots."""
    for part in prange(threads):
        copy(taken, share(part, threads, len(taken)), share(part + 1, threads, len(taken)), values)


@parallel_kernel
def list_shared(bodies, lengths, periodic, numbers, cells, pairs, tests):
    """`list_part` for all parts."""
    for part in prange(len(pairs)):
        list_part(bodies, space_of(lengths, periodic, numbers), cells, part, pairs, tests)


@helper
def search_part(bodies, space, cells, pairs, watch, before, dt, parting, found, part):
    """Search one thread's list: all of it or, with a turn `before`, what was stirred then."""
    listed = pairs[part, : cells.listed[part]]
    search_pairs(bodies, space, listed, watch.met, before, dt, parting, found, part)


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


@kernel
def arrange(values, order, room, threads):
    """values[n] becomes values[order[n]], by way of `room`; what lies beyond the order stays."""
    taken = room[: len(order)]
    if threads is None:
        take(values, order, 0, len(order), taken)
        copy(taken, 0, len(order), values)
    else:
        take_shared(values, order, taken, threads)
        copy_shared(taken, values, threads)


@kernel
def settle(bodies, cells, watch, threads):
    """Bring the ordinary bodies into the order of their cells."""
    if threads is None:
        find_part(bodies, cells, 0)
        count_part(bodies, cells, 0)
    else:
        count_shared(bodies, cells)
    begin_cells(cells.ends)
    if threads is None:
        order_part(bodies, cells, 0)
    else:
        order_shared(bodies, cells)
    mirror(cells)
    arrange(bodies.radii, cells.order, cells.origin[0], threads)
    for k in range(len(bodies.positions)):
        arrange(bodies.velocities[k], cells.order, cells.origin[k], threads)
        arrange(bodies.positions[k], cells.order, cells.origin[k], threads)
    arrange(bodies.index, cells.order, cells.cell, threads)
    arrange(watch.met, cells.order, cells.cell, threads)
    if threads is None:
        find_part(bodies, cells, 0)
    else:
        find_shared(bodies, cells)


@allocating_kernel
def make_list(bodies, space, cells, pairs, watch, counters, threads):
    """Make the list anew: its pairs (threads, room), in the old room or in more."""
    settle(bodies, cells, watch, threads)
    tests = np.zeros(len(pairs), np.int64)
    while True:
        if threads is None:
            list_part(bodies, space, cells, 0, pairs, tests)
        else:
            apart = space.lengths, space.periodic, numbers_of(space)
            list_shared(bodies, *apart, cells, pairs, tests)
        if cells.listed.max() + WIDTH <= pairs.shape[1]:
            break
        pairs = np.empty((len(pairs), cells.listed.max() * 5 // 4 + WIDTH), np.uint64)
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
