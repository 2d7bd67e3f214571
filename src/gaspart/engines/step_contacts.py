"""The contacts of one step: which overlaps count, in what order they are resolved, and how.

The order - time of contact, lower index, higher index - knows nothing of slots, boxes or threads, so neither
does any bit of the result.
"""

import numpy as np

from gaspart.contact import exchange
from gaspart.coordinates import nearest
from gaspart.engines.running_sum import add
from gaspart.engines.step_layout import (
    COLLISIONS,
    DEEPEST,
    LATE,
    LOSS,
    MULTIPLE,
    OVERLAPS_LEFT,
    PASSED,
    VIRIAL,
    WORST,
)
from gaspart.engines.step_motion import note_change, wrap
from gaspart.engines.step_rules import strike_in_rows
from gaspart.fetch import fetch
from gaspart.kernel import allocating_kernel, helper, kernel

_ONE = np.uint32(1)
_RUN = 16
_AHEAD = 4  # contacts
_LATE = 1.125  # steps ago: contacts before these belong to an earlier step, however float32 rounds


@helper
def distance_squared(bodies, space, i, j):
    """Of two slots, by the nearest image: the same bits as `invariants` finds, without a branch."""
    rr = space.margin - space.margin
    for k in range(len(space.lengths)):
        length = space.lengths[k] if space.periodic[k] else np.inf
        r = abs(bodies.positions[k, j] - bodies.positions[k, i])
        r = min(r, abs(length - r))
        rr += r * r
    return rr


@helper
def invariants(bodies, space, i, j):
    """rr, rv, vv of a pair (see `contact`), j by its nearest image."""
    rr = rv = vv = space.margin - space.margin
    for k in range(len(space.lengths)):
        gap = bodies.positions[k, j] - bodies.positions[k, i]
        r = nearest(gap, space.lengths[k], space.periodic[k])
        v = bodies.velocities[k, j] - bodies.velocities[k, i]
        rr += r * r
        rv += r * v
        vv += v * v
    return rr, rv, vv


@helper
def entered(rr, rv, vv, ss):
    """When an overlapping pair touched first, if it has always moved as it does now: a time in the past.

    The earlier root of vv t^2 + 2 rv t + (rr - ss) = 0, as in `contact.contact_root`, in the form that does
    not cancel for a pair that is parting already.
    """
    root = np.sqrt(rv * rv - vv * (rr - ss))
    if rv < 0.0:
        return (rr - ss) / (root - rv)
    return -(root + rv) / vv


@helper
def counts(rr, rv, vv, ss, dt, parting):
    """Whether an overlap is to be resolved: it grows, or (if `parting` is on) it began in this step."""
    if not rr < ss:
        return False
    return rv < 0.0 or (parting and rv > 0.0 and -entered(rr, rv, vv, ss) < dt)


@helper
def examine(bodies, space, i, j, dt, parting, found, thread):
    """Write a pair of overlapping slots down if it is to be resolved."""
    if bodies.index[i] > bodies.index[j]:
        i, j = j, i
    rr, rv, vv = invariants(bodies, space, i, j)
    sigma = bodies.radii[i] + bodies.radii[j]
    if counts(rr, rv, vv, sigma * sigma, dt, parting):
        n = found.number[thread]
        if n < found.times.shape[1]:
            found.pairs[thread, n, 0] = i
            found.pairs[thread, n, 1] = j
            found.times[thread, n] = entered(rr, rv, vv, sigma * sigma)
        found.number[thread] = n + 1


@helper
def earlier(index, pairs, times, m, n):
    """Whether contact m is resolved before contact n: by time, then lower index, then higher index."""
    if times[m] != times[n]:
        return times[m] < times[n]
    low_m, low_n = index[pairs[m, 0]], index[pairs[n, 0]]
    return low_m < low_n or (low_m == low_n and index[pairs[m, 1]] < index[pairs[n, 1]])


@allocating_kernel
def spread(times):
    """Contacts nearly in the order of their times: sorted into as many equal stretches of time as there are
    contacts."""
    number = len(times)
    first, last = times.min(), times.max()
    scale = (number - 1) / np.float64(last - first) if last > first else 0.0
    place = np.empty(number, np.uint32)
    ends = np.zeros(number + 1, np.uint32)
    for n in range(number):
        place[n] = np.uint32((times[n] - first) * scale)
        ends[place[n] + _ONE] += _ONE
    for n in range(number):
        ends[n + 1] += ends[n]
    order = np.empty(number, np.uint32)
    for n in range(number):
        order[ends[place[n]]] = n
        ends[place[n]] += _ONE
    return order


@kernel
def insert(index, pairs, times, order, low, high):
    """Put the contacts order[low:high] in order, one after another."""
    for n in range(low + 1, high):
        contact = order[n]
        place = n
        while place > low and earlier(index, pairs, times, contact, order[place - 1]):
            order[place] = order[place - 1]
            place -= 1
        order[place] = contact


@kernel
def merge(index, pairs, times, order, room, low, middle, high):
    """Merge order[low:middle] with order[middle:high]."""
    for n in range(low, middle):
        room[n] = order[n]
    left, right = low, middle
    place = low
    while left < middle and right < high:
        if earlier(index, pairs, times, order[right], room[left]):
            order[place] = order[right]
            right += 1
        else:
            order[place] = room[left]
            left += 1
        place += 1
    while left < middle:
        order[place] = room[left]
        left += 1
        place += 1


@allocating_kernel
def in_order(index, pairs, times):
    """The order in which contacts are resolved: spread by time, runs put in order, and merged where they are
    not yet. (numba's own sorts take 15 s to compile.)"""
    number = len(times)
    order = spread(times)
    room = np.empty(number, np.uint32)
    for low in range(0, number, _RUN):
        insert(index, pairs, times, order, low, min(low + _RUN, number))
    width = _RUN
    while width < number:
        for middle in range(width, number, 2 * width):
            if earlier(index, pairs, times, order[middle], order[middle - 1]):
                high = min(middle + width, number)
                merge(index, pairs, times, order, room, middle - width, middle, high)
        width *= 2
    return order


@helper
def kicks(rr, rv, mass1, mass2):
    """The factors k1, k2 of an elastic contact (v1 += k1 r, v2 -= k2 r), and |r.p| of the momentum p passed.
    A body of infinite mass takes none."""
    if mass1 == np.inf:
        return rr - rr, (rv + rv) / rr, (mass2 + mass2) * abs(rv)
    if mass2 == np.inf:
        return (rv + rv) / rr, rr - rr, (mass1 + mass1) * abs(rv)
    k1, k2 = exchange(rr, rv, mass1, mass2)
    return k1, k2, (mass1 + mass1) * (mass2 / (mass1 + mass2)) * abs(rv)


@helper
def note(bodies, space, slot, speed_squared, turn, cells, watch, counters):
    """Remember a contact of a body: how many it has in this step, how fast it is now, and how far from where
    it was when the list was made."""
    counters.counts[MULTIPLE] += watch.met[slot] >= turn.first
    watch.met[slot] = turn.now
    note_change(bodies, space, slot, speed_squared, cells, watch)


@helper
def bump(bodies, space, i, j, ago, rr, rv, counters):
    """A contact of smooth bodies, at the time `ago` with the invariants rr, rv; the squares of the two speeds
    then."""
    one, other = bodies.index[i], bodies.index[j]
    to_i, to_j, passed = kicks(rr, rv, bodies.masses[one], bodies.masses[other])
    add(counters.sums, LOSS, 0.25 * (1.0 - space.normal * space.normal) * passed * abs(rv) / rr)
    to_i, to_j, passed = to_i * space.push, to_j * space.push, passed * space.push
    add(counters.sums, VIRIAL, passed)
    speed_i = speed_j = ago - ago
    for k in range(len(space.lengths)):
        gap = bodies.positions[k, j] - bodies.positions[k, i]
        r = nearest(gap, space.lengths[k], space.periodic[k])
        r += ago * (bodies.velocities[k, j] - bodies.velocities[k, i])
        bodies.velocities[k, i] += to_i * r
        bodies.velocities[k, j] -= to_j * r
        bodies.positions[k, i] -= ago * (to_i * r)
        bodies.positions[k, j] += ago * (to_j * r)
        speed_i += bodies.velocities[k, i] * bodies.velocities[k, i]
        speed_j += bodies.velocities[k, j] * bodies.velocities[k, j]
    return speed_i, speed_j


@helper
def resolve(bodies, space, i, j, dt, turn, rewind, parting, rules, law, cells, watch, counters):
    """Collide a pair, if it is still to be resolved: rewind it to its contact, pass the momentum along the
    normal at contact, and play the rest of the step with the new velocities."""
    rr, rv, vv = invariants(bodies, space, i, j)
    sigma = bodies.radii[i] + bodies.radii[j]
    ss = sigma * sigma
    if not counts(rr, rv, vv, ss, dt, parting):
        return
    counters.extremes[DEEPEST] = max(counters.extremes[DEEPEST], 1.0 - np.sqrt(rr) / sigma)
    ago = rr - rr
    if rewind:
        ago = entered(rr, rv, vv, ss)
        if ago < -_LATE * dt:
            counters.counts[LATE] += 1
            if rr + rr + rr + rr < ss:
                counters.counts[PASSED] += 1
        rr += ago * (rv + rv + vv * ago)  # the invariants as they were at the contact
        rv += ago * vv
        counters.extremes[WORST] = max(counters.extremes[WORST], abs(rr / ss - 1.0))
    counters.counts[COLLISIONS] += 1
    if law is not None:
        speed_i, speed_j = strike_in_rows(bodies, space, i, j, ago, rr, rv, rules, law, counters)
    else:
        speed_i, speed_j = bump(bodies, space, i, j, ago, rr, rv, counters)
    for k in range(len(space.lengths)):
        if rewind and space.periodic[k]:
            wrap(bodies, i, k, space.lengths[k])
            wrap(bodies, j, k, space.lengths[k])
    note(bodies, space, i, speed_i, turn, cells, watch, counters)
    note(bodies, space, j, speed_j, turn, cells, watch, counters)


@helper
def fetch_body(bodies, slot, cells, watch):
    """Begin to load what a contact of a body reads."""
    for k in range(len(bodies.positions)):
        fetch(bodies.positions[k], slot)
        fetch(bodies.velocities[k], slot)
        if cells is not None:
            fetch(cells.origin[k], slot)
    fetch(bodies.radii, slot)
    fetch(bodies.index, slot)
    fetch(watch.met, slot)


@kernel
def resolve_all(
    bodies, space, pairs, order, dt, turn, rewind, parting, rules, law, cells, watch, counters
):  # fmt: skip
    """Resolve what one search has found, in order."""
    last = len(order) - 1
    for n in range(len(order)):
        for side in range(2):  # what the next contacts read is on its way while this one is resolved
            fetch_body(bodies, pairs[order[min(n + 2 * _AHEAD, last)], side], cells, watch)
            fetch(bodies.masses, bodies.index[pairs[order[min(n + _AHEAD, last)], side]])
        i, j = pairs[order[n], 0], pairs[order[n], 1]
        resolve(bodies, space, i, j, dt, turn, rewind, parting, rules, law, cells, watch, counters)


@kernel
def count_left(bodies, space, pairs, counters):
    """Count the pairs found that overlap and approach even now."""
    for n in range(len(pairs)):
        i, j = pairs[n, 0], pairs[n, 1]
        rr, rv, _ = invariants(bodies, space, i, j)
        sigma = bodies.radii[i] + bodies.radii[j]
        if rr < sigma * sigma and rv < 0.0:
            counters.counts[OVERLAPS_LEFT] += 1
