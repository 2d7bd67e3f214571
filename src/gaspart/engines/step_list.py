"""Overlapping pairs by a neighbour list: all pairs nearer than a contact and a `skin`, made anew when bodies
may have crossed the skin.

The search for them, and in them, hardly branches: it writes down every candidate, and goes on to the next
line only if that one counts.
"""

import numpy as np

from gaspart.engines.step_contacts import distance_squared, examine
from gaspart.engines.step_layout import SPENT, share
from gaspart.engines.step_motion import strayed
from gaspart.kernel import allocating_kernel, kernel

_AHEAD = 4  # candidates written down at once, whether a stretch has them or not
_ROOM = 4096  # candidates gathered before any is tested
_SAFE = 0.99  # of the skin, so that rounding spends none of it
ONE, _HALF = np.uint32(1), np.uint64(32)


@kernel
def sift(places, candidates, number, pairs, found):
    """Write down which of a number of candidates, a slot and another's place in one word, are nearer than a
    contact and the skin; how many pairs (room, 2) there are then."""
    own, spots, slot_of = places.own, places.spots, places.slot
    for n in range(number):
        i, place = np.uint32(candidates[n] >> _HALF), np.uint32(candidates[n])
        x, y = spots[place, 0] - own[i, 0], spots[place, 1] - own[i, 1]
        z, reach = spots[place, 2] - own[i, 2], spots[place, 3] - own[i, 3]
        pairs[found, 0] = i
        pairs[found, 1] = slot_of[place]
        found += np.uint64(x * x + y * y + z * z < reach * reach)
    return found


@allocating_kernel
def list_part(bodies, cells, places, part, pairs, tests):
    """Write down all pairs of slots nearer than a contact and the skin whose first is of one thread's, into
    pairs[part] (room, 2). Their number goes into cells.listed, or -1 if there is not room enough; the number
    of tests into tests (threads,)."""
    parts = len(pairs)
    low, high = share(part, parts, bodies.ordinary), share(part + 1, parts, bodies.ordinary)
    ends = cells.ends[parts - 1]
    mine = pairs[part]
    rows = np.empty(5, np.uint32)
    rows[0] = 0
    rows[1] = cells.strides[1]
    stretches = 2
    if len(bodies.positions) == 3:
        stretches = 5
        for n in range(3):
            rows[2 + n] = cells.strides[2] + (n - 1) * cells.strides[1]
    most = _ROOM
    candidates = np.empty(most + len(places.slot) + _AHEAD, np.uint64)
    cells.listed[part] = -1
    found = number = np.uint64(0)
    total = 0
    for slot in range(low, high):
        cell = places.cell[slot]
        place = places.place[slot]
        own = np.uint64(slot) << _HALF
        for n in range(stretches):
            row = cell + rows[n]
            begin = place + ONE if n == 0 else np.uint64(ends[row - np.uint32(2)])
            count = np.int64(ends[row + ONE]) - np.int64(begin)
            candidate = own | begin
            while True:
                for k in range(_AHEAD):
                    candidates[number + np.uint64(k)] = candidate + np.uint64(k)
                if count <= _AHEAD:
                    break
                count -= _AHEAD
                candidate += np.uint64(_AHEAD)
                number += np.uint64(_AHEAD)
            number += np.uint64(count)
        if np.int64(number) > most or slot == high - 1:
            if np.int64(found + number) >= len(mine):
                return
            total += np.int64(number)
            found = sift(places, candidates, number, mine, found)
            number = np.uint64(0)
    cells.listed[part] = found
    tests[part] = total


@kernel
def has_room(cells, watch):
    """Whether no two bodies may have come nearer by more than the skin since the list was made."""
    return 2.0 * watch.reach[SPENT] < _SAFE * cells.skin


@kernel
def is_stale(bodies, space, cells, watch):
    """Whether the list is to be made anew. By what the fastest body may have come, first; and if that is too
    much, by how far all have really come."""
    if has_room(cells, watch):
        return False
    if watch.reach[SPENT] < np.inf:
        most = 0.0
        for slot in range(bodies.ordinary):
            most = max(most, strayed(bodies, space, cells, slot))
        watch.reach[SPENT] = most
    return not has_room(cells, watch)


@kernel
def search_pairs(bodies, space, pairs, dt, parting, found, thread):
    """Write down the pairs (n, 2) that are to be resolved."""
    touching = found.touching[thread]
    found.tests[thread] += len(pairs)
    for low in range(0, len(pairs), len(touching)):
        block = pairs[low : low + len(touching)]
        number = np.uint64(0)
        for n in range(len(block)):
            i, j = block[n, 0], block[n, 1]
            sigma = bodies.radii[i] + bodies.radii[j]
            touching[number] = n
            number += np.uint64(distance_squared(bodies, space, i, j) < sigma * sigma)
        for n in touching[:number]:
            examine(bodies, space, block[n, 0], block[n, 1], dt, parting, found, thread)


@kernel
def search_stirred(bodies, space, pairs, watch, before, dt, parting, found, thread):
    """The same, only for pairs of which one body at least had a contact in the turn before: for all others
    nothing has changed since it was searched."""
    met, touching = watch.met, found.touching[thread]
    for low in range(0, len(pairs), len(touching)):
        block = pairs[low : low + len(touching)]
        number = np.uint64(0)
        for n in range(len(block)):
            touching[number] = n
            number += np.uint64((met[block[n, 0]] == before) | (met[block[n, 1]] == before))
        found.tests[thread] += np.int64(number)
        for n in touching[:number]:
            i, j = block[n, 0], block[n, 1]
            sigma = bodies.radii[i] + bodies.radii[j]
            if distance_squared(bodies, space, i, j) < sigma * sigma:
                examine(bodies, space, i, j, dt, parting, found, thread)
