"""Interior walls, hit from both sides: segments with solid ends, and plates with solid rims."""

from math import sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.event.box_lists import box_of
from gaspart.kernels.model import NONE, WALLS
from gaspart.kernels.obstacles.distance import to_wall
from gaspart.kernels.obstacles.moving_wall import collide_moving_wall, find_moving
from gaspart.kernels.obstacles.plate import time_to_plate
from gaspart.kernels.obstacles.resting import come_to_rest, leave
from gaspart.kernels.obstacles.segment import time_to_segment
from gaspart.kernels.obstacles.short_bounce import longest_rest
from gaspart.kernels.obstacles.support import is_resting_on, release
from gaspart.kernels.obstacles.warm_wall import leave_warm
from gaspart.kernels.physics.collision import collide_wall_by_law, least_speed, push, velocity_of
from gaspart.kernels.physics.contact import normal_change
from gaspart.kernels.physics.flight import advance
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add


@inner_helper
def time_to_wall(flights, i, rows, m, space, gravity, lengths):
    """When a particle touches an interior wall; inf if it does not."""
    if len(lengths) == 2:
        return time_to_segment(flights, i, rows, m, space, gravity)
    return time_to_plate(flights, i, rows, m, space, gravity)


@inner_kernel
def next_wall(flights, predictions, i, boxes, space, gravity, walls, face_time):
    """The next wall that a particle comes to of those near its box, if before `face_time`: (time, row), or
    (face_time, -1)."""
    box = box_of(predictions, boxes, i)
    if flights[i].radius > walls.largest_radius:
        box = len(walls.first) - 2
    wall = -1
    for n in range(walls.first[box], walls.first[box + 1]):
        m = walls.listed[n]
        time = time_to_wall(flights, i, walls.rows, m, space, gravity, space.lengths)
        if time < face_time:
            face_time = time
            wall = m
    return face_time, wall


@inner_helper
def find_wall(particles, i, boxes, space, gravity, walls, time, face):
    """The earlier of the next interior wall and the face (time, face code)."""
    if walls is not None:
        wall_time, m = next_wall(
            particles.flights, particles.predictions, i, boxes, space, gravity, walls, time
        )
        if m >= 0:
            return wall_time, WALLS + m
        return find_moving(particles.flights, i, walls.moving, time, face)
    return time, face


@inner_helper
def mass_in(masses, i):
    """The mass of a particle, 1 where all have the same."""
    return 1.0 if masses is None else masses[i]


@inner_helper
def coordinate_along(flights, i, row, edge, lengths):
    """Where the centre of a particle is along an edge of a wall: (coordinate, length, the edge's unit
    vector)."""
    p = flights[i].position
    if len(lengths) == 2:
        u, length = (row.direction[0], row.direction[1], 0.0), row.length
        return u[0] * (p[0] - row.start[0]) + u[1] * (p[1] - row.start[1]), length, u
    along, length = (row.across, row.width) if edge else (row.along, row.length)
    u = along[0], along[1], along[2]
    corner = row.corner
    at = u[0] * (p[0] - corner[0]) + u[1] * (p[1] - corner[1]) + u[2] * (p[2] - corner[2])
    return at, length, u


@inner_kernel
def is_at_end(flights, i, row, lengths):
    """Whether a particle touches a wall at an end, an edge or a corner."""
    outside = False
    for edge in range(len(lengths) - 1):
        at, length, _ = coordinate_along(flights, i, row, edge, lengths)
        outside |= not 0.0 <= at <= length
    return outside


@inner_kernel
def leave_wall(flights, i, row, space):
    """Move a particle that has come to the end of a wall beyond it."""
    for edge in range(len(space.lengths) - 1):
        at, length, u = coordinate_along(flights, i, row, edge, space.lengths)
        leave(flights, i, u, at, length, space)


@inner_helper
def leaves(flights, i, m, space, walls, gravity):
    """Whether a particle that comes to a wall has slid along it and leaves it."""
    if gravity is None:
        return False
    if is_resting_on(gravity.support, i, m):
        release(flights, i, space, gravity.support)
        leave_wall(flights, i, walls.rows[m], space)
        return True
    return False


@inner_helper
def settle_on(flights, i, m, normal, model, tally, walls, gravity):
    """Let a particle rest on an interior wall if its bounce cannot be resolved."""
    if gravity is not None:
        mass = mass_of(i, model.masses, model.law)
        at_end = is_at_end(flights, i, walls.rows[m], model.space.lengths)
        place = m, at_end, longest_rest(flights, i, gravity, model.law)
        come_to_rest(flights, i, normal, place, mass, model.space, tally, gravity)


@inner_helper
def bounce_off(flights, i, normal, model, tally, law):
    """Reflect a particle at a hard wall in the direction of the unit vector `normal` (3,). Returns the
    momentum given to the wall."""
    space = model.space
    least = least_speed(flights, i, space)
    if law is None:
        velocity = velocity_of(flights, i, space)
        approach = normal[0] * velocity[0] + normal[1] * velocity[1]
        if len(space.lengths) == 3:
            approach += normal[2] * velocity[2]
        change = normal_change(approach, 1.0, least)
        push(flights, i, -change, normal, space)
        return mass_in(model.masses, i) * change
    return collide_wall_by_law(flights, i, normal, least, space, tally, law)


@inner_kernel
def collide_wall(flights, i, m, model, tally, walls, law):
    """Reflect a particle at an interior wall that it touches, from its side or its rim, or give it a velocity
    of the wall's temperature. Returns the number of the wall."""
    space = model.space
    x, y, z = to_wall(walls.rows, m, flights[i].position, space.lengths)
    distance = sqrt(x * x + y * y + z * z)
    normal = x / distance, y / distance, z / distance
    impulse = leave_warm(flights, i, walls.wall[m], normal, model, tally, law, walls.warm)
    if impulse < 0.0:
        impulse = bounce_off(flights, i, normal, model, tally, law)
        settle_on(flights, i, m, normal, model, tally, walls, model.gravity)
    wall = 2 * len(space.lengths) + walls.wall[m]
    tally.wall_hits[wall] += 1
    add(tally.wall_impulse, wall, impulse)
    square = distance / flights[i].radius
    tally.worst[0] = max(tally.worst[0], abs(square * square - 1.0))
    return wall


@inner_helper
def collide_interior(flights, i, m, model, tally, walls, moving):
    """`collide_wall`, or the same with the wall that moves."""
    if moving is not None:
        return collide_moving_wall(flights, i, model, tally, moving)
    return collide_wall(flights, i, m, model, tally, walls, model.law)


@inner_helper
def meet_wall(flights, i, face, time, model, tally, walls):
    """Advance a particle to an interior wall and reflect it there. Returns the number of the wall, or NONE if
    the particle has slid along the wall and leaves it."""
    if walls is not None:
        advance(flights, i, time, model.space, model.gravity)
        if leaves(flights, i, face - WALLS, model.space, walls, model.gravity):
            return NONE
        return collide_interior(flights, i, face - WALLS, model, tally, walls, walls.moving)
    return face
