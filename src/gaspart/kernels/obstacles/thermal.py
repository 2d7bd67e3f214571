"""Faces and walls that draw, absorb or change velocities: thermal walls, sticky walls, and wells.

A particle leaves a thermal wall with a random velocity for the wall's temperature.
"""

from __future__ import annotations

from math import inf, sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import NONE, STICKY, THERMAL, WELL_EDGES
from gaspart.kernels.obstacles.support import dot, release_after
from gaspart.kernels.physics.collision import (
    LEAST,
    fastest_component,
    gap_along,
    least_speed,
    push,
    velocity_of,
)
from gaspart.kernels.physics.contact import time_to_contact
from gaspart.kernels.physics.flight import advance, face_plane
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.per_area import add_per_area, spin_before, velocity_before
from gaspart.kernels.physics.rng import flux_speed, normal_pair, random_words, uniform
from gaspart.kernels.physics.running_sum import add


@inner_helper
def mirrors(i, face, number, key, accommodation):
    """Return True if a face reflects a particle specularly at this hit (Maxwell's model). The decision uses a
    random word of block 0; `flux_speed` uses another word of this block. `number`: number of the hit.
    """
    if accommodation is None:
        return False
    _, random_bits, _, _ = random_words(key, i, number, 0)
    return uniform(random_bits) >= accommodation[face]


@inner_helper
def temperature_at(face, position, lengths, level, ramp):
    """Return the temperature of a thermal face at the position (d,) where a particle hits it."""
    if ramp is None:
        return level[face]
    return _on_ramp(face, position, lengths, level[face], ramp)


@inner_helper
def _on_ramp(face, position, lengths, low, ramp):
    axis = ramp.axis[face]
    if axis == NONE:
        return low
    part = min(max(position[axis] / lengths[axis], 0.0), 1.0)
    return (1.0 - part) * low + part * ramp.high[face]


@inner_kernel
def collide_thermal(flights, i, face, model, tally, law, faces):
    """Give a particle the velocity with which it leaves a thermal wall."""
    d = len(model.space.lengths)
    axis = face // 2
    side = 1.0 if face % 2 else -1.0
    mass = mass_of(i, model.masses, law)
    number = faces.draws[i]
    faces.draws[i] = number + 1
    if mirrors(i, face, number, faces.key, faces.accommodation):
        add(tally.wall_impulse, face, 2.0 * mass * abs(flights[i].velocity[axis]))
        flights[i].velocity[axis] = -flights[i].velocity[axis]
        return
    level = temperature_at(face, flights[i].position, model.space.lengths, faces.level, faces.ramp)
    width = sqrt(level / mass)
    square = 0.0
    for k in range(d):
        square += flights[i].velocity[k] * flights[i].velocity[k]
    approach = side * flights[i].velocity[axis]
    away = width * flux_speed(faces.key, i, number)
    flights[i].velocity[axis] = -side * away
    add(tally.wall_impulse, face, mass * (approach + away))
    if faces.kind[face] == THERMAL:
        add_shear(flights, i, face, mass, faces.sliding)
        first, second, block = normal_pair(faces.key, i, number, 1)
        flights[i].velocity[(axis + 1) % d] = width * first
        if d == 3:
            flights[i].velocity[(axis + 2) % d] = width * second
        drag(flights, i, face, mass, faces.sliding)
        draw_spin(i, face, level, faces.key, (number, block), d, tally, law)
    for k in range(d):
        square -= flights[i].velocity[k] * flights[i].velocity[k]
    add(tally.wall_energy, face, 0.5 * mass * square)


@inner_helper
def add_shear(flights, i, face, mass, sliding):
    """Add the momentum of a particle along a face to the momentum given to the face. `mass`: negative if the
    particle receives the momentum.
    """
    if sliding is not None:
        d = sliding.velocity.shape[1]
        for k in range(d):
            if k != face // 2:
                add(sliding.shear, face * d + k, mass * flights[i].velocity[k])


@inner_helper
def drag(flights, i, face, mass, sliding):
    """Add the velocity of a sliding face to the velocity of a particle that leaves it."""
    if sliding is not None:
        for k in range(sliding.velocity.shape[1]):
            flights[i].velocity[k] += sliding.velocity[face, k]
        add_shear(flights, i, face, -mass, sliding)


@inner_kernel
def draw_spin(i, wall, level, key, counter, dimension, tally, law):
    """Draw the spin of a rough particle; in two dimensions it has one component. `wall`: row of the tally.
    `level`: temperature. `counter`: number of the draw, and first block of random words for the draw.
    """
    if law is None:
        return
    if law.tangential > -1.0:
        number, block = counter
        inertia = 1.0 / law.inverse_inertia[i]
        width = sqrt(level / inertia)
        for k in range(2 if dimension == 2 else 0, 3):
            deviate, _, block = normal_pair(key, i, number, block)
            spin = width * deviate
            before = law.spins[i, k]
            add(tally.wall_energy, wall, 0.5 * inertia * (before * before - spin * spin))
            law.spins[i, k] = spin


# Interior walls with a temperature: a particle leaves them on its own side with a random velocity.


@inner_helper
def leave_warm(flights, i, wall, normal, model, tally, law, warm):
    """Give a particle the velocity with which it leaves an interior wall with a temperature. Returns the
    momentum given to the wall along the normal, or -1 if the wall is hard. `normal`: (3,), unit vector
    towards the wall.
    """
    if warm is None:
        return -1.0
    return _leave_warm(flights, i, wall, normal, model, tally, law, warm)


@inner_kernel
def _leave_warm(flights, i, wall, normal, model, tally, law, warm):
    level, space = warm.level[wall], model.space
    if not level > 0.0:
        return -1.0
    release_after(flights, i, space, model.gravity)
    mass, number, d = mass_of(i, model.masses, law), warm.draws[i], len(space.lengths)
    warm.draws[i] = number + 1
    width, before = sqrt(level / mass), velocity_of(flights, i, space)
    away = width * flux_speed(warm.key, i, number)
    deviate, other, block = normal_pair(warm.key, i, number, 1)
    first, second = tangents(normal, d)
    for k in range(d):
        flights[i].velocity[k] = width * deviate * first[k] - away * normal[k]
        if d == 3:
            flights[i].velocity[k] += width * other * second[k]
    more = max(0.0, least_speed(flights, i, space) - away)
    push(flights, i, -more, normal, space)
    after = velocity_of(flights, i, space)
    row = 2 * d + wall
    draw_spin(i, row, level, warm.key, (number, block), d, tally, law)
    add(tally.wall_energy, row, 0.5 * mass * (dot(before, before) - dot(after, after)))
    return mass * max(0.0, dot(normal, before) + away + more)


@inner_helper
def tangents(normal, dimension):
    """Return two orthogonal unit vectors (3,) across a unit vector `normal` (3,); in 2D the first is in the
    plane.
    """
    x, y, z = normal
    if dimension == 2:
        return (-y, x, 0.0), (0.0, 0.0, 1.0)
    if abs(x) <= abs(y) and abs(x) <= abs(z):
        size = sqrt(y * y + z * z)
        first = 0.0, -z / size, y / size
    elif abs(y) <= abs(z):
        size = sqrt(x * x + z * z)
        first = z / size, 0.0, -x / size
    else:
        size = sqrt(x * x + y * y)
        first = -y / size, x / size, 0.0
    a, b, c = first
    return first, (y * c - z * b, z * a - x * c, x * b - y * a)


# Sticky walls: slow particles stick to them, and their normal kinetic energy becomes vibrational energy.
#
# If a particle is hit while it sticks, it immediately loses the velocity across its faces that the collision
# gives it. The particle that hit it may have a small remaining approach velocity where exact arithmetic gives
# zero. It must not return because of this rounding error.


@inner_helper
def is_absorbed(energy, face, mass, faces):
    """Return True if a particle with this normal energy sticks to a face."""
    return energy < 0.5 * faces.level[face] * faces.level[face] / mass


@inner_kernel
def collide_sticky(flights, i, face, model, tally, law, faces):
    """Decide whether a particle sticks to a face, from its normal kinetic and vibrational energy."""
    axis = face // 2
    side = 1.0 if face % 2 else -1.0
    mass = mass_of(i, model.masses, law)
    before = side * flights[i].velocity[axis]
    held = faces.held[i, axis]
    energy = held + 0.5 * mass * before * before
    if is_absorbed(energy, face, mass, faces):
        faces.held[i, axis] = energy
        faces.well_side[i, axis] = 1 if face % 2 else -1
        after = 0.0
    else:
        faces.held[i, axis] = 0.0
        faces.well_side[i, axis] = 0
        after = -abs(before) if held == 0.0 else -sqrt(2.0 * energy / mass)
    flights[i].velocity[axis] = side * after
    add(tally.wall_impulse, face, mass * (before - after))


@inner_helper
def is_held(flights, i, axis, masses, law, faces, sticky):
    """Return True if a particle sticks to a face across an axis, which absorbs its velocity."""
    side = faces.well_side[i, axis]
    face = 2 * axis + (1 if side > 0 else 0)
    if side == 0 or not sticky[face]:
        return False
    mass = mass_of(i, masses, law)
    energy = faces.held[i, axis] + 0.5 * mass * flights[i].velocity[axis] * flights[i].velocity[axis]
    return is_absorbed(energy, face, mass, faces)


@inner_helper
def mobility_of(i, masses, law):
    """Return the velocity change of a particle per unit impulse; 0 if it is fixed."""
    if law is not None:
        return law.inverse_mass[i]
    return 1.0 / mass_of(i, masses, law)


@inner_helper
def lose_rounding(flights, i, axis, least, space, sticky):
    """Remove a velocity of at most `least` with which a particle would hit its sticky face. Such a velocity
    is a rounding error that remains if the particle has transferred its whole velocity to another particle;
    it must not cause a hit.
    """
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
    """Separate two particles that have collided if one of them sticks to a face. If they would collide again,
    they get a separation speed of the order of rounding errors. Such a speed must not lead towards a face.
    """
    if faces is not None:
        _part_if_held(flights, i, j, model, faces, faces.sticky)


# Wells at the faces of the container: a step of the potential at a distance from the wall.


@inner_helper
def edge_plane(flights, i, face, space, faces):
    """Return the coordinate of a particle's centre at the edge of the well of a face."""
    upper = face % 2 == 1
    width = faces.width[face]
    return face_plane(flights, i, face // 2, upper, space) + (-width if upper else width)


@inner_kernel
def time_to_edge(flights, i, axis, space, faces):
    """Return the next edge of a well along an axis: (time, face code). For a particle stuck to a face, the
    result is its clock time and the face. The particle is tested again, because a contact has moved it.
    """
    v = flights[i].velocity[axis]
    clock = flights[i].clock
    side = faces.well_side[i, axis]
    upper = side > 0 or (side == 0 and v > 0.0)
    face = 2 * axis + (1 if upper else 0)
    if faces.kind[face] == STICKY and side != 0:
        return clock, face
    if faces.depth[face] > 0.0 and (side == 0 or (v > 0.0) != upper):
        way = edge_plane(flights, i, face, space, faces) - flights[i].position[axis]
        return clock + way / v, WELL_EDGES + face
    return inf, NONE


@inner_helper
def cross_edge(flights, i, face, model, tally, law, faces):
    """Move a particle into a well, or out of it if fast enough; the wall receives its change of momentum."""
    axis = face // 2
    flights[i].position[axis] = edge_plane(flights, i, face, model.space, faces)
    side = 1.0 if face % 2 else -1.0
    mass = mass_of(i, model.masses, law)
    step = 2.0 * faces.depth[face] / mass
    before = side * flights[i].velocity[axis]
    if before > 0.0:
        after = sqrt(before * before + step)
        faces.well_side[i, axis] = 1 if face % 2 else -1
    elif before * before > step:
        after = -sqrt(before * before - step)
        faces.well_side[i, axis] = 0
    else:
        after = -before
    flights[i].velocity[axis] = side * after
    add(tally.wall_impulse, face, mass * (before - after))


@inner_kernel
def collide_edge(flights, i, face, model, tally, law, faces):
    """Perform `cross_edge` as a separate function; return the number of the face."""
    cross_edge(flights, i, face, model, tally, law, faces)
    return face


@inner_helper
def meet_edge(flights, i, face, time, model, tally, faces):
    """Advance a particle to a well's edge, to cross it or be reflected; return the number of the face."""
    if faces is not None:
        advance(flights, i, time, model.space, model.gravity)
        velocity = velocity_before(flights, i, tally.per_area)
        before = velocity, spin_before(i, model.law, tally.per_area)
        met = collide_edge(flights, i, face - WELL_EDGES, model, tally, model.law, faces)
        add_per_area(flights, i, met, before, model, tally.per_area)
        return met
    return face
