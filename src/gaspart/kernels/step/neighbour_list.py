"""Overlapping pairs by a neighbour list: all pairs nearer than a contact and a `skin`, made anew when
particles may have crossed the skin.

An entry of the list is one word: a slot, the first of eight others in a row, and a mark for each of these
that is near. So it is made, and searched, by loading eight particles at once. Entries are written in any
case, and only then are those without a mark left out: a place that depends on the entry before would have to
wait for it.
"""

import numpy as np

from gaspart.kernels.compile.policy import inner_allocating_kernel, inner_helper, inner_kernel
from gaspart.kernels.prefetch import fetch
from gaspart.kernels.simd import lowest
from gaspart.kernels.step.model import DISPLACEMENT, part_of
from gaspart.kernels.step.resolve import examine
from gaspart.kernels.step.simd import WIDTH, bits, compact_eight, equals, nearer

_SAFE = 0.99  # of the skin, so that rounding uses none of it
_ROOM = np.uint64(1024)  # entries written before those without a mark are left out
_BLOCK = 64  # slots whose partners in one row are looked for before those in the next
ONE, _TWO, _EIGHT = np.uint64(1), np.uint64(2), np.uint64(WIDTH)
_PLACE, _MARKS = np.uint64(28), np.uint64(56)  # of an entry: where its slot begins, and its marks
_SLOTS = (ONE << _PLACE) - ONE


@inner_kernel
def compact(entries, number, pairs, listed):
    """Write those of the first entries that have a mark into pairs (room,), behind those `listed` before, as
    long as there is room; how many there are then."""
    most = np.uint64(len(pairs)) - _EIGHT
    for n in range(WIDTH):
        entries[number + np.uint64(n)] = 0
    for n in range(np.uint64(0), number, _EIGHT):
        listed += compact_eight(entries, n, ONE << _MARKS, pairs, min(listed, most))
    return listed


@inner_helper
def record_near(particles, slot, others, cells, space, entries, pairs, filled):
    """Record which of the slots from others[0] to others[1] are nearer to one than a contact and the skin,
    eight an entry. filled: the numbers of entries, and of those in the list; these numbers then."""
    number, listed = filled
    first, last = np.uint64(others[0]), np.uint64(others[1])
    while True:
        marks = nearer(particles.positions, particles.radii, space, slot, cells.skin, first)
        marks &= (ONE << min(last - first, _EIGHT)) - ONE
        entries[number] = (marks << _MARKS) | (slot << _PLACE) | first
        number += ONE
        if number == _ROOM:
            listed = compact(entries, number, pairs, listed)
            number = np.uint64(0)
        first += _EIGHT
        if first >= last:
            return number, listed


@inner_helper
def rows_ahead(dimension):
    """How many rows of cells hold partners of a particle that its row is to be listed with: its own, and
    those that come next to it along the other axes."""
    return 5 if dimension == 3 else 2


@inner_helper
def ahead(cells, n):
    """By how much the index of a cell in row n of these is higher."""
    if n < 2:
        return cells.strides[1] * n
    return cells.strides[2] + cells.strides[1] * (n - 3)


@inner_helper
def find_stretches(slots, n, cells, stretches):
    """Find the partners in row n of the slots from slots[0] to slots[1]: stretches of slots, those in the
    same column and in the columns beside it. Those that are not empty are written into stretches (2, m), as
    entries without marks and as the slots behind; how many these are, and how many partners. (To test an
    empty stretch takes as long as eight slots, and no branch can foresee which are empty.)"""
    ends = cells.ends
    on = np.uint64(ahead(cells, n))
    number = partners = np.uint64(0)
    for slot in range(np.uint64(slots[0]), np.uint64(slots[1])):
        at = np.uint64(cells.cell[slot]) + on
        first, last = slot + ONE if n == 0 else np.uint64(ends[at - _TWO]), np.uint64(ends[at + ONE])
        stretches[0, number] = (slot << _PLACE) | first
        stretches[1, number] = last
        number += np.uint64(last > first)
        partners += last - first
    return number, partners


@inner_helper
def record_stretches(particles, stretches, stop, cells, space, entries, pairs, filled):
    """`record_near` of the slots and their partners in stretches[:, :stop]; the numbers of entries then."""
    for k in range(stop):
        slot, others = stretches[0, k] >> _PLACE, (stretches[0, k] & _SLOTS, stretches[1, k])
        filled = record_near(particles, slot, others, cells, space, entries, pairs, filled)
    return filled


@inner_helper
def record_across(particles, at, across, cells, space, entries, pairs, filled):
    """`record_near` of the slots in cell `at` with those in the cell `across` the container and in the same
    column of the rows ahead; the numbers of entries then, and of tests."""
    ends = cells.ends
    tests = np.uint64(0)
    for slot in range(np.uint64(ends[at - 1]), np.uint64(ends[at])):
        for n in range(0 if across > at else 1, rows_ahead(len(space.lengths))):
            other = across + ahead(cells, n)
            others = np.uint64(ends[other - 1]), np.uint64(ends[other])
            tests += others[1] - others[0]
            filled = record_near(particles, slot, others, cells, space, entries, pairs, filled)
    return filled, tests


@inner_allocating_kernel
def list_part(particles, part, cells, pairs, space, tests):
    """Write all pairs of slots nearer than a contact and the skin that one thread is to find, as entries into
    pairs[part] (room,), and how many these are into cells.listed (if there is no room for all, the last are
    missing); the number of tests into tests (threads,)."""
    parts, rows, mine = len(pairs), rows_ahead(len(space.lengths)), pairs[part]
    start, stop = part_of(part, parts, particles.ordinary)
    entries = np.empty(_ROOM + _EIGHT, np.uint64)
    stretches = np.empty((2, _BLOCK), np.uint64)
    total = np.uint64(0)
    filled = np.uint64(0), np.uint64(0)
    for low in range(start, stop, _BLOCK):
        slots = low, min(low + _BLOCK, stop)
        for n in range(rows):
            number, tested = find_stretches(slots, n, cells, stretches)
            filled = record_stretches(particles, stretches, number, cells, space, entries, mine, filled)
            total += tested
    if cells.wraps[0]:
        lines = cells.per_side[1] * cells.per_side[2]
        start, stop = part_of(part, parts, lines)
        for line in range(start, stop):
            plane = line // cells.per_side[1]
            left = 2 + (line - plane * cells.per_side[1] + 1) * cells.strides[1]
            if rows == 5:
                left += (plane + 1) * cells.strides[2]
            right = left + cells.per_side[0] - 1
            for at, across in ((left, right), (right, left)):
                filled, tested = record_across(particles, at, across, cells, space, entries, mine, filled)
                total += tested
    cells.listed[part] = compact(entries, filled[0], mine, filled[1])
    tests[part] = total


@inner_kernel
def is_complete(particles, cells):
    """Whether no two particles may have come nearer by more than the skin since the list was made."""
    return 2.0 * particles.bounds[DISPLACEMENT] < _SAFE * cells.skin


@inner_kernel
def search_pairs(particles, entries, space, step, found, thread):
    """Record the pairs, among those of some entries (n,), that are to be resolved; with a pass `step.before`,
    only those of which one particle at least had a contact in that pass: for all others nothing has changed
    since they were searched."""
    touching, before, last_pass = found.touching[thread], step.before, particles.last_pass
    tests = np.uint64(0)  # into `found` at the end: threads that write to one cache line wait for each other
    for low in range(0, len(entries), len(touching)):
        number = np.uint64(0)
        for entry in entries[low : low + len(touching)]:
            slot, first, marks = (entry >> _PLACE) & _SLOTS, entry & _SLOTS, entry >> _MARKS
            if before != 0 and last_pass[slot] != before:
                marks &= equals(last_pass, first, np.uint32(before))
                if marks == 0:
                    continue
            tests += bits(marks)
            marks &= nearer(particles.positions, particles.radii, space, slot, step.dt - step.dt, first)
            if marks != 0:
                touching[number] = (marks << _MARKS) | (entry & ~(~np.uint64(0) << _MARKS))
                number += ONE
        for entry in touching[:number]:
            slot, other = (entry >> _PLACE) & _SLOTS, entry & _SLOTS
            for k in range(len(space.lengths)):
                fetch(particles.velocities[k], slot)
                fetch(particles.velocities[k], other)
            fetch(particles.index, slot)
            fetch(particles.index, other)
        for entry in touching[:number]:
            slot, first, marks = (entry >> _PLACE) & _SLOTS, entry & _SLOTS, entry >> _MARKS
            while marks != 0:
                examine(particles, slot, first + lowest(marks), space, step, found, thread)
                marks &= marks - ONE
    found.tests[thread] += np.int64(tests)
