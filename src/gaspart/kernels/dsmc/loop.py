"""Sequence of a step: motion, entries through open faces, sorting into cells, collisions. Half of the
collisions of a dense gas come before the motion.

The parts of a step that threads share are separate functions. If `threads` equals None, there is one thread,
and the machine code contains no threading. numba does not pass nested tuples to threads, so each thread makes
its own `ThreadContext`. The result for a particle does not depend on the thread that processes it.
"""

import numpy as np
from numba import prange

from gaspart.kernels.compile.policy import (
    allocating_kernel,
    inner_allocating_kernel,
    inner_helper,
    inner_parallel_kernel,
)
from gaspart.kernels.dsmc.boltzmann import add_flights, collide_cells
from gaspart.kernels.dsmc.cells import (
    count,
    find_starts,
    gather_numbers,
    gather_row,
    leave_out_absent,
    locate,
    put_in_order,
    share_cells,
    swap_row,
)
from gaspart.kernels.dsmc.enskog import collide_slab, find_bounds, find_near_speeds, look_at_cells
from gaspart.kernels.dsmc.entry import admit_all, first_free_slot
from gaspart.kernels.dsmc.model import ThreadContext, open_space, still_fits
from gaspart.kernels.dsmc.motion import move
from gaspart.kernels.model import Space
from gaspart.kernels.step.model import part_of


@inner_helper
def move_part(particles, grid, context, parts, gravity, faces, law):
    """Perform the motion of one step for one part of the slots."""
    slots = part_of(context.part, parts, particles.data.shape[1])
    move(particles, slots, grid, context, gravity, faces, law)


@inner_parallel_kernel
def move_shared(particles, grid, workspace, lengths, periodic, gravity, faces, law):
    """Perform `move_part` for all parts."""
    parts = len(grid.counts)
    for part in prange(parts):
        context = ThreadContext(Space(lengths, periodic, workspace.margin), workspace, part)
        move_part(particles, grid, context, parts, gravity, faces, law)


@inner_parallel_kernel
def order_shared(particles, grid):
    """Perform `put_in_order` for all parts."""
    parts = len(grid.counts)
    for part in prange(parts):
        slots = part_of(part, parts, particles.data.shape[1])
        put_in_order(slots[0], slots[1], part, grid)


@inner_parallel_kernel
def gather_shared(particles, row, grid):
    """Perform `gather_row`, or for row -1 `gather_numbers`, for all parts."""
    parts = len(grid.counts)
    for part in prange(parts):
        slots = part_of(part, parts, particles.data.shape[1])
        if row < 0:
            gather_numbers(particles, slots[0], slots[1], grid)
        else:
            gather_row(particles, row, slots[0], slots[1], grid)


@inner_helper
def collide_part(particles, cells, grid, context, law, stress):
    """Perform the collisions of one step in the cells of one thread, cells[0] to cells[1]."""
    if stress is not None:
        add_flights(particles, cells, grid, context, stress, law)
    collide_cells(particles, cells, grid, context, law, stress)


@inner_parallel_kernel
def collide_shared(particles, shares, grid, workspace, lengths, periodic, law, stress):
    """Perform `collide_part` for all parts."""
    for part in prange(len(shares) - 1):
        context = ThreadContext(Space(lengths, periodic, workspace.margin), workspace, part)
        collide_part(particles, (shares[part], shares[part + 1]), grid, context, law, stress)


@inner_helper
def look_at_part(particles, cells, grid, context, dense, law, stress):
    """Prepare the cells of one thread for the collisions of a dense gas. These are cells[0] to cells[1]."""
    if stress is not None and dense.half[0] == 1:
        add_flights(particles, cells, grid, context, stress, law)
    look_at_cells(particles, cells, grid, context.workspace, dense)


@inner_parallel_kernel
def look_at_shared(particles, shares, grid, workspace, lengths, dense, law, stress):
    """Perform `look_at_part` for all parts."""
    for part in prange(len(shares) - 1):
        context = ThreadContext(open_space(lengths), workspace, part)
        look_at_part(particles, (shares[part], shares[part + 1]), grid, context, dense, law, stress)


@inner_helper
def collide_slabs(particles, turn, parts, grid, context, dense, law, stress):
    """Perform the collisions of half a step in one thread's slabs, every second one from slab `turn`."""
    slabs = part_of(context.part, parts, (len(dense.slabs) - turn) // 2)
    for n in range(slabs[0], slabs[1]):
        collide_slab(particles, turn + 2 * n, grid, context, dense, law, stress)


@inner_parallel_kernel
def collide_slabs_shared(particles, turn, grid, workspace, lengths, dense, law, stress):
    """Perform `collide_slabs` for all parts."""
    parts = len(grid.counts)
    for part in prange(parts):
        context = ThreadContext(open_space(lengths), workspace, part)
        collide_slabs(particles, turn, parts, grid, context, dense, law, stress)


@inner_allocating_kernel
def collide_dense(particles, half, grid, context, threads, law, dense, stress):
    """Perform the collisions of a dense gas in half 0 or 1 of a step, before or after the flight."""
    lengths, workspace = context.space.lengths, context.workspace
    dense.half[0] = half
    if threads is None:
        look_at_part(particles, (0, len(grid.starts) - 1), grid, context, dense, law, stress)
    else:
        shares = np.empty(len(grid.counts) + 1, np.int64)
        share_cells(grid, shares)
        look_at_shared(particles, shares, grid, workspace, lengths, dense, law, stress)
    find_bounds(grid, workspace, dense)
    turns = min(2, len(dense.slabs) - 1)
    for n in range(turns):
        turn = turns - 1 - n if half == 1 else n
        if n > 0:
            find_near_speeds(grid, dense)
        if threads is None:
            collide_slabs(particles, turn, 1, grid, context, dense, law, stress)
        else:
            collide_slabs_shared(particles, turn, grid, workspace, lengths, dense, law, stress)


@inner_helper
def move_all(particles, grid, context, threads, gravity, faces, law):
    """Perform the motion of one step."""
    space, workspace = context.space, context.workspace
    if threads is None:
        move_part(particles, grid, context, 1, gravity, faces, law)
    else:
        move_shared(particles, grid, workspace, space.lengths, space.periodic, gravity, faces, law)


@inner_helper
def sort_all(particles, grid, threads):
    """Sort the particles in memory by their cells."""
    count = particles.data.shape[1]
    find_starts(grid)
    if threads is None:
        put_in_order(0, count, 0, grid)
    else:
        order_shared(particles, grid)
    for row in range(2 * len(particles.images)):
        if threads is None:
            gather_row(particles, row, 0, count, grid)
        else:
            gather_shared(particles, row, grid)
        swap_row(particles, row)
    if threads is None:
        gather_numbers(particles, 0, count, grid)
    else:
        gather_shared(particles, -1, grid)
    particles.rows[len(particles.rows) - 1] = 1 - particles.rows[len(particles.rows) - 1]


@inner_helper
def sort_at_rest(particles, grid, threads, faces, dense):
    """Sort the particles of a dense gas in memory by cells before the first step; other steps sort them."""
    if dense is not None:
        parts = len(grid.counts)
        for part in range(parts):
            slots = part_of(part, parts, particles.data.shape[1])
            locate(particles, slots[0], slots[1], grid)
            if faces is not None:
                leave_out_absent(particles, slots[0], slots[1], grid, faces.present)
            count(slots[0], slots[1], part, grid)
        sort_all(particles, grid, threads)


@inner_allocating_kernel
def collide_before_flight(particles, grid, context, threads, law, dense, stress):
    """Perform the collisions of a dense gas in the first half of a step."""
    if dense is not None:
        collide_dense(particles, 0, grid, context, threads, law, dense, stress)


@inner_allocating_kernel
def collide_all(particles, grid, context, threads, law, dense, stress):
    """Perform the collisions of one step, of a dense gas those after the flight."""
    space, workspace = context.space, context.workspace
    if dense is not None:
        collide_dense(particles, 1, grid, context, threads, law, dense, stress)
    elif threads is None:
        collide_part(particles, (0, len(grid.starts) - 1), grid, context, law, stress)
    else:
        shares = np.empty(len(grid.counts) + 1, np.int64)
        share_cells(grid, shares)
        collide_shared(particles, shares, grid, workspace, space.lengths, space.periodic, law, stress)


@allocating_kernel
def run_steps(particles, grid, context, steps, threads, options):
    """Perform a number of steps, or fewer if the step length becomes unsuitable. Returns the number of steps
    performed, at least one. `threads`: number of threads, or None for one thread. `options`: gravity (d,),
    special faces, collision law, data of a dense gas, sums of the stress, step lengths that suit the gas, and
    gases behind open faces; each may be None.
    """
    gravity, faces, law, dense, stress, pace, reservoirs = options
    sort_at_rest(particles, grid, threads, faces, dense)
    for n in range(steps):
        if n > 0 and not still_fits(particles, pace):
            return n
        collide_before_flight(particles, grid, context, threads, law, dense, stress)
        slot = first_free_slot(reservoirs)
        move_all(particles, grid, context, threads, gravity, faces, law)
        admit_all(particles, slot, grid, context, faces, reservoirs)
        sort_all(particles, grid, threads)
        collide_all(particles, grid, context, threads, law, dense, stress)
        context.workspace.clock[0] += 1
    return steps
