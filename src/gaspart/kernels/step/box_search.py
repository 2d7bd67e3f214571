"""Search of overlapping pairs with the boxes of Frederickx & Meerts (2010), and the time step.

The number of boxes is arbitrary, and may be one. Each pair is tested once: first the rest of the particle's
own box, then the neighbouring boxes with higher indices.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import int64

from gaspart.kernels.compile.policy import (
    allocating_kernel,
    inner_allocating_kernel,
    inner_helper,
    inner_kernel,
)
from gaspart.kernels.physics.periodic import box_coordinate
from gaspart.kernels.step.model import BOX_VISITS, DISPLACEMENT, FASTEST, PAIR_TESTS, Search, Step
from gaspart.kernels.step.resolve import count_left, distance_squared, examine, in_order
from gaspart.kernels.step.shared_contacts import resolve_found
from gaspart.kernels.step.threads import (
    gather_overlaps,
    is_outdated,
    make_list,
    move_all,
    room_for,
    search_list,
)


class StepBoxes(NamedTuple):
    """Grid of boxes (see `state.boxes.Boxes`) and the slots in each box."""

    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray
    at: np.ndarray
    head: np.ndarray
    following: np.ndarray
    near: bool
    reach: float


@inner_kernel
def sort_in(particles, boxes):
    """Insert all ordinary particles into the lists of their boxes."""
    boxes.head[:] = -1
    for slot in range(particles.ordinary):
        box = 0
        for k in range(particles.positions.shape[0]):
            c = box_coordinate(particles.positions[k, slot], boxes.widths[k], boxes.per_side[k])
            boxes.at[slot, k] = c
            box += c * boxes.strides[k]
        boxes.following[slot] = boxes.head[box]
        boxes.head[box] = slot


@inner_helper
def gap_squared(particles, slot, boxes, axis, offset, periodic):
    """Return the squared distance between a particle and the slab of a box along an axis. The second of two
    boxes along a periodic axis is on both sides of the first. `offset`: position of the box relative to the
    particle's box (-1, 0, 1).
    """
    x = particles.positions[axis, slot]
    width = boxes.widths[axis]
    low = boxes.at[slot, axis] * width
    gap = x - x
    if offset != 0 and periodic[axis] and boxes.per_side[axis] == 2:
        gap = max(gap, min(low + width - x, x - low))
    elif offset == 1:
        gap = max(gap, low + width - x)
    elif offset == -1:
        gap = max(gap, x - low)
    return gap * gap


@inner_kernel
def is_out_of_reach(particles, slot, boxes, dx, dy, dz, periodic):
    """Return True if a neighbouring box is too far away for the centre of a partner."""
    square = gap_squared(particles, slot, boxes, 0, dx - 1, periodic)
    square += gap_squared(particles, slot, boxes, 1, dy - 1, periodic)
    if particles.positions.shape[0] == 3:
        square += gap_squared(particles, slot, boxes, 2, dz - 1, periodic)
    return square > boxes.reach * boxes.reach


@inner_kernel
def search_all(particles, i, space, step, overlaps):
    """Test a particle against all preceding particles; return the number of tests. For each block of
    particles the test is a loop without branches.
    """
    size = particles.radii[i]
    start = 0
    while start < i:
        stop = min(start + 256, i)
        hits = 0
        for j in range(start, stop):
            sigma = size + particles.radii[j]
            hits += distance_squared(particles, i, j, space) < sigma * sigma
        if hits:
            for j in range(start, stop):
                sigma = size + particles.radii[j]
                if distance_squared(particles, i, j, space) < sigma * sigma:
                    examine(particles, i, j, space, step, overlaps, 0)
        start = stop
    return i


@inner_helper
def search_list_of_box(particles, i, j, boxes, space, step, overlaps):
    """Test a particle against slot j and all following slots in its box. Returns the number of tests."""
    tests = 0
    size = particles.radii[i]
    while j >= 0:
        tests += 1
        sigma = size + particles.radii[j]
        if distance_squared(particles, i, j, space) < sigma * sigma:
            examine(particles, i, j, space, step, overlaps, 0)
        j = boxes.following[j]
    return tests


@inner_kernel
def search_boxes(particles, boxes, space, step, overlaps, tally):
    """Record all pairs of ordinary particles that must be resolved."""
    if len(boxes.head) == 1:
        tally.counts[BOX_VISITS] += particles.ordinary
        for i in range(particles.ordinary):
            tally.counts[PAIR_TESTS] += search_all(particles, i, space, step, overlaps)
        return
    tests = visits = 0
    for i in range(particles.ordinary):
        ax, ay, az = boxes.at[i, 0], boxes.at[i, 1], boxes.at[i, 2]
        own = ax * boxes.strides[0] + ay * boxes.strides[1] + az * boxes.strides[2]
        visits += 1
        tests += search_list_of_box(particles, i, boxes.following[i], boxes, space, step, overlaps)
        for dz in range(3):
            z = boxes.neighbour[2, az, dz]
            if z < 0:
                continue
            for dy in range(3):
                y = boxes.neighbour[1, ay, dy]
                if y < 0:
                    continue
                for dx in range(3):
                    x = boxes.neighbour[0, ax, dx]
                    if x < 0 or x + y + z <= own:
                        continue
                    if boxes.near and is_out_of_reach(particles, i, boxes, dx, dy, dz, space.periodic):
                        continue
                    visits += 1
                    j = boxes.head[x + y + z]
                    tests += search_list_of_box(particles, i, j, boxes, space, step, overlaps)
    tally.counts[PAIR_TESTS] += tests
    tally.counts[BOX_VISITS] += visits


# Sequence of time steps of the time-stepped engine.
#
# A step moves all particles, reflects particles that left through a wall, and finds all pairs that overlap
# and approach. It resolves them in the order of contact time and indices, testing each pair again. Further
# passes find pairs that the first pass missed or created. The kind of search does not change any bit of the
# result. All arithmetic has the precision of the positions (float32 or float64), so 0 is written as dt - dt
# and 2x as x + x.


@inner_helper
def total_pull(gravity):
    """Return the sum of the absolute components of gravity."""
    pull = 0.0
    if gravity is not None:
        for component in gravity:
            pull += abs(component)
    return pull


@inner_allocating_kernel
def update_list(particles, pairs, space, tally, before, threads, cells):
    """Renew the neighbour list if it is outdated; return its pairs, and `before`, see `Step`."""
    if cells is not None:
        if is_outdated(particles, cells, space, threads):
            return make_list(particles, cells, pairs, space, tally, threads), int64(0)
    return pairs, before


@inner_helper
def search_grid(particles, space, step, overlaps, tally, boxes):
    """Search the boxes, if there are any."""
    if boxes is not None:
        sort_in(particles, boxes)
        search_boxes(particles, boxes, space, step, overlaps, tally)


@inner_allocating_kernel
def find_contacts(particles, search, space, step, overlaps, tally, threads):
    """Find all pairs that must be resolved; return them in `overlaps`, or in larger arrays."""
    parts, count = len(overlaps.number), particles.positions.shape[1]
    while True:
        overlaps.number[:] = 0
        overlaps.tests[:] = 0
        search_list(particles, search.pairs, space, step, overlaps, threads, search.cells)
        search_grid(particles, space, step, overlaps, tally, search.boxes)
        for slot in range(particles.ordinary, count):
            overlaps.tests[0] += search_all(particles, slot, space, step, overlaps)
        if overlaps.number.max() <= overlaps.times.shape[1]:
            break
        overlaps = room_for(parts, 2 * overlaps.number.max(), particles.positions)
    tally.counts[PAIR_TESTS] += overlaps.tests.sum()
    return overlaps


@allocating_kernel
def run_steps(particles, search, model, settings, steps, tally, threads):
    """Perform a number of steps; for zero steps, only renew an outdated neighbour list. Returns the present
    pairs of the list. `settings`: length of the steps, True to rewind contacts, and the maximum number of
    passes. `threads`: number of threads, or None for one thread.
    """
    boxes, cells, pairs = search
    space, rules, law = model.space, model.rules, model.law
    dt, rewind, passes = settings
    parts = 1 if threads is None else threads
    overlaps = room_for(parts, particles.positions.shape[1] // parts + 16, particles.positions)
    particles.last_pass[:] = 0
    pull = total_pull(model.gravity)
    if steps == 0:
        pairs, _ = update_list(particles, pairs, space, tally, int64(0), threads, cells)
    for n in range(steps):
        particles.bounds[FASTEST] += pull * dt
        particles.bounds[DISPLACEMENT] += particles.bounds[FASTEST] * dt
        move_all(particles, model, dt, tally, threads, rules, cells)
        number, before, first = 0, int64(0), n * passes + 1
        for now in range(first, first + passes):
            pairs, before = update_list(particles, pairs, space, tally, before, threads, cells)
            step = Step(dt, rewind, passes > 1, now, first, before)
            overlaps = find_contacts(
                particles, Search(boxes, cells, pairs), space, step, overlaps, tally, threads
            )
            number = overlaps.number.sum()
            if number == 0:
                break
            contacts, times = gather_overlaps(overlaps)
            in_turn = contacts, in_order(particles.index, contacts, times)
            resolve_found(particles, in_turn, model, step, tally, threads, law, cells)
            before = now
        if number > 0:
            count_left(particles, contacts, space, tally)
    return pairs
