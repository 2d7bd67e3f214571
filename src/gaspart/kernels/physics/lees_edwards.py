"""A gas whose periodic images slide (Lees & Edwards, J. Phys. C 5, 1921 (1972)).

Images above the container are displaced along the flow, axis 0, by what a flow of one shear rate has carried
them since time 0, and images below by as much against it; their velocities differ by that of this motion.
"""

from math import copysign, inf

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.physics.contact import time_to_contact
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add

FLOW, GRADIENT = 0, 1  # as in `scene.faces`, which kernels do not import
UPPER_FACE = 2 * GRADIENT + 1


@inner_helper
def displacement(time, shear):
    """How far images above are displaced at a time on the clocks, but for whole lengths of the container."""
    return shear.origin[0] + shear.velocity * time


@inner_helper
def flow_at(y, space, shear):
    """The velocity of the flow at a height: 0 in the middle."""
    return shear.rate * (y - 0.5 * space.lengths[GRADIENT])


@inner_kernel
def cross_sheared(particles, i, upper, mass, space, tally, shear):
    """Let a particle that has come to a sheared face have the place along the flow, and the velocity, of its
    image that enters. The energy that it loses is that which the face takes."""
    flights, side, length = particles.flights, 1.0 if upper else -1.0, space.lengths[FLOW]
    x = flights[i].position[FLOW] - side * displacement(flights[i].clock, shear)
    turns = np.floor(x / length)
    flights[i].position[FLOW] = min(max(x - turns * length, 0.0), length)
    particles.images[i, FLOW] += np.int64(turns) - np.int64(side) * shear.turns[0]
    before = flights[i].velocity[FLOW]
    after = before - side * shear.velocity
    flights[i].velocity[FLOW] = after
    add(tally.wall_energy, UPPER_FACE, 0.5 * mass * (before + after) * (before - after))


@inner_helper
def shift_image(particles, i, axis, upper, model, tally, shear):
    """The same at any periodic face, if it is sheared."""
    if shear is not None:
        if axis == GRADIENT:
            mass = mass_of(i, model.masses, model.law)
            cross_sheared(particles, i, upper, mass, model.space, tally, shear)


@inner_kernel
def time_of_sheared_contact(flights, i, j, image, offset, space, shear):
    """When particles i and j touch, j in the images above (`image` 1) or below (-1), whichever it is along
    the flow; inf if they do not. offset: its displacement along a third axis.

    No image is touched before the centres' distance across the flow is that of a contact, and then either the
    nearest one or the next that comes: that is at this distance still when it passes, or none is.
    """
    start = max(flights[i].clock, flights[j].clock)
    late_i, late_j = start - flights[i].clock, start - flights[j].clock
    rr = rv = vv = 0.0
    along = speed = 0.0
    for k in range(len(space.lengths)):
        v_i, v_j = flights[i].velocity[k], flights[j].velocity[k]
        v = v_j - v_i
        r = (flights[j].position[k] + v_j * late_j) - (flights[i].position[k] + v_i * late_i)
        if k == FLOW:
            along, speed = r + image * displacement(start, shear), v + image * shear.velocity
        else:
            r += image * space.lengths[k] if k == GRADIENT else offset
            rr += r * r
            rv += r * v
            vv += v * v
    sigma = flights[i].radius + flights[j].radius
    ss = sigma * sigma
    if rr > ss:
        near = time_to_contact(rr, rv, vv, ss)
        if near == inf:
            return inf
        start += near
        along += speed * near
        rr, rv = ss, rv + vv * near
    length = space.lengths[FLOW]
    r = along - length * np.rint(along / length)
    soon = time_to_contact(rr + r * r, rv + r * speed, vv + speed * speed, ss)
    r -= copysign(length, speed)
    later = time_to_contact(rr + r * r, rv + r * speed, vv + speed * speed, ss)
    return start + min(soon, later)
