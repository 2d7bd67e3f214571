"""Sheared gas with sliding periodic images (Lees & Edwards, J. Phys. C 5, 1921 (1972)).

Images above the container are displaced along the flow, axis 0, by the distance that a flow of constant shear
rate has moved them since time 0. Images below are displaced by the same distance in the opposite direction.
The velocities of images differ by the velocity of this motion.
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
    """Return the displacement of the images above at a clock time, modulo the container's length."""
    return shear.origin[0] + shear.velocity * time


@inner_helper
def flow_at(y, space, shear):
    """Return the velocity of the flow at a height, which is 0 in the middle."""
    return shear.rate * (y - 0.5 * space.lengths[GRADIENT])


@inner_kernel
def cross_sheared(particles, i, upper, mass, space, tally, shear):
    """Give a particle at a sheared face the position and velocity of its image that enters. The energy that
    the particle loses is tallied as energy given to the face.
    """
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
    """Perform `cross_sheared` if a periodic face is sheared."""
    if shear is not None:
        if axis == GRADIENT:
            mass = mass_of(i, model.masses, model.law)
            cross_sheared(particles, i, upper, mass, model.space, tally, shear)


@inner_kernel
def time_of_sheared_contact(flights, i, j, image, offset, space, shear):
    """Return the time at which two particles touch across a sheared face, or inf. Particle j is in the images
    above (`image` 1) or below (-1), in any of the images along the flow. No image is touched before the
    distance of the centres across the flow equals the contact distance. At that time only the nearest image
    and the next arriving image matter. Either the contact is with one of them, which is still at this
    distance when it passes, or there is no contact. `offset`: displacement of the image along a third axis.
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
