"""Parts of a step that threads share: the motion, and making and searching a neighbour list.

If `threads` equals None, there is one thread, and the machine code contains no threading. Each part writes to
its
own rows, and the set of contacts does not depend on which thread finds them. numba does not pass nested
tuples to threads, so a `StepModel` or a `Space` is passed in parts and reassembled.
"""

import numpy as np
from numba import prange

from gaspart.kernels.compile.policy import (
    inner_allocating_kernel,
    inner_helper,
    inner_kernel,
    inner_parallel_kernel,
)
from gaspart.kernels.model import Space
from gaspart.kernels.step.model import (
    DISPLACEMENT,
    FASTEST,
    PAIR_TESTS,
    REBUILDS,
    Overlaps,
    StepModel,
    copy,
    copy_periodic_rows,
    divide_cells,
    locate_part,
    order_part,
    part_of,
    permute,
)
from gaspart.kernels.step.motion import displacement_part, fastest_part, move, move_by_rules
from gaspart.kernels.step.neighbour_list import WIDTH, is_complete, list_part, search_pairs

_BLOCK = 1024  # number of pairs that are tested before the touching pairs are examined


@inner_allocating_kernel
def room_for(threads, room, like):
    """Return empty arrays for contacts to resolve."""
    return Overlaps(
        np.empty((threads, room, 2), np.uint32),
        np.empty((threads, room), like.dtype),
        np.zeros(threads, np.int64),
        np.zeros(threads, np.int64),
        np.empty((threads, _BLOCK), np.uint64),
    )


@inner_parallel_kernel
def move_shared(particles, lengths, periodic, numbers, dt, tally, threads, gravity):
    """Perform `move` for all slots. `numbers`: numbers of the model, and the margin of its space."""
    count = particles.positions.shape[1]
    for part in prange(threads):
        normal, impulse_share, inset, margin = numbers
        space = Space(lengths, periodic, margin)
        model = StepModel(space, normal, impulse_share, inset, gravity, None, None)
        move(particles, part_of(part, threads, count), model, dt, tally, part, gravity)


@inner_helper
def move_all(particles, model, dt, tally, threads, rules, cells):
    """Perform the motion of one step."""
    gravity, space = model.gravity, model.space
    if rules is not None:
        move_by_rules(particles, model, dt, tally, rules, model.law, cells, gravity)
    elif threads is None:
        move(particles, (0, particles.positions.shape[1]), model, dt, tally, 0, gravity)
    else:
        numbers = model.normal, model.impulse_share, model.inset, space.margin
        move_shared(particles, space.lengths, space.periodic, numbers, dt, tally, threads, gravity)


@inner_parallel_kernel
def locate_shared(particles, cells):
    """Perform `locate_part` for all parts."""
    for part in prange(len(cells.listed)):
        locate_part(particles, part, cells)


@inner_parallel_kernel
def order_shared(cells, ordinary, shares):
    """Perform `order_part` for all shares (threads + 1,) of the cells."""
    for part in prange(len(cells.listed)):
        order_part(cells, ordinary, shares[part], shares[part + 1])


@inner_parallel_kernel
def permute_shared(values, order, permuted, threads):
    """Perform `permute` for all slots."""
    for part in prange(threads):
        permute(values, order, part_of(part, threads, len(order)), permuted)


@inner_parallel_kernel
def copy_shared(permuted, values, threads):
    """Perform `copy` for all slots."""
    for part in prange(threads):
        copy(permuted, part_of(part, threads, len(permuted)), values)


@inner_parallel_kernel
def list_shared(particles, cells, pairs, lengths, periodic, margin, tests):
    """Perform `list_part` for all parts."""
    for part in prange(len(pairs)):
        list_part(particles, part, cells, pairs, Space(lengths, periodic, margin), tests)


@inner_helper
def search_part(particles, cells, pairs, space, step, overlaps, part):
    """Search one thread's list; see `search_pairs`."""
    search_pairs(particles, pairs[part, : cells.listed[part]], space, step, overlaps, part)


@inner_parallel_kernel
def search_shared(particles, cells, pairs, lengths, periodic, margin, step, overlaps):
    """Perform `search_part` for the whole list."""
    for part in prange(len(pairs)):
        search_part(particles, cells, pairs, Space(lengths, periodic, margin), step, overlaps, part)


@inner_allocating_kernel
def search_list(particles, pairs, space, step, overlaps, threads, cells):
    """Search the whole list, if there is one."""
    if cells is not None:
        if threads is None:
            search_part(particles, cells, pairs, space, step, overlaps, 0)
        else:
            search_shared(
                particles, cells, pairs, space.lengths, space.periodic, space.margin, step, overlaps
            )


@inner_kernel
def reorder(values, order, room, threads):
    """Set values[n] to values[order[n]], with `room` as workspace; later values are unchanged."""
    permuted = room[: len(order)]
    if threads is None:
        permute(values, order, (0, len(order)), permuted)
        copy(permuted, (0, len(order)), values)
    else:
        permute_shared(values, order, permuted, threads)
        copy_shared(permuted, values, threads)


@inner_allocating_kernel
def sort_into_cells(particles, cells, threads):
    """Sort the ordinary particles in memory by their cells."""
    shares = np.empty(len(cells.listed) + 1, np.uint32)
    divide_cells(cells, particles.ordinary, shares)
    if threads is None:
        locate_part(particles, 0, cells)
        order_part(cells, particles.ordinary, shares[0], shares[1])
    else:
        locate_shared(particles, cells)
        order_shared(cells, particles.ordinary, shares)
    copy_periodic_rows(cells)
    reorder(particles.radii, cells.order, cells.origin[0], threads)
    for k in range(len(particles.positions)):
        reorder(particles.velocities[k], cells.order, cells.origin[k], threads)
        reorder(particles.positions[k], cells.order, cells.origin[k], threads)
    reorder(particles.index, cells.order, cells.cell, threads)
    reorder(particles.last_pass, cells.order, cells.cell, threads)
    if threads is None:
        locate_part(particles, 0, cells)
    else:
        locate_shared(particles, cells)


@inner_parallel_kernel
def fastest_shared(particles, squares):
    """Perform `fastest_part` for all parts, into squares (threads,)."""
    for part in prange(len(squares)):
        slots = part_of(part, len(squares), particles.velocities.shape[1])
        squares[part] = fastest_part(particles, slots)


@inner_parallel_kernel
def displacement_shared(particles, cells, lengths, periodic, margin, squares):
    """Perform `displacement_part` for all parts, into squares (threads,)."""
    for part in prange(len(squares)):
        slots = part_of(part, len(squares), particles.ordinary)
        squares[part] = displacement_part(particles, slots, cells, Space(lengths, periodic, margin))


@inner_allocating_kernel
def measure_fastest(particles, threads):
    """Measure the highest speed of any particle."""
    if threads is None:
        square = fastest_part(particles, (0, particles.velocities.shape[1]))
    else:
        squares = np.empty(threads, particles.velocities.dtype)
        fastest_shared(particles, squares)
        square = squares.max()
    particles.bounds[FASTEST] = np.sqrt(square)


@inner_allocating_kernel
def measure_displacement(particles, cells, space, threads):
    """Measure the largest displacement of an ordinary particle since the list was made."""
    if threads is None:
        square = displacement_part(particles, (0, particles.ordinary), cells, space)
    else:
        squares = np.empty(threads, particles.positions.dtype)
        displacement_shared(particles, cells, space.lengths, space.periodic, space.margin, squares)
        square = squares.max()
    particles.bounds[DISPLACEMENT] = np.sqrt(square)


@inner_allocating_kernel
def is_outdated(particles, cells, space, threads):
    """Return True if the list must be renewed: by the fastest particle's bound, else by displacements."""
    if is_complete(particles, cells):
        return False
    if particles.bounds[DISPLACEMENT] < np.inf:
        measure_displacement(particles, cells, space, threads)
    return not is_complete(particles, cells)


@inner_allocating_kernel
def make_list(particles, cells, pairs, space, tally, threads):
    """Remake the neighbour list; return its pairs (threads, room) in the same or a larger array."""
    sort_into_cells(particles, cells, threads)
    tests = np.zeros(len(pairs), np.int64)
    while True:
        if threads is None:
            list_part(particles, 0, cells, pairs, space, tests)
        else:
            list_shared(particles, cells, pairs, space.lengths, space.periodic, space.margin, tests)
        if cells.listed.max() + WIDTH <= pairs.shape[1]:
            break
        pairs = np.empty((len(pairs), cells.listed.max() * 5 // 4 + WIDTH), np.uint64)
    measure_fastest(particles, threads)
    particles.bounds[DISPLACEMENT] = 0.0
    tally.counts[REBUILDS] += 1
    tally.counts[PAIR_TESTS] += tests.sum()
    return pairs


@inner_allocating_kernel
def gather_overlaps(overlaps):
    """Collect the pairs (n, 2) and times (n,) that the threads have found."""
    number = overlaps.number.sum()
    pairs = np.empty((number, 2), np.uint32)
    times = np.empty(number, overlaps.times.dtype)
    n = 0
    for part in range(len(overlaps.number)):
        for k in range(overlaps.number[part]):
            pairs[n, 0], pairs[n, 1] = overlaps.pairs[part, k, 0], overlaps.pairs[part, k, 1]
            times[n] = overlaps.times[part, k]
            n += 1
    return pairs, times
