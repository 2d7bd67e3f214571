"""Sticky walls: slow particles stay, their normal energy becomes that of a vibration.

A particle that is hit while it sticks loses at once the velocity across its faces that the contact gives it.
What has hit it keeps of its approach what rounding makes of zero, and must not come back for that.
"""

from math import sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.physics.collision import LEAST, fastest_component, gap_along
from gaspart.kernels.physics.contact import time_to_contact
from gaspart.kernels.physics.flight import face_plane
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add


@inner_helper
def is_absorbed(energy, face, mass, faces):
    """Whether a particle with this normal energy sticks to a face."""
    return energy < 0.5 * faces.level[face] * faces.level[face] / mass


@inner_kernel
def collide_sticky(flights, i, face, model, tally, law, faces):
    """Judge a particle at a sticky face by all the normal energy that it has, in flight and in its
    vibration."""
    axis = face // 2
    side = 1.0 if face % 2 else -1.0
    mass = mass_of(i, model.masses, law)
    before = side * flights[i].velocity[axis]
    held = faces.held[i, axis]
    energy = held + 0.5 * mass * before * before
    if is_absorbed(energy, face, mass, faces):
        faces.held[i, axis] = energy
        faces.place[i, axis] = 1 if face % 2 else -1
        after = 0.0
    else:
        faces.held[i, axis] = 0.0
        faces.place[i, axis] = 0
        after = -abs(before) if held == 0.0 else -sqrt(2.0 * energy / mass)
    flights[i].velocity[axis] = side * after
    add(tally.wall_impulse, face, mass * (before - after))


@inner_helper
def is_held(flights, i, axis, masses, law, faces, sticky):
    """Whether a particle sticks to a face across an axis, which absorbs its velocity there."""
    place = faces.place[i, axis]
    face = 2 * axis + (1 if place > 0 else 0)
    if place == 0 or not sticky[face]:
        return False
    mass = mass_of(i, masses, law)
    energy = faces.held[i, axis] + 0.5 * mass * flights[i].velocity[axis] * flights[i].velocity[axis]
    return is_absorbed(energy, face, mass, faces)


@inner_helper
def mobility_of(i, masses, law):
    """What an impulse changes of a particle's velocity: nothing if it is fixed."""
    if law is not None:
        return law.inverse_mass[i]
    return 1.0 / mass_of(i, masses, law)


@inner_helper
def lose_rounding(flights, i, axis, least, space, sticky):
    """Take a velocity from a particle at a sticky face with which it would come to it, if that is at most
    `least`: what is left where it has given all its velocity to another particle is no contact."""
    v = flights[i].velocity[axis]
    upper = v > 0.0
    if v != 0.0 and abs(v) <= least and sticky[2 * axis + (1 if upper else 0)]:
        if flights[i].position[axis] == face_plane(flights, i, axis, upper, space):
            flights[i].velocity[axis] = 0.0


@inner_kernel
def _part_held(flights, i, j, space, masses, law, faces, sticky):
    least = LEAST * max(fastest_component(flights, i, space), fastest_component(flights, j, space))
    rr = rv = vv = mobility = 0.0
    for k in range(len(space.lengths)):
        lose_rounding(flights, i, k, least, space, sticky)
        lose_rounding(flights, j, k, least, space, sticky)
        gap = gap_along(flights, i, j, k, space)
        speed = 0.0
        for particle, sign in ((i, -1.0), (j, 1.0)):
            if not is_held(flights, particle, k, masses, law, faces, sticky):
                speed += sign * flights[particle].velocity[k]
                mobility += gap * gap * mobility_of(particle, masses, law)
        rr += gap * gap
        rv += gap * speed
        vv += speed * speed
    sigma = flights[i].radius + flights[j].radius
    least *= sqrt(rr)
    if mobility == 0.0 or rv <= -least or time_to_contact(rr, rv, vv, sigma * sigma) > 0.0:
        return
    impulse = (least - rv) / mobility
    for k in range(len(space.lengths)):
        push = impulse * gap_along(flights, i, j, k, space)
        for particle, sign in ((i, -1.0), (j, 1.0)):
            if not is_held(flights, particle, k, masses, law, faces, sticky):
                flights[particle].velocity[k] += sign * push * mobility_of(particle, masses, law)


@inner_helper
def _part_if_held(flights, i, j, model, faces, sticky):
    if sticky is not None:
        _part_held(flights, i, j, model.space, model.masses, model.law, faces, sticky)


@inner_helper
def part_if_held(flights, i, j, model, faces):
    """Let two particles that have collided part, if one of them sticks to a face and would be met again, at a
    speed that is rounding only; and let no such speed lead to a face."""
    if faces is not None:
        _part_if_held(flights, i, j, model, faces, faces.sticky)
