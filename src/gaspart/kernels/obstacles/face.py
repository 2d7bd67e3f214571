"""Faces of the container and of its boxes: hit times and effects on particles."""

from __future__ import annotations

from math import inf

from numpy import int64

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import (
    BOX_FACES,
    HARD,
    NONE,
    OPEN,
    PISTON,
    STICKY,
    THERMAL,
    THERMAL_NORMAL,
    VIBRATING,
)
from gaspart.kernels.obstacles.moving import (
    bounce,
    collide_moving,
    collide_piston,
    find_piston,
    find_vibrating,
    is_piston,
    moves,
)
from gaspart.kernels.obstacles.opening import collide_open
from gaspart.kernels.obstacles.support import (
    come_to_rest,
    longest_rest,
    release,
    release_after,
    rest_on_floor,
)
from gaspart.kernels.obstacles.thermal import collide_sticky, collide_thermal, time_to_edge
from gaspart.kernels.physics.ballistic import time_against, time_along
from gaspart.kernels.physics.contact import time_to_plane
from gaspart.kernels.physics.flight import acceleration_of, advance, face_plane
from gaspart.kernels.physics.lees_edwards import shift_image
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.per_area import add_per_area, spin_before, velocity_before
from gaspart.kernels.physics.running_sum import add

RULES = {
    "hard": HARD,
    "thermal": THERMAL,
    "thermal_normal": THERMAL_NORMAL,
    "sticky": STICKY,
    "vibrating": VIBRATING,
    "piston": PISTON,
    "open": OPEN,
}
"""Kinds of faces: name, and number in `Faces.kind`."""


@inner_helper
def plane_of(particles, i, axis, upper, boxes, space, oversized):
    """Return the lower or upper face of a particle's box along an axis. The result is (coordinate for the
    particle's centre, face code). A wall stops an oversized particle some boxes before the last box.
    """
    flights = particles.flights
    at = particles.predictions[i].box[axis]
    up = int64(upper)  # no branch: the direction of flight is unpredictable
    code = 2 * axis + up
    if at == up * (boxes.per_side[axis] - 1):
        return face_plane(flights, i, axis, upper, space), code
    plane = (at + up) * boxes.widths[axis]
    if oversized is not None:
        outer = face_plane(flights, i, axis, upper, space)
        if outer <= plane if upper else outer >= plane:
            return outer, code
    return plane, code + BOX_FACES


@inner_helper
def next_face(particles, i, boxes, space, now, gravity, faces, oversized):
    """Return the next face or edge of a well that a particle reaches: (time, face code). The face is a face
    of the particle's box or of the container. A falling particle may cross a face of a box, turn, and cross
    it again in the same flight. `now` determines which of these crossings are in the past.
    """
    flights = particles.flights
    soon = inf
    face = NONE
    for k in range(len(space.lengths)):
        v = flights[i].velocity[k]
        if faces is not None:
            time, code = find_vibrating(particles, i, k, boxes, space, gravity, faces.motion)
            if time < soon:
                soon = time
                face = code
            time, code = find_piston(particles, i, k, space, faces.piston)
            if time < soon:
                soon = time
                face = code
        if gravity is not None:
            pull = acceleration_of(flights, i, k, space, gravity)
            if pull != 0.0:
                time, code = next_face_pulled(particles, i, k, pull, boxes, space, now, oversized)
                if time < soon:
                    soon = time
                    face = code
                continue
        if v == 0.0:
            continue
        if faces is not None:
            time, code = time_to_edge(flights, i, k, space, faces)
            if time < soon:
                soon = time
                face = code
        plane, code = plane_of(particles, i, k, v > 0.0, boxes, space, oversized)
        time = flights[i].clock + time_to_plane(flights[i].position[k], v, plane)
        if time < soon:
            soon = time
            face = code
    return soon, face


@inner_kernel
def next_face_pulled(particles, i, axis, pull, boxes, space, now, oversized):
    """Return the next face along an axis with an acceleration: (time, face code). A particle that moves
    against the acceleration can leave only through the face ahead until it turns, and after that only through
    the face in the direction of the acceleration. So no face is crossed twice in the same direction. This is
    the rule of Spencer 2022, section 2.1.2, in a form that rounding cannot turn into an endless loop.
    """
    flight = particles.flights[i]
    x, clock = flight.position[axis], flight.clock
    upper = pull > 0.0
    strength = abs(pull)
    along = flight.velocity[axis] if upper else -flight.velocity[axis]  # speed along the acceleration
    summit = clock if along >= 0.0 else clock - along / strength
    if along < 0.0:
        plane, code = plane_of(particles, i, axis, not upper, boxes, space, oversized)
        gap = x - plane if upper else plane - x
        time = clock + time_against(gap, -along, strength)
        if code < BOX_FACES:
            if time < inf:
                return time, code
        elif now < summit and time < inf:
            return min(time, summit), code
    plane, code = plane_of(particles, i, axis, upper, boxes, space, oversized)
    gap = plane - x if upper else x - plane
    time = clock + time_along(gap, along, strength)
    if code >= BOX_FACES:
        time = max(time, summit)
    return time, code


@inner_kernel
def collide_special(flights, i, face, model, tally, law, faces):
    """Apply a special face to a particle that hits it; return False for a hard face."""
    kind = faces.kind[face]
    if kind in (THERMAL, THERMAL_NORMAL):
        collide_thermal(flights, i, face, model, tally, law, faces)
    elif kind == STICKY:
        collide_sticky(flights, i, face, model, tally, law, faces)
    elif kind == VIBRATING:
        collide_moving(flights, i, face, model, tally, law, faces.motion)
    elif kind == PISTON:
        collide_piston(flights, i, face, model, tally, faces.piston)
    elif kind == OPEN:
        collide_open(flights, i, face, model, tally, law, faces.open)
    else:
        return False
    return True


@inner_helper
def collide_face(flights, i, face, model, tally, law, faces):
    """Apply a wall to a particle that hits it; return True if the wall is hard."""
    tally.wall_hits[face] += 1
    if faces is not None:
        if collide_special(flights, i, face, model, tally, law, faces):
            return False
    add(tally.wall_impulse, face, bounce(flights, i, face, model, tally, law))
    return True


@inner_kernel
def reflect(flights, i, face, model, tally, law, faces):
    """Perform `collide_face` as a separate function."""
    return collide_face(flights, i, face, model, tally, law, faces)


@inner_kernel
def rest_on_face(flights, i, face, hard, model, tally, gravity, support):
    """Put a particle that slides down an interior wall to rest at a face. It then rests on both the wall and
    the face. If the face is not hard, the particle is released instead.
    """
    if support is None:
        return
    if support.number[i] > 0:
        if not hard:
            release(flights, i, model.space, support)
            return
        axis, side = face // 2, 1.0 if face % 2 else -1.0
        normal = side if axis == 0 else 0.0, side if axis == 1 else 0.0, side if axis == 2 else 0.0
        mass = mass_of(i, model.masses, model.law)
        contact = NONE, False, longest_rest(flights, i, gravity, model.law)
        come_to_rest(flights, i, normal, contact, mass, model.space, tally, gravity)


@inner_helper
def rest_after(flights, i, face, hard, model, tally, gravity):
    """Put a particle to rest if its bounce is too short for the clocks to resolve. Otherwise the bounce would
    be repeated forever.
    """
    if gravity is not None:
        axis = face // 2
        shortest = abs(gravity.acceleration[axis]) * gravity.shortest_bounce
        if hard and abs(flights[i].velocity[axis]) < shortest:
            flights[i].velocity[axis] = 0.0
        elif hard:
            rest_on_floor(flights, i, face, tally, gravity, model.law)
        rest_on_face(flights, i, face, hard, model, tally, gravity, gravity.support)


@inner_helper
def place_at(flights, i, face, space, faces):
    """Place a particle exactly at the face that it has reached. If the face moves, the particle may be
    anywhere in the container.
    """
    axis, upper = face // 2, face % 2 == 1
    plane = face_plane(flights, i, axis, upper, space)
    if faces is not None:
        if moves(face, faces.motion) or is_piston(face, faces.piston):
            x = flights[i].position[axis]
            plane = min(x, plane) if upper else max(x, plane)
    flights[i].position[axis] = plane


@inner_helper
def meet_face(particles, i, face, time, model, tally, faces):
    """Reflect a particle at a wall, or move it to the opposite periodic face. Returns True for a wall."""
    flights, space = particles.flights, model.space
    axis = face // 2
    upper = face % 2 == 1
    advance(flights, i, time, space, model.gravity)
    if space.periodic[axis]:
        release_after(
            flights, i, space, model.gravity
        )  # it comes to rest again, on another image of the wall
        flights[i].position[axis] = 0.0 if upper else space.lengths[axis]
        shift_image(particles, i, axis, upper, model, tally, model.shear)
        particles.images[i, axis] += 1 if upper else -1
        return False
    place_at(flights, i, face, space, faces)
    velocity = velocity_before(flights, i, tally.per_area)
    before = velocity, spin_before(i, model.law, tally.per_area)
    hard = reflect(flights, i, face, model, tally, model.law, faces)
    add_per_area(flights, i, face, before, model, tally.per_area)
    rest_after(flights, i, face, hard, model, tally, model.gravity)
    return True
