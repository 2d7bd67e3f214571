"""Motion of the particles in one step: free flight, then return through faces.

A face is a periodic face or a wall. The free flight is a loop without branches. The particles of a block are
tested one by one only if one of them has left the container.
"""

import numpy as np

from gaspart.kernels.compile.policy import inner_allocating_kernel, inner_helper, inner_kernel
from gaspart.kernels.physics.periodic import nearest
from gaspart.kernels.physics.running_sum import add_whole
from gaspart.kernels.step.boundaries import add_reflection, add_share, is_free, meet_faces
from gaspart.kernels.step.model import DISPLACEMENT, FASTEST

_BLOCK = 128


@inner_helper
def wrap(particles, slot, axis, length):
    """Move a particle back into the container along a periodic axis."""
    x = particles.positions[axis, slot]
    if 0.0 <= x < length:
        return
    images = np.floor(x / length)
    if images != 0.0:
        x -= images * length
        if x >= length:  # a tiny negative x is rounded up to the length itself
            x -= length
            images += 1
        particles.positions[axis, slot] = x
        particles.images[axis, particles.index[slot]] += int(images)


@inner_helper
def reflect(particles, slot, axis, planes, model, tally, thread):
    """Reflect a particle that left through a wall, as long as it moves outwards. `planes`: (lower, upper)."""
    lower, upper = planes
    x = particles.positions[axis, slot]
    v = particles.velocities[axis, slot]
    while (x < lower and v < 0.0) or (x > upper and v > 0.0):
        side = 0 if x < lower else 1
        plane = upper if side else lower
        impulse = 2.0 * model.impulse_share * particles.masses[particles.index[slot]] * abs(v)
        tally.wall_hits[thread, 2 * axis + side] += 1
        add_whole(tally.wall_impulse[thread, 2 * axis + side], impulse, tally.momentum)
        add_share(particles.index[slot], 2 * axis + side, (impulse, 0.0), tally, thread, tally.per_area)
        if model.normal == 1.0:
            x = plane + plane - x
        else:  # it crossed the plane a time |x - plane| / |v| ago
            x = plane + model.normal * (plane - x)
            lost = 0.5 * impulse * abs(v) * (1.0 - model.normal)
            add_whole(tally.wall_loss[thread], lost, tally.energy)
        at = plane, -v * model.normal - v
        add_reflection(particles, slot, axis, at, tally, thread, tally.impulses)
        v = -v * model.normal
    particles.positions[axis, slot] = x
    particles.velocities[axis, slot] = v


@inner_kernel
def reflect_falling(particles, slot, axis, planes, pull, dt, tally, thread):
    """Reflect a particle that left through a wall under gravity. The particle is moved back along its
    parabola to the plane, and continues from there with its speed at the plane. y is the height over the
    plane, u its rate of change and a the acceleration, all directed inwards. y = u s + a s^2/2 gives the time
    s since the particle crossed the plane (Spencer 2022, Eq. 14, in the form without cancellation), and w^2 =
    u^2 - 2 a y its speed there. Bounces that fit into the rest of the step are performed at once.
    """
    lower, upper = planes
    x = particles.positions[axis, slot]
    v = particles.velocities[axis, slot]
    half = dt / (dt + dt)
    while x < lower or x > upper:
        side = 0 if x < lower else 1
        y, u, a = (upper - x, -v, -pull) if side else (x - lower, v, pull)
        square = u * u - (y + y) * a
        if square < 0.0:  # pushed out by a contact, and too slow to have crossed by itself
            if u < 0.0:
                at = x, -v - v
                add_reflection(particles, slot, axis, at, tally, thread, tally.impulses)
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
        impulse = 2.0 * hits * particles.masses[particles.index[slot]] * w
        tally.wall_hits[thread, 2 * axis + side] += hits
        add_whole(tally.wall_impulse[thread, 2 * axis + side], impulse, tally.momentum)
        add_share(particles.index[slot], 2 * axis + side, (impulse, 0.0), tally, thread, tally.per_area)
        u = w + a * s
        y = max(y - y, half * (w + u) * s)
        at = upper if side else lower, (-u if side else u) - v
        add_reflection(particles, slot, axis, at, tally, thread, tally.impulses)
        x, v = (upper - y, -u) if side else (lower + y, u)
    particles.positions[axis, slot] = x
    particles.velocities[axis, slot] = v


@inner_helper
def displacement_since_rebuild(particles, slot, cells, space):
    """Return the distance of a particle from its position when the neighbour list was made."""
    square = space.margin - space.margin
    for k in range(len(space.lengths)):
        gap = particles.positions[k, slot] - cells.origin[k, slot]
        gap = nearest(gap, space.lengths[k], space.periodic[k])
        square += gap * gap
    return np.sqrt(square)


@inner_helper
def raise_bounds(particles, slot, speed_squared, space, cells):
    """Update the bounds of all particles after a change of one particle."""
    bounds = particles.bounds
    bounds[FASTEST] = max(bounds[FASTEST], np.sqrt(speed_squared))
    if cells is not None:
        if slot < particles.ordinary:
            gap = displacement_since_rebuild(particles, slot, cells, space)
            bounds[DISPLACEMENT] = max(bounds[DISPLACEMENT], gap)


@inner_kernel
def apply_rules(particles, slot, model, dt, tally, rules, law, cells):
    """Move one particle back into a container whose walls have special rules."""
    met = meet_faces(particles, slot, rules, dt, tally, law)
    space = model.space
    square = dt - dt
    for k in range(len(space.lengths)):
        if space.periodic[k]:
            wrap(particles, slot, k, space.lengths[k])
        square += particles.velocities[k, slot] * particles.velocities[k, slot]
    if met:
        raise_bounds(particles, slot, square, space, cells)


@inner_kernel
def apply_boundaries(particles, slot, model, dt, tally, thread, gravity):
    """Move one particle back into the container."""
    space = model.space
    inset = space.margin * particles.radii[slot]
    for k in range(len(space.lengths)):
        planes = inset, space.lengths[k] - inset
        if space.periodic[k]:
            wrap(particles, slot, k, space.lengths[k])
        elif gravity is None:
            reflect(particles, slot, k, planes, model, tally, thread)
        else:
            reflect_falling(particles, slot, k, planes, gravity[k], dt, tally, thread)


@inner_helper
def is_outside(particles, slot, space, inset):
    """Return True if an ordinary particle may have left the container."""
    outside = False
    for k in range(len(space.lengths)):
        x = particles.positions[k, slot]
        lower = inset - inset if space.periodic[k] else inset
        outside |= (x < lower) | (x >= space.lengths[k] - lower)
    return outside


@inner_kernel
def fly(x, v, lower, upper, dt):
    """Move particles along one axis; return the number of particles outside [lower, upper)."""
    outside = 0
    for n in range(len(x)):
        moved = x[n] + v[n] * dt
        x[n] = moved
        outside += (moved < lower) | (moved >= upper)
    return outside


@inner_kernel
def fall(x, v, pull, lower, upper, dt):
    """Move particles along one axis, along exact parabolas; return the number outside [lower, upper)."""
    outside = 0
    gain = pull * dt
    drop = dt / (dt + dt) * gain * dt
    for n in range(len(x)):
        moved = x[n] + v[n] * dt + drop
        x[n] = moved
        v[n] += gain
        outside += (moved < lower) | (moved >= upper)
    return outside


@inner_helper
def advance_axis(particles, slots, axis, limits, dt, gravity):
    """Move the particles in `slots` (2,) along one axis; return the number outside limits (2,)."""
    x = particles.positions[axis, slots[0] : slots[1]]
    v = particles.velocities[axis, slots[0] : slots[1]]
    if gravity is None:
        return fly(x, v, limits[0], limits[1], dt)
    return fall(x, v, gravity[axis], limits[0], limits[1], dt)


@inner_kernel
def move_by_rules(particles, model, dt, tally, rules, law, cells, gravity):
    """Perform the motion of one step if walls have special rules."""
    count = particles.positions.shape[1]
    for start in range(0, count, _BLOCK):
        stop = min(start + _BLOCK, count)
        outside = 0
        for k in range(len(model.space.lengths)):
            limits = rules.free[k, 0], rules.free[k, 1]
            outside += advance_axis(particles, (start, stop), k, limits, dt, gravity)
        if outside > 0 or rules.holds or stop > particles.ordinary:
            for slot in range(start, stop):
                if slot >= particles.ordinary or not is_free(particles, slot, rules):
                    apply_rules(particles, slot, model, dt, tally, rules, law, cells)


@inner_kernel
def move(particles, slots, model, dt, tally, thread, gravity):
    """Perform the motion of one step for the slots from slots[0] to slots[1]."""
    space, inset = model.space, model.inset
    start, end = slots
    while start < end:
        stop = min(start + _BLOCK, end)
        outside = 0
        for k in range(len(space.lengths)):
            lower = dt - dt if space.periodic[k] else inset
            limits = lower, space.lengths[k] - lower
            outside += advance_axis(particles, (start, stop), k, limits, dt, gravity)
        if outside > 0 or stop > particles.ordinary:
            for slot in range(start, stop):
                if slot >= particles.ordinary or is_outside(particles, slot, space, inset):
                    apply_boundaries(particles, slot, model, dt, tally, thread, gravity)
        start = stop


@inner_kernel
def add_squares(values, squares):
    """Add the squares of values (n,) to `squares` (n,)."""
    for n in range(len(values)):
        squares[n] += values[n] * values[n]


@inner_kernel
def add_gaps(x, origin, length, squares):
    """Add squared distances of coordinates x (n,) from their origin, on an axis with a period."""
    for n in range(len(x)):
        gap = abs(x[n] - origin[n])
        gap = min(gap, abs(length - gap))
        squares[n] += gap * gap


@inner_kernel
def highest(squares, most):
    """Return the maximum of some values (n,) and `most`. Values are compared one by one only if one of them
    exceeds `most`, because each comparison must wait for the previous one.
    """
    above = 0
    for square in squares:
        above += square > most
    if above > 0:
        for square in squares:
            most = max(most, square)
    return most


@inner_allocating_kernel
def fastest_part(particles, slots):
    """Return the highest squared speed of the particles in the slots from slots[0] to slots[1]."""
    room = np.empty(_BLOCK, particles.velocities.dtype)
    most = particles.velocities[0, 0] - particles.velocities[0, 0]
    for low in range(slots[0], slots[1], _BLOCK):
        high = min(low + _BLOCK, slots[1])
        squares = room[: high - low]
        squares[:] = 0
        for k in range(len(particles.velocities)):
            add_squares(particles.velocities[k, low:high], squares)
        most = highest(squares, most)
    return most


@inner_allocating_kernel
def displacement_part(particles, slots, cells, space):
    """Return the largest squared displacement of some slots since the neighbour list was made. `slots`: first
    slot, and the end of the slots.
    """
    room = np.empty(_BLOCK, particles.positions.dtype)
    most = space.margin - space.margin
    for low in range(slots[0], slots[1], _BLOCK):
        high = min(low + _BLOCK, slots[1])
        squares = room[: high - low]
        squares[:] = 0
        for k in range(len(space.lengths)):
            length = space.lengths[k] if space.periodic[k] else np.inf
            add_gaps(particles.positions[k, low:high], cells.origin[k, low:high], length, squares)
        most = highest(squares, most)
    return most
