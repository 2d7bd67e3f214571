"""Overlapping pairs by a neighbour list: all pairs nearer than a contact and a `skin`, made anew when bodies
may have crossed the skin.

An entry of the list is one word: a slot, the first of eight others in a row, and a mark for each of these
that is near. So it is made, and searched, by loading eight bodies at once. What is made is written down in
any case, and only then are entries without a mark left out: a place that depends on the entry before would
have to wait for it.
"""

import numpy as np

from gaspart.kernels.compilation import allocating_kernel, helper, kernel
from gaspart.kernels.prefetch import fetch
from gaspart.kernels.simd import lowest
from gaspart.kernels.step.model import SPENT, share
from gaspart.kernels.step.motion import note_spent
from gaspart.kernels.step.resolve import examine
from gaspart.kernels.step.simd import WIDTH, bits, equals, keep_eight, nearer

_SAFE = 0.99  # of the skin, so that rounding spends none of it
_ROOM = np.uint64(1024)  # entries gathered before those that mark nobody are left out
_BLOCK = 64  # slots whose partners in one row are looked for before those in the next
ONE, _TWO, _EIGHT = np.uint64(1), np.uint64(2), np.uint64(WIDTH)
_PLACE, _MARKS = np.uint64(28), np.uint64(56)  # of an entry: where its slot begins, and its marks
_SLOTS = (ONE << _PLACE) - ONE


@kernel
def keep(entries, number, pairs, found):
    """Write those of the first entries that mark anybody into pairs (room,), behind those `found` before, as
    long as there is room; how many there are then."""
    most = np.uint64(len(pairs)) - _EIGHT
    for n in range(WIDTH):
        entries[number + np.uint64(n)] = 0
    for n in range(np.uint64(0), number, _EIGHT):
        found += keep_eight(entries, n, ONE << _MARKS, pairs, min(found, most))
    return found


@helper
def note_near(bodies, space, skin, slot, begin, end, entries, number, pairs, found):
    """Note which slots from `begin` to `end` are nearer to one than a contact and the skin, eight an entry.
    The number of entries then, and of those in the list."""
    first, last = np.uint64(begin), np.uint64(end)
    while True:
        marks = nearer(bodies.positions, bodies.radii, space, slot, skin, first)
        marks &= (ONE << min(last - first, _EIGHT)) - ONE
        entries[number] = (marks << _MARKS) | (slot << _PLACE) | first
        number += ONE
        if number == _ROOM:
            found = keep(entries, number, pairs, found)
            number = np.uint64(0)
        first += _EIGHT
        if first >= last:
            return number, found


@helper
def rows_ahead(dimension):
    """How many rows of cells hold partners of a body that its row is to be listed with: its own, and those
    that come next to it along the other axes."""
    return 5 if dimension == 3 else 2


@helper
def ahead(cells, n):
    """By how much the index of a cell in row n of these is higher."""
    if n < 2:
        return cells.strides[1] * n
    return cells.strides[2] + cells.strides[1] * (n - 3)


@helper
def note_row(bodies, space, cells, ends, low, high, n, entries, number, pairs, found):
    """`note_near` of the slots from `low` to `high` with those of row n in their columns and in the columns
    beside these; the numbers of entries then, and of tests."""
    tests = np.uint64(0)
    on = np.uint64(ahead(cells, n))
    for slot in range(np.uint64(low), np.uint64(high)):
        at = np.uint64(cells.cell[slot]) + on
        first = slot + ONE if n == 0 else np.uint64(ends[at - _TWO])
        last = np.uint64(ends[at + ONE])
        tests += last - first
        number, found = note_near(bodies, space, cells.skin, slot, first, last, entries, number, pairs, found)
    return number, found, tests


@helper
def note_across(bodies, space, cells, ends, at, across, rows, entries, number, pairs, found):
    """`note_near` of the slots in cell `at` with those in the cell `across` the container and in the same
    column of the rows ahead; the numbers of entries then, and of tests."""
    tests = np.uint64(0)
    for slot in range(np.uint64(ends[at - 1]), np.uint64(ends[at])):
        for n in range(0 if across > at else 1, rows):
            other = across + ahead(cells, n)
            first, last = np.uint64(ends[other - 1]), np.uint64(ends[other])
            tests += last - first
            number, found = note_near(
                bodies, space, cells.skin, slot, first, last, entries, number, pairs, found
            )
    return number, found, tests


@allocating_kernel
def list_part(bodies, space, cells, part, pairs, tests):
    """Write down all pairs of slots nearer than a contact and the skin that one thread is to find, as entries
    in pairs[part] (room,), and how many these are into cells.listed (if there is no room for all, the last
    are missing); the number of tests into tests (threads,)."""
    parts, rows = len(pairs), rows_ahead(len(space.lengths))
    start, stop = share(part, parts, bodies.ordinary), share(part + 1, parts, bodies.ordinary)
    ends, mine = cells.ends[parts - 1], pairs[part]
    entries = np.empty(_ROOM + _EIGHT, np.uint64)
    found = number = total = np.uint64(0)
    for low in range(start, stop, _BLOCK):
        high = min(low + _BLOCK, stop)
        for n in range(rows):
            number, found, tested = note_row(
                bodies, space, cells, ends, low, high, n, entries, number, mine, found
            )
            total += tested
    if cells.wraps[0]:
        lines = cells.per_side[1] * cells.per_side[2]
        for line in range(share(part, parts, lines), share(part + 1, parts, lines)):
            plane = line // cells.per_side[1]
            left = 2 + (line - plane * cells.per_side[1] + 1) * cells.strides[1]
            if rows == 5:
                left += (plane + 1) * cells.strides[2]
            right = left + cells.per_side[0] - 1
            for at, across in ((left, right), (right, left)):
                number, found, tested = note_across(
                    bodies, space, cells, ends, at, across, rows, entries, number, mine, found
                )
                total += tested
    cells.listed[part] = keep(entries, number, mine, found)
    tests[part] = total


@kernel
def has_room(cells, watch):
    """Whether no two bodies may have come nearer by more than the skin since the list was made."""
    return 2.0 * watch.reach[SPENT] < _SAFE * cells.skin


@allocating_kernel
def is_stale(bodies, space, cells, watch):
    """Whether the list is to be made anew. By what the fastest body may have come, first; and if that is too
    much, by how far all have really come."""
    if has_room(cells, watch):
        return False
    if watch.reach[SPENT] < np.inf:
        note_spent(bodies, space, cells, watch)
    return not has_room(cells, watch)


@kernel
def search_pairs(bodies, space, pairs, met, before, dt, parting, found, thread):
    """Write down the pairs, among those of some entries (n,), that are to be resolved; with a turn `before`,
    only those of which one body at least had a contact in that turn: for all others nothing has changed since
    they were searched."""
    touching = found.touching[thread]
    for low in range(0, len(pairs), len(touching)):
        number = np.uint64(0)
        for entry in pairs[low : low + len(touching)]:
            slot, first, marks = (entry >> _PLACE) & _SLOTS, entry & _SLOTS, entry >> _MARKS
            if before != 0 and met[slot] != before:
                marks &= equals(met, first, np.uint32(before))
                if marks == 0:
                    continue
            found.tests[thread] += np.int64(bits(marks))
            marks &= nearer(bodies.positions, bodies.radii, space, slot, dt - dt, first)
            if marks != 0:
                touching[number] = (marks << _MARKS) | (entry & ~(~np.uint64(0) << _MARKS))
                number += ONE
        for entry in touching[:number]:
            slot, other = (entry >> _PLACE) & _SLOTS, entry & _SLOTS
            for k in range(len(space.lengths)):
                fetch(bodies.velocities[k], slot)
                fetch(bodies.velocities[k], other)
            fetch(bodies.index, slot)
            fetch(bodies.index, other)
        for entry in touching[:number]:
            slot, first, marks = (entry >> _PLACE) & _SLOTS, entry & _SLOTS, entry >> _MARKS
            while marks != 0:
                examine(bodies, space, slot, first + lowest(marks), dt, parting, found, thread)
                marks &= marks - ONE
