"""Motion of the particles in one step: free flight, return through faces, and the new cells.

The free flight is a loop without branches. The particles of a block are examined one by one only if one of
them has left the container.
"""

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.dsmc.cells import count, leave_out_absent, locate
from gaspart.kernels.dsmc.model import FAR, kind_in, number_at, position_row, velocity_row
from gaspart.kernels.dsmc.walls import fly_among_faces
from gaspart.kernels.step.motion import fall, fly

_BLOCK = 128
_FURTHEST = 2.0**31  # periodic images are counted with 32 bits


@inner_helper
def wrap(particles, slot, axis, length, context):
    """Move a particle back into the container along a periodic axis. The counter FAR is increased if the
    number of periodic images is too large to be stored.
    """
    x = particles.data[position_row(particles, axis), slot]
    images = np.floor(x / length)
    if images != 0.0:
        x -= images * length
        if x >= length:  # a tiny negative x is rounded up to the length itself
            x -= length
            images += 1
        particles.data[position_row(particles, axis), slot] = x
        total = particles.images[axis, number_at(particles, slot)] + images
        if abs(total) < _FURTHEST:
            particles.images[axis, number_at(particles, slot)] = np.int32(total)
        else:
            context.workspace.counts[context.part, FAR] += 1


@inner_helper
def is_beyond(particles, slot, radius, space):
    """Return True if a particle is beyond a wall."""
    beyond = False
    for k in range(len(space.lengths)):
        if not space.periodic[k]:
            inset = space.margin * radius
            x = particles.data[position_row(particles, k), slot]
            beyond |= (x < inset) | (x > space.lengths[k] - inset)
    return beyond


@inner_kernel
def redo_flight_with_faces(particles, slot, which, context, gravity, faces, law):
    """Repeat the step of a particle that has crossed a wall, now including the faces. `which`: kind of the
    particle.
    """
    dt, flights = context.workspace.dt, context.workspace.flights[context.part]
    for k in range(len(context.space.lengths)):
        x = particles.data[position_row(particles, k), slot]
        v = particles.data[velocity_row(particles, k), slot]
        if gravity is None:
            x -= v * dt
        else:
            v -= gravity[k] * dt
            x -= (v + 0.5 * gravity[k] * dt) * dt
        flights[0].position[k], flights[0].velocity[k] = x, v
    flights[0].radius = context.workspace.radius[which]
    fly_among_faces(number_at(particles, slot), which, dt, context, gravity, faces, law)
    for k in range(len(context.space.lengths)):
        particles.data[position_row(particles, k), slot] = flights[0].position[k]
        particles.data[velocity_row(particles, k), slot] = flights[0].velocity[k]


@inner_helper
def bring_back_from_walls(particles, slots, context, gravity, faces, law):
    """Repeat the step of the particles that have crossed a wall; return their number. `slots`: first slot,
    and the end of the slots.
    """
    number = 0
    for slot in range(slots[0], slots[1]):
        which = kind_in(particles, slot, context.workspace)
        if is_beyond(particles, slot, context.workspace.radius[which], context.space):
            redo_flight_with_faces(particles, slot, which, context, gravity, faces, law)
            number += 1
    return number


@inner_helper
def wrap_all(particles, slots, axis, length, context):
    """Move the particles in some slots back into the container on a periodic axis."""
    row = position_row(particles, axis)
    for slot in range(slots[0], slots[1]):
        if not 0.0 <= particles.data[row, slot] < length:
            wrap(particles, slot, axis, length, context)


@inner_helper
def advance_axis(particles, slots, axis, limits, dt, gravity):
    """Move the particles in some slots along one axis; return the number outside the limits."""
    first, end = slots
    x = particles.data[position_row(particles, axis), first:end]
    v = particles.data[velocity_row(particles, axis), first:end]
    if gravity is None:
        return fly(x, v, limits[0], limits[1], dt)
    return fall(x, v, gravity[axis], limits[0], limits[1], dt)


@inner_kernel
def move(particles, slots, grid, context, gravity, faces, law):
    """Perform the motion of one step for one thread's slots, and count them in cells. `slots`: first slot,
    and the end of the slots.
    """
    space, dt = context.space, context.workspace.dt
    inset = space.margin * context.workspace.largest
    for start in range(slots[0], slots[1], _BLOCK):
        block = start, min(start + _BLOCK, slots[1])
        hits, crossed = 0, (0, 0, 0)
        for k in range(len(space.lengths)):
            lower = 0.0 if space.periodic[k] else inset
            limits = lower, space.lengths[k] - lower
            outside = advance_axis(particles, block, k, limits, dt, gravity)
            if space.periodic[k]:
                crossed = crossed[1], crossed[2], outside
            else:
                crossed, hits = (crossed[1], crossed[2], 0), hits + outside
        if hits > 0:
            hits = bring_back_from_walls(particles, block, context, gravity, faces, law)
        for k in range(len(space.lengths)):
            if space.periodic[k] and crossed[3 - len(space.lengths) + k] + hits > 0:
                wrap_all(particles, block, k, space.lengths[k], context)
        locate(particles, block[0], block[1], grid)
    if faces is not None:
        leave_out_absent(particles, slots[0], slots[1], grid, faces.present)
    count(slots[0], slots[1], context.part, grid)
