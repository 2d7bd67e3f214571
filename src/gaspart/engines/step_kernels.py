"""One small step after another: the kernels of the time-stepped engine.

A step moves all bodies, reflects those that left through a wall, finds all pairs that overlap and approach,
and resolves them in the order of their contact time and indices, testing each again. That order does not
depend on the boxes, so neither does any bit of the result. All arithmetic keeps the precision of the
positions (float32 or float64): hence dt - dt for 0 and x + x for 2x.
"""

from typing import NamedTuple

import numpy as np

from gaspart.boxes import box_coordinate, nearest
from gaspart.contact import contact_root, exchange, exchange_equal
from gaspart.kernel import allocating_kernel, helper, kernel

COLLISIONS, PAIR_TESTS, BOX_VISITS, OVERLAPS_LEFT, MULTIPLE = range(5)
VIRIAL, DEEPEST, WORST = range(3)


class Space(NamedTuple):
    """lengths (d,), periodic (d,); margin: 1 if walls stop surfaces, 0 if they stop centres."""

    lengths: tuple
    periodic: tuple
    margin: float


class Bodies(NamedTuple):
    """positions, velocities, images (N, d); radii (N,)."""

    positions: np.ndarray
    velocities: np.ndarray
    images: np.ndarray
    radii: np.ndarray


class Partition(NamedTuple):
    """The grid of boxes (see `boxes.Boxes`), each body's box coordinates at (N, 3), and the boxes' lists."""

    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray
    at: np.ndarray
    head: np.ndarray
    following: np.ndarray


class Counters(NamedTuple):
    """counts (5,), sums (3,), wall_hits (2d,), wall_impulse (2d,); see the names at the module's top."""

    counts: np.ndarray
    sums: np.ndarray
    wall_hits: np.ndarray
    wall_impulse: np.ndarray


@helper
def wrap(bodies, body, axis, length):
    """Bring a body back into the container on a periodic axis."""
    x = bodies.positions[body, axis]
    laps = np.floor(x / length)
    if laps != 0.0:
        x -= laps * length
        if x >= length:  # a tiny negative x rounds up to the length itself
            x -= length
            laps += 1
        bodies.positions[body, axis] = x
        bodies.images[body, axis] += int(laps)


@helper
def reflect(bodies, body, axis, lower, upper, mass, counters):
    """Mirror a body that left through a wall, as long as it moves outward."""
    x = bodies.positions[body, axis]
    v = bodies.velocities[body, axis]
    while (x < lower and v < 0.0) or (x > upper and v > 0.0):
        side = 0 if x < lower else 1
        plane = upper if side else lower
        x = plane + plane - x
        counters.wall_hits[2 * axis + side] += 1
        counters.wall_impulse[2 * axis + side] += 2.0 * mass * abs(v)
        v = -v
    bodies.positions[body, axis] = x
    bodies.velocities[body, axis] = v


@kernel
def stream(bodies, space, masses, dt, counters):
    """Move all bodies freely for one step, and keep them in the container."""
    for body in range(len(bodies.positions)):
        mass = 1.0 if masses is None else masses[body]
        inset = space.margin * bodies.radii[body]
        for k in range(len(space.lengths)):
            bodies.positions[body, k] += bodies.velocities[body, k] * dt
            if space.periodic[k]:
                wrap(bodies, body, k, space.lengths[k])
            else:
                reflect(bodies, body, k, inset, space.lengths[k] - inset, mass, counters)


@kernel
def sort_in(positions, partition, dimension):
    """Put all bodies into the lists of their boxes."""
    partition.head[:] = -1
    for body in range(len(positions)):
        box = 0
        for k in range(dimension):
            c = box_coordinate(positions[body, k], partition.widths[k], partition.per_side[k])
            partition.at[body, k] = c
            box += c * partition.strides[k]
        partition.following[body] = partition.head[box]
        partition.head[box] = body


@helper
def invariants(bodies, space, i, j):
    """rr, rv, vv of a pair (see `contact`), j by its nearest image."""
    rr = rv = vv = space.margin - space.margin
    for k in range(len(space.lengths)):
        gap = bodies.positions[j, k] - bodies.positions[i, k]
        r = nearest(gap, space.lengths[k], space.periodic[k])
        v = bodies.velocities[j, k] - bodies.velocities[i, k]
        rr += r * r
        rv += r * v
        vv += v * v
    return rr, rv, vv


@helper
def examine(bodies, space, i, j, pairs, times, found, counters):
    """Test one pair; write it down if it overlaps and approaches. Returns the number found so far."""
    rr, rv, vv = invariants(bodies, space, i, j)
    sigma = bodies.radii[i] + bodies.radii[j]
    if rr < sigma * sigma and rv < 0.0:
        if found < len(times):
            pairs[found, 0] = min(i, j)
            pairs[found, 1] = max(i, j)
            times[found] = contact_root(rr, rv, vv, sigma * sigma)
        counters.sums[DEEPEST] = max(counters.sums[DEEPEST], 1.0 - np.sqrt(rr) / sigma)
        found += 1
    return found


@kernel
def find_overlaps(bodies, space, partition, pairs, times, counters):
    """Write down all pairs that overlap and approach, each once: the rest of the body's own box first, then
    the neighbouring boxes of higher index. Returns their number, which may exceed the room in `pairs`."""
    found = 0
    tests = 0
    visits = 0
    for i in range(len(bodies.positions)):
        ax, ay, az = partition.at[i, 0], partition.at[i, 1], partition.at[i, 2]
        own = ax * partition.strides[0] + ay * partition.strides[1] + az * partition.strides[2]
        visits += 1
        j = partition.following[i]
        while j >= 0:
            tests += 1
            found = examine(bodies, space, i, j, pairs, times, found, counters)
            j = partition.following[j]
        for dz in range(3):
            z = partition.neighbour[2, az, dz]
            if z < 0:
                continue
            for dy in range(3):
                y = partition.neighbour[1, ay, dy]
                if y < 0:
                    continue
                for dx in range(3):
                    x = partition.neighbour[0, ax, dx]
                    if x < 0 or x + y + z <= own:
                        continue
                    visits += 1
                    j = partition.head[x + y + z]
                    while j >= 0:
                        tests += 1
                        found = examine(bodies, space, i, j, pairs, times, found, counters)
                        j = partition.following[j]
    counters.counts[PAIR_TESTS] += tests
    counters.counts[BOX_VISITS] += visits
    return found


@allocating_kernel
def in_order(pairs, times, count):
    """The order in which contacts are resolved: by time, then lower index, then higher index."""
    key = pairs[:, 0] * count + pairs[:, 1]
    by_index = np.argsort(key, kind="mergesort")
    return by_index[np.argsort(times[by_index], kind="mergesort")]


@kernel
def resolve(bodies, space, masses, i, j, rewind, counters):
    """Collide a pair, if it still overlaps and approaches: rewind it to its contact, pass the momentum along
    the normal at contact, and play the rest of the step with the new velocities. True if it collided."""
    rr, rv, vv = invariants(bodies, space, i, j)
    sigma = bodies.radii[i] + bodies.radii[j]
    ss = sigma * sigma
    if not (rr < ss and rv < 0.0):
        return False
    ago = rr - rr
    if rewind:
        ago = contact_root(rr, rv, vv, ss)
        rr += ago * (rv + rv + vv * ago)  # the invariants as they were at the contact
        rv += ago * vv
        counters.sums[WORST] = max(counters.sums[WORST], abs(rr / ss - 1.0))
    if masses is None:
        to_i = to_j = exchange_equal(rr, rv)
        counters.sums[VIRIAL] += abs(rv)
    else:
        to_i, to_j = exchange(rr, rv, masses[i], masses[j])
        counters.sums[VIRIAL] += masses[i] * abs(to_i) * rr
    for k in range(len(space.lengths)):
        gap = bodies.positions[j, k] - bodies.positions[i, k]
        r = nearest(gap, space.lengths[k], space.periodic[k])
        r += ago * (bodies.velocities[j, k] - bodies.velocities[i, k])
        bodies.velocities[i, k] += to_i * r
        bodies.velocities[j, k] -= to_j * r
        bodies.positions[i, k] -= ago * (to_i * r)
        bodies.positions[j, k] += ago * (to_j * r)
        if rewind and space.periodic[k]:
            wrap(bodies, i, k, space.lengths[k])
            wrap(bodies, j, k, space.lengths[k])
    counters.counts[COLLISIONS] += 1
    return True


@allocating_kernel
def run_steps(bodies, space, partition, masses, dt, steps, rewind, counters):
    """Make `steps` steps of length `dt`. masses: (N,), or None if all are 1."""
    count, dimension = bodies.positions.shape
    pairs = np.empty((count + 16, 2), np.int64)
    times = np.empty(count + 16, bodies.positions.dtype)
    last_met = np.full(count, -1, np.int64)
    for step in range(steps):
        stream(bodies, space, masses, dt, counters)
        sort_in(bodies.positions, partition, dimension)
        found = find_overlaps(bodies, space, partition, pairs, times, counters)
        if found > len(times):
            pairs = np.empty((2 * found, 2), np.int64)
            times = np.empty(2 * found, bodies.positions.dtype)
            found = find_overlaps(bodies, space, partition, pairs, times, counters)
        order = in_order(pairs[:found], times[:found], count)
        for n in order:
            i, j = pairs[n]
            if resolve(bodies, space, masses, i, j, rewind, counters):
                for body in (i, j):
                    if last_met[body] == step:
                        counters.counts[MULTIPLE] += 1
                    last_met[body] = step
        for n in range(found):
            i, j = pairs[n]
            rr, rv, _ = invariants(bodies, space, i, j)
            sigma = bodies.radii[i] + bodies.radii[j]
            if rr < sigma * sigma and rv < 0.0:
                counters.counts[OVERLAPS_LEFT] += 1
