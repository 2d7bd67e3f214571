"""How bodies move in one step: freely, then back into the container through its periodic faces or walls.

The free flight is a loop without branches; a block of bodies is looked at again only if somebody left the
container in it.
"""

import numpy as np

from gaspart.coordinates import nearest
from gaspart.engines.running_sum import add_whole
from gaspart.engines.step_layout import FASTEST, SPENT
from gaspart.engines.step_rules import is_free, meet_faces
from gaspart.kernel import allocating_kernel, helper, kernel

_BLOCK = 128


@helper
def wrap(bodies, slot, axis, length):
    """Bring a body back into the container on a periodic axis."""
    x = bodies.positions[axis, slot]
    if 0.0 <= x < length:
        return
    laps = np.floor(x / length)
    if laps != 0.0:
        x -= laps * length
        if x >= length:  # a tiny negative x rounds up to the length itself
            x -= length
            laps += 1
        bodies.positions[axis, slot] = x
        bodies.images[axis, bodies.index[slot]] += int(laps)


@helper
def reflect(bodies, space, slot, axis, lower, upper, counters, thread):
    """Mirror a body that left through a wall, as long as it moves outward."""
    x = bodies.positions[axis, slot]
    v = bodies.velocities[axis, slot]
    while (x < lower and v < 0.0) or (x > upper and v > 0.0):
        side = 0 if x < lower else 1
        plane = upper if side else lower
        impulse = 2.0 * space.push * bodies.masses[bodies.index[slot]] * abs(v)
        counters.wall_hits[thread, 2 * axis + side] += 1
        add_whole(counters.wall_impulse[thread, 2 * axis + side], impulse, counters.momentum)
        if space.normal == 1.0:
            x = plane + plane - x
        else:  # it came through |x - plane| / |v| ago
            x = plane + space.normal * (plane - x)
            lost = 0.5 * impulse * abs(v) * (1.0 - space.normal)
            add_whole(counters.wall_loss[thread], lost, counters.energy)
        v = -v * space.normal
    bodies.positions[axis, slot] = x
    bodies.velocities[axis, slot] = v


@kernel
def reflect_falling(bodies, slot, axis, lower, upper, pull, dt, counters, thread):
    """The same under a pull: back along the parabola to the plane, and on from there with the speed it had.

    y is the height over the plane, u its rate and a the pull, all counted inward. y = u s + a s^2/2 tells
    how long ago, s, the body crossed the plane (Spencer 2022, Eq. 14, in the form that does not cancel), and
    w^2 = u^2 - 2 a y how fast. Bounces that fit into what is left of the step are made at once.
    """
    x = bodies.positions[axis, slot]
    v = bodies.velocities[axis, slot]
    half = dt / (dt + dt)
    while x < lower or x > upper:
        side = 0 if x < lower else 1
        y, u, a = (upper - x, -v, -pull) if side else (x - lower, v, pull)
        square = u * u - (y + y) * a
        if square < 0.0:  # pushed out by a contact, too slow to have come through by itself
            if u < 0.0:
                v = -v
            break
        w = np.sqrt(square)
        s = (y + y) / (u - w)
        if u >= 0.0 and not (a > 0.0 and s <= dt):
            break
        hits = 1
        if a < 0.0 and w > 0.0:
            bounces = np.floor(s * -a / (w + w))
            s -= bounces * (w + w) / -a
            hits += int(bounces)
        impulse = 2.0 * hits * bodies.masses[bodies.index[slot]] * w
        counters.wall_hits[thread, 2 * axis + side] += hits
        add_whole(counters.wall_impulse[thread, 2 * axis + side], impulse, counters.momentum)
        u = w + a * s
        y = max(y - y, half * (w + u) * s)
        x, v = (upper - y, -u) if side else (lower + y, u)
    bodies.positions[axis, slot] = x
    bodies.velocities[axis, slot] = v


@helper
def strayed(bodies, space, cells, slot):
    """How far a body is from where it was when the list was made."""
    square = space.margin - space.margin
    for k in range(len(space.lengths)):
        gap = bodies.positions[k, slot] - cells.origin[k, slot]
        gap = nearest(gap, space.lengths[k], space.periodic[k])
        square += gap * gap
    return np.sqrt(square)


@helper
def note_change(bodies, space, slot, speed_squared, cells, watch):
    """Remember how fast a body is now, and how far from where it was when the list was made."""
    watch.reach[FASTEST] = max(watch.reach[FASTEST], np.sqrt(speed_squared))
    if cells is not None:
        if slot < bodies.ordinary:
            watch.reach[SPENT] = max(watch.reach[SPENT], strayed(bodies, space, cells, slot))


@kernel
def mend_by_rules(bodies, space, slot, dt, rules, law, cells, watch, counters):
    """Bring one body back into the container whose walls have rules of their own."""
    met = meet_faces(bodies, space, rules, law, slot, dt, counters)
    square = dt - dt
    for k in range(len(space.lengths)):
        if space.periodic[k]:
            wrap(bodies, slot, k, space.lengths[k])
        square += bodies.velocities[k, slot] * bodies.velocities[k, slot]
    if met:
        note_change(bodies, space, slot, square, cells, watch)


@kernel
def mend(bodies, space, gravity, slot, dt, counters, thread):
    """Bring one body back into the container."""
    inset = space.margin * bodies.radii[slot]
    for k in range(len(space.lengths)):
        if space.periodic[k]:
            wrap(bodies, slot, k, space.lengths[k])
        else:
            upper = space.lengths[k] - inset
            if gravity is None:
                reflect(bodies, space, slot, k, inset, upper, counters, thread)
            else:
                reflect_falling(bodies, slot, k, inset, upper, gravity[k], dt, counters, thread)


@helper
def is_outside(bodies, space, inset, slot):
    """Whether an ordinary body may need to be mended."""
    outside = False
    for k in range(len(space.lengths)):
        x = bodies.positions[k, slot]
        lower = inset - inset if space.periodic[k] else inset
        outside |= (x < lower) | (x >= space.lengths[k] - lower)
    return outside


@kernel
def fly(x, v, lower, upper, dt):
    """Move bodies along one axis; the number that are not in [lower, upper) then."""
    outside = 0
    for n in range(len(x)):
        moved = x[n] + v[n] * dt
        x[n] = moved
        outside += (moved < lower) | (moved >= upper)
    return outside


@kernel
def fall(x, v, pull, lower, upper, dt):
    """The same under a pull: exactly along the parabola."""
    outside = 0
    gain = pull * dt
    drop = dt / (dt + dt) * gain * dt
    for n in range(len(x)):
        moved = x[n] + v[n] * dt + drop
        x[n] = moved
        v[n] += gain
        outside += (moved < lower) | (moved >= upper)
    return outside


@kernel
def move_by_rules(bodies, space, gravity, dt, rules, law, cells, watch, counters):
    """Make the motion of one step where walls have rules of their own."""
    count = bodies.positions.shape[1]
    for start in range(0, count, _BLOCK):
        stop = min(start + _BLOCK, count)
        outside = 0
        for k in range(len(space.lengths)):
            x = bodies.positions[k, start:stop]
            v = bodies.velocities[k, start:stop]
            if gravity is None:
                outside += fly(x, v, rules.free[k, 0], rules.free[k, 1], dt)
            else:
                outside += fall(x, v, gravity[k], rules.free[k, 0], rules.free[k, 1], dt)
        if outside > 0 or rules.holds or stop > bodies.ordinary:
            for slot in range(start, stop):
                if slot >= bodies.ordinary or not is_free(bodies, rules, slot):
                    mend_by_rules(bodies, space, slot, dt, rules, law, cells, watch, counters)


@kernel
def move(bodies, space, gravity, inset, dt, low, high, counters, thread):
    """Make the motion of one step for the slots from `low` to `high`. inset: the largest distance from a
    wall at which an ordinary body may need to be mended."""
    start = low
    while start < high:
        stop = min(start + _BLOCK, high)
        outside = 0
        for k in range(len(space.lengths)):
            x = bodies.positions[k, start:stop]
            v = bodies.velocities[k, start:stop]
            lower = dt - dt if space.periodic[k] else inset
            upper = space.lengths[k] - lower
            if gravity is None:
                outside += fly(x, v, lower, upper, dt)
            else:
                outside += fall(x, v, gravity[k], lower, upper, dt)
        if outside > 0 or stop > bodies.ordinary:
            for slot in range(start, stop):
                if slot >= bodies.ordinary or is_outside(bodies, space, inset, slot):
                    mend(bodies, space, gravity, slot, dt, counters, thread)
        start = stop


@kernel
def add_squares(values, squares):
    """Add the squares of some values (n,) to others (n,)."""
    for n in range(len(values)):
        squares[n] += values[n] * values[n]


@kernel
def add_gaps(x, origin, length, squares):
    """Add the squares of how far coordinates x (n,) are from others, on an axis of that period."""
    for n in range(len(x)):
        gap = abs(x[n] - origin[n])
        gap = min(gap, abs(length - gap))
        squares[n] += gap * gap


@kernel
def highest(squares, most):
    """The highest of some values (n,), or `most`: looked at one by one only if it is among them, since a
    maximum must wait for the one before."""
    above = 0
    for square in squares:
        above += square > most
    if above > 0:
        for square in squares:
            most = max(most, square)
    return most


@allocating_kernel
def note_fastest(bodies, watch):
    """Measure the highest speed of any body."""
    count = bodies.velocities.shape[1]
    room = np.empty(_BLOCK, bodies.velocities.dtype)
    most = bodies.velocities[0, 0] - bodies.velocities[0, 0]
    for low in range(0, count, _BLOCK):
        high = min(low + _BLOCK, count)
        squares = room[: high - low]
        squares[:] = 0
        for k in range(len(bodies.velocities)):
            add_squares(bodies.velocities[k, low:high], squares)
        most = highest(squares, most)
    watch.reach[FASTEST] = np.sqrt(most)


@allocating_kernel
def note_spent(bodies, space, cells, watch):
    """Measure how far any ordinary body is from where it was when the list was made."""
    room = np.empty(_BLOCK, bodies.positions.dtype)
    most = space.margin - space.margin
    for low in range(0, bodies.ordinary, _BLOCK):
        high = min(low + _BLOCK, bodies.ordinary)
        squares = room[: high - low]
        squares[:] = 0
        for k in range(len(space.lengths)):
            length = space.lengths[k] if space.periodic[k] else np.inf
            add_gaps(bodies.positions[k, low:high], cells.origin[k, low:high], length, squares)
        most = highest(squares, most)
    watch.reach[SPENT] = np.sqrt(most)
