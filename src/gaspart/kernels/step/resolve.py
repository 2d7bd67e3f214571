"""Contacts of one step: which overlaps count, their order, and their resolution.

The order (time of contact, lower index, higher index) does not depend on slots, boxes or threads, so no bit
of the result does. The physics is the same as in `kernels.physics.contact`. The form here keeps float32, and
collides particles in the state at the time of the contact without moving them there. With restitution it
transfers only a fraction of the elastic impulse. A test compares it bit for bit with
`collision.collide_smooth` (test_resolve.py).
"""

import numpy as np

from gaspart.kernels.compile.policy import inner_allocating_kernel, inner_helper, inner_kernel
from gaspart.kernels.physics.contact import contact_root, exchange
from gaspart.kernels.physics.periodic import nearest
from gaspart.kernels.physics.running_sum import add
from gaspart.kernels.prefetch import fetch
from gaspart.kernels.step.boundaries import add_contact, collide_flights, place_and_speed
from gaspart.kernels.step.model import (
    COLLISIONS,
    DEEPEST,
    FIXED,
    LATE,
    LOSS,
    MULTIPLE,
    OVERLAPS_LEFT,
    PASSED,
    VIRIAL,
    WORST,
)
from gaspart.kernels.step.motion import raise_bounds, wrap

_ONE = np.uint32(1)
_RUN = 16
_AHEAD = 4  # number of contacts by which the prefetch is ahead
_LATE = 1.125  # time in steps; earlier contacts belong to an earlier step, for any rounding of float32


@inner_helper
def distance_squared(particles, i, j, space):
    """Return the squared distance of two slots, nearest image, with the bits of `invariants` but no
    branch.
    """
    rr = space.margin - space.margin
    for k in range(len(space.lengths)):
        length = space.lengths[k] if space.periodic[k] else np.inf
        r = abs(particles.positions[k, j] - particles.positions[k, i])
        r = min(r, abs(length - r))
        rr += r * r
    return rr


@inner_helper
def invariants(particles, i, j, space):
    """Return rr, rv, vv of a pair (see `contact`), with the nearest image of j."""
    rr = rv = vv = space.margin - space.margin
    for k in range(len(space.lengths)):
        gap = particles.positions[k, j] - particles.positions[k, i]
        r = nearest(gap, space.lengths[k], space.periodic[k])
        v = particles.velocities[k, j] - particles.velocities[k, i]
        rr += r * r
        rv += r * v
        vv += v * v
    return rr, rv, vv


@inner_helper
def entry_time(rr, rv, vv, ss):
    """Return the past time of first touch of an overlapping pair in uniform motion. For an approaching pair
    it is `contact_root`. For a separating pair the other form of the root is used, which does not cancel.
    """
    if rv < 0.0:
        return contact_root(rr, rv, vv, ss)
    return -(np.sqrt(rv * rv - vv * (rr - ss)) + rv) / vv


@inner_helper
def must_resolve(rr, rv, vv, ss, step):
    """Return True if an overlap grows, or (if `step.parting`) if it began in this step."""
    if not rr < ss:
        return False
    return rv < 0.0 or (step.parting and rv > 0.0 and -entry_time(rr, rv, vv, ss) < step.dt)


@inner_helper
def examine(particles, i, j, space, step, overlaps, thread):
    """Record a pair of overlapping slots if it must be resolved."""
    if particles.index[i] > particles.index[j]:
        i, j = j, i
    rr, rv, vv = invariants(particles, i, j, space)
    sigma = particles.radii[i] + particles.radii[j]
    if must_resolve(rr, rv, vv, sigma * sigma, step):
        n = overlaps.number[thread]
        if n < overlaps.times.shape[1]:
            overlaps.pairs[thread, n, 0] = i
            overlaps.pairs[thread, n, 1] = j
            overlaps.times[thread, n] = entry_time(rr, rv, vv, sigma * sigma)
        overlaps.number[thread] = n + 1


@inner_helper
def earlier(index, pairs, times, m, n):
    """Return True if contact m comes before contact n: by time, lower index, higher index."""
    if times[m] != times[n]:
        return times[m] < times[n]
    low_m, low_n = index[pairs[m, 0]], index[pairs[n, 0]]
    return low_m < low_n or (low_m == low_n and index[pairs[m, 1]] < index[pairs[n, 1]])


@inner_allocating_kernel
def spread(times):
    """Sort contacts into as many equal intervals of time, which sorts them nearly by time."""
    number = len(times)
    first, last = times.min(), times.max()
    scale = (number - 1) / np.float64(last - first) if last > first else 0.0
    interval = np.empty(number, np.uint32)
    ends = np.zeros(number + 1, np.uint32)
    for n in range(number):
        interval[n] = np.uint32((times[n] - first) * scale)
        ends[interval[n] + _ONE] += _ONE
    for n in range(number):
        ends[n + 1] += ends[n]
    order = np.empty(number, np.uint32)
    for n in range(number):
        order[ends[interval[n]]] = n
        ends[interval[n]] += _ONE
    return order


@inner_kernel
def insert(index, pairs, times, order, low, high):
    """Sort the contacts order[low:high] by insertion."""
    for n in range(low + 1, high):
        contact = order[n]
        position = n
        while position > low and earlier(index, pairs, times, contact, order[position - 1]):
            order[position] = order[position - 1]
            position -= 1
        order[position] = contact


@inner_kernel
def merge(index, pairs, times, order, room, low, middle, high):
    """Merge order[low:middle] with order[middle:high]."""
    for n in range(low, middle):
        room[n] = order[n]
    lower, upper = low, middle
    position = low
    while lower < middle and upper < high:
        if earlier(index, pairs, times, order[upper], room[lower]):
            order[position] = order[upper]
            upper += 1
        else:
            order[position] = room[lower]
            lower += 1
        position += 1
    while lower < middle:
        order[position] = room[lower]
        lower += 1
        position += 1


@inner_allocating_kernel
def in_order(index, pairs, times):
    """Return the order in which contacts are resolved. Contacts are first sorted into intervals of time and
    then in runs, and the runs are merged if necessary. (numba's own sorts take 15 s to compile.)
    """
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


@inner_helper
def impulse_factors(rr, rv, mass1, mass2):
    """Return the factors k1, k2 of an elastic contact, and |r.p|. The velocities change by v1 += k1 r, v2 -=
    k2 r, and p is the transferred momentum. The velocity of a particle of infinite mass does not change;
    `exchange` has no value in this case.
    """
    if mass1 == np.inf:
        return rr - rr, (rv + rv) / rr, (mass2 + mass2) * abs(rv)
    if mass2 == np.inf:
        return (rv + rv) / rr, rr - rr, (mass1 + mass1) * abs(rv)
    k1, k2 = exchange(rr, rv, mass1, mass2)
    return k1, k2, (mass1 + mass1) * (mass2 / (mass1 + mass2)) * abs(rv)


@inner_helper
def record_contact(particles, slot, speed_squared, space, step, tally, cells):
    """Record a contact of a particle and all bounds; count it if it is not the first in this step."""
    tally.counts[MULTIPLE] += particles.last_pass[slot] >= step.first
    particles.last_pass[slot] = step.number
    raise_bounds(particles, slot, speed_squared, space, cells)


@inner_helper
def collide_smooth(particles, i, j, contact, model, tally):
    """Apply a collision to two smooth particles; return both squared speeds. `contact`: time of the contact,
    negative, and the invariants rr, rv at this time.
    """
    ago, rr, rv = contact
    space = model.space
    first, second = particles.index[i], particles.index[j]
    to_i, to_j, passed = impulse_factors(rr, rv, particles.masses[first], particles.masses[second])
    add(tally.sums, LOSS, 0.25 * (1.0 - model.normal * model.normal) * passed * abs(rv) / rr)
    to_i, to_j = to_i * model.impulse_share, to_j * model.impulse_share
    add(tally.sums, VIRIAL, passed * model.impulse_share)
    speed_i = speed_j = ago - ago
    for k in range(len(space.lengths)):
        gap = particles.positions[k, j] - particles.positions[k, i]
        r = nearest(gap, space.lengths[k], space.periodic[k])
        r += ago * (particles.velocities[k, j] - particles.velocities[k, i])
        particles.velocities[k, i] += to_i * r
        particles.velocities[k, j] -= to_j * r
        particles.positions[k, i] -= ago * (to_i * r)
        particles.positions[k, j] += ago * (to_j * r)
        speed_i += particles.velocities[k, i] * particles.velocities[k, i]
        speed_j += particles.velocities[k, j] * particles.velocities[k, j]
    return speed_i, speed_j


@inner_helper
def collide(particles, i, j, contact, model, tally, law):
    """Apply a collision, by the law if there is one; see `collide_smooth`."""
    if law is None:
        return collide_smooth(particles, i, j, contact, model, tally)
    return collide_flights(particles, i, j, contact, model.rules, tally, law)


@inner_helper
def count_fixed(particles, i, j, tally, fixed):
    """Count a contact with a fixed particle."""
    if fixed is not None:
        first, second = particles.masses[particles.index[i]], particles.masses[particles.index[j]]
        tally.counts[FIXED] += first == np.inf or second == np.inf


@inner_helper
def resolve(particles, i, j, model, step, tally, law, cells):
    """Resolve a pair, if it must still be resolved. The pair is rewound to its contact, exchanges momentum
    along the normal, and moves for the rest of the step with the new velocities.
    """
    space = model.space
    rr, rv, vv = invariants(particles, i, j, space)
    sigma = particles.radii[i] + particles.radii[j]
    ss = sigma * sigma
    if not must_resolve(rr, rv, vv, ss, step):
        return
    tally.extremes[DEEPEST] = max(tally.extremes[DEEPEST], 1.0 - np.sqrt(rr) / sigma)
    ago = rr - rr
    if step.rewind:
        ago = entry_time(rr, rv, vv, ss)
        if ago < -_LATE * step.dt:
            tally.counts[LATE] += 1
            if rr + rr + rr + rr < ss:
                tally.counts[PASSED] += 1
        rr += ago * (rv + rv + vv * ago)  # the invariants at the contact
        rv += ago * vv
        tally.extremes[WORST] = max(tally.extremes[WORST], abs(rr / ss - 1.0))
    tally.counts[COLLISIONS] += 1
    count_fixed(particles, i, j, tally, tally.fixed)
    before_i = place_and_speed(particles, i, ago, tally, tally.impulses)
    before_j = place_and_speed(particles, j, ago, tally, tally.impulses)
    speed_i, speed_j = collide(particles, i, j, (ago, rr, rv), model, tally, law)
    add_contact(particles, i, before_i, tally, tally.impulses)
    add_contact(particles, j, before_j, tally, tally.impulses)
    for k in range(len(space.lengths)):
        if step.rewind and space.periodic[k]:
            wrap(particles, i, k, space.lengths[k])
            wrap(particles, j, k, space.lengths[k])
    record_contact(particles, i, speed_i, space, step, tally, cells)
    record_contact(particles, j, speed_j, space, step, tally, cells)


@inner_helper
def fetch_particle(particles, slot, cells):
    """Prefetch the data that a contact of a particle reads."""
    for k in range(len(particles.positions)):
        fetch(particles.positions[k], slot)
        fetch(particles.velocities[k], slot)
        if cells is not None:
            fetch(cells.origin[k], slot)
    fetch(particles.radii, slot)
    fetch(particles.index, slot)
    fetch(particles.last_pass, slot)


@inner_helper
def fetch_ahead(particles, pairs, order, n, cells):
    """Prefetch the data of the contacts that follow order[n], while order[n] is resolved."""
    last = len(order) - 1
    for side in range(2):
        fetch_particle(particles, pairs[order[min(n + 2 * _AHEAD, last)], side], cells)
        fetch(particles.masses, particles.index[pairs[order[min(n + _AHEAD, last)], side]])


@inner_kernel
def resolve_all(particles, pairs, order, model, step, tally, law, cells):
    """Resolve the contacts of one search, in order."""
    for n in range(len(order)):
        fetch_ahead(particles, pairs, order, n, cells)
        i, j = pairs[order[n], 0], pairs[order[n], 1]
        resolve(particles, i, j, model, step, tally, law, cells)


@inner_kernel
def count_left(particles, pairs, space, tally):
    """Count the found pairs that still overlap and approach."""
    for n in range(len(pairs)):
        i, j = pairs[n, 0], pairs[n, 1]
        rr, rv, _ = invariants(particles, i, j, space)
        sigma = particles.radii[i] + particles.radii[j]
        if rr < sigma * sigma and rv < 0.0:
            tally.counts[OVERLAPS_LEFT] += 1
