"""Interior walls, hit from both sides: segments with solid ends, and plates with solid rims."""

from __future__ import annotations

from math import inf, sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.event.boxes import box_of
from gaspart.kernels.model import NONE, WALLS
from gaspart.kernels.obstacles.distance import to_wall
from gaspart.kernels.obstacles.moving import collide_moving_wall, find_moving
from gaspart.kernels.obstacles.support import (
    come_to_rest,
    is_resting_on,
    leave,
    longest_rest,
    release,
    rests_on,
    time_to_leave,
)
from gaspart.kernels.obstacles.thermal import leave_warm
from gaspart.kernels.physics.ballistic import (
    advance_coordinate,
    time_of_summit,
    time_to_contact_pulled,
    time_to_far_side,
    time_to_side,
)
from gaspart.kernels.physics.collision import collide_wall_by_law, least_speed, push, velocity_of
from gaspart.kernels.physics.contact import normal_change, time_to_contact
from gaspart.kernels.physics.flight import acceleration_of, advance
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add

# Contact of a sphere with a plate (an interior wall in three dimensions), on a side, an edge or a corner.
#
# All coordinates are along the axes of the plate: along its two edges, and normal to it.


@inner_helper
def _components(row, x, y, z):
    """Return the components of a vector along the edges of a plate, and normal to it."""
    a, b = row.along, row.across
    nx, ny, nz = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    return x * a[0] + y * a[1] + z * a[2], x * b[0] + y * b[1] + z * b[2], nx * x + ny * y + nz * z


@inner_kernel
def time_to_point(r, v, g, radius):
    """Return the time until a sphere touches a point or a line. `r` and `v` and `g`: (3,), separation from
    the point, velocity and acceleration; for a line, the components along it are 0.
    """
    rr = r[0] * r[0] + r[1] * r[1] + r[2] * r[2]
    rv = r[0] * v[0] + r[1] * v[1] + r[2] * v[2]
    vv = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
    gg = g[0] * g[0] + g[1] * g[1] + g[2] * g[2]
    if gg > 0.0:
        ra = r[0] * g[0] + r[1] * g[1] + r[2] * g[2]
        va = v[0] * g[0] + v[1] * g[1] + v[2] * g[2]
        return time_to_contact_pulled(rr - radius * radius, rv, vv, ra, va, gg)
    return time_to_contact(rr, rv, vv, radius * radius)


@inner_kernel
def time_to_edge(r, v, g, length, radius):
    """Return the time until a sphere touches an edge. A falling sphere may touch the line next to the edge,
    leave it, and touch it again at the edge. `r` and `v` and `g`: (3,), separation, velocity and
    acceleration; the first two components are across the line, the third component is along the line,
    measured from its start.
    """
    x, z, y = r
    vx, vz, vy = v
    gx, gz, gy = g
    start = 0.0
    for _ in range(2):
        position = (advance_coordinate(x, vx, gx, start), 0.0, advance_coordinate(z, vz, gz, start))
        time = time_to_point(position, (vx + gx * start, 0.0, vz + gz * start), (gx, 0.0, gz), radius)
        if time == inf:
            return inf
        time += start
        if 0.0 <= advance_coordinate(y, vy, gy, time) <= length:
            return time
        gg = gx * gx + gz * gz
        if gg == 0.0:
            return inf
        start = time_of_summit(x * vx + z * vz, vx * vx + vz * vz, x * gx + z * gz, vx * gx + vz * gz, gg)
        if not time < start < inf:
            return inf
    return inf


@inner_kernel
def time_to_plate(flights, i, rows, m, space, gravity):
    """Return the time at which a sphere touches a plate; inf if it does not."""
    radius, row = flights[i].radius, rows[m]
    position, velocity = flights[i].position, flights[i].velocity
    dx, dy, dz = position[0] - row.corner[0], position[1] - row.corner[1], position[2] - row.corner[2]
    gx = gy = gz = 0.0
    if gravity is not None:
        gx = acceleration_of(flights, i, 0, space, gravity)
        gy = acceleration_of(flights, i, 1, space, gravity)
        gz = acceleration_of(flights, i, 2, space, gravity)
    x, y, z = _components(row, dx, dy, dz)
    u, v, w = _components(row, velocity[0], velocity[1], velocity[2])
    a, b, c = _components(row, gx, gy, gz)
    length, width = row.length, row.width
    if rests_on(i, m, gravity):
        return flights[i].clock + min(time_to_leave(x, u, a, length), time_to_leave(y, v, b, width))
    side = 1.0 if z >= 0.0 else -1.0
    best = inf
    for far in range(2):
        if far == 0:
            time = time_to_side(abs(z) - radius, -side * w, -side * c)
        else:
            time = time_to_far_side(-abs(z) - radius, side * w, side * c)
        if (
            time < best
            and 0.0 <= advance_coordinate(x, u, a, time) <= length
            and 0.0 <= advance_coordinate(y, v, b, time) <= width
        ):
            best = time
    for upper in range(2):
        far_x, far_y = x - upper * length, y - upper * width
        best = min(best, time_to_edge((far_x, z, y), (u, w, v), (a, c, b), width, radius))
        best = min(best, time_to_edge((far_y, z, x), (v, w, u), (b, c, a), length, radius))
        for other in range(2):
            corner_y = y - other * width
            best = min(best, time_to_point((far_x, corner_y, z), (u, v, w), (a, b, c), radius))
    return flights[i].clock + best


# Interior walls in two dimensions: segments with solid ends, which are hit from both sides.


@inner_kernel
def time_to_segment(flights, i, rows, m, space, gravity):
    """Return the time at which a disc touches a segment or its end, or inf (Spencer 2022, Eqs. 3-12)."""
    radius = flights[i].radius
    ux, uy, length = rows[m].direction[0], rows[m].direction[1], rows[m].length
    dx = flights[i].position[0] - rows[m].start[0]
    dy = flights[i].position[1] - rows[m].start[1]
    vx, vy = flights[i].velocity[0], flights[i].velocity[1]
    gx = gy = 0.0
    if gravity is not None:
        gx = acceleration_of(flights, i, 0, space, gravity)
        gy = acceleration_of(flights, i, 1, space, gravity)
    along, speed, pull = ux * dx + uy * dy, ux * vx + uy * vy, ux * gx + uy * gy
    if rests_on(i, m, gravity):
        return flights[i].clock + time_to_leave(along, speed, pull, length)
    height = ux * dy - uy * dx
    side = 1.0 if height >= 0.0 else -1.0
    closing, drawn = -side * (ux * vy - uy * vx), -side * (ux * gy - uy * gx)
    best = inf
    for far in range(2):
        if far == 0:
            time = time_to_side(abs(height) - radius, closing, drawn)
        else:
            time = time_to_far_side(-abs(height) - radius, -closing, -drawn)
        if time < best:
            s = along + (speed + 0.5 * pull * time) * time
            if 0.0 <= s <= length:
                best = time
    square = gx * gx + gy * gy
    for end in range(2):
        rx = (ux * length if end else 0.0) - dx
        ry = (uy * length if end else 0.0) - dy
        rr = rx * rx + ry * ry
        rv = -(rx * vx + ry * vy)
        vv = vx * vx + vy * vy
        if square > 0.0:
            gap = rr - radius * radius
            time = time_to_contact_pulled(gap, rv, vv, -(rx * gx + ry * gy), vx * gx + vy * gy, square)
        else:
            time = time_to_contact(rr, rv, vv, radius * radius)
        best = min(best, time)
    return flights[i].clock + best


@inner_helper
def time_to_wall(flights, i, rows, m, space, gravity, lengths):
    """Return the time at which a particle touches an interior wall; inf if it does not."""
    if len(lengths) == 2:
        return time_to_segment(flights, i, rows, m, space, gravity)
    return time_to_plate(flights, i, rows, m, space, gravity)


@inner_kernel
def next_wall(flights, predictions, i, boxes, space, gravity, walls, face_time):
    """Return the next wall near its box that a particle hits: (time, row), or (face_time, -1)."""
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
    """Return the earlier of the next interior wall and a given face: (time, face code)."""
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
    """Return the mass of a particle, 1 if all masses are equal."""
    return 1.0 if masses is None else masses[i]


@inner_helper
def coordinate_along(flights, i, row, edge, lengths):
    """Return a particle's coordinate along a wall's edge, the edge's length, and its unit vector."""
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
    """Return True if a particle touches a wall at an end, an edge or a corner."""
    outside = False
    for edge in range(len(lengths) - 1):
        at, length, _ = coordinate_along(flights, i, row, edge, lengths)
        outside |= not 0.0 <= at <= length
    return outside


@inner_kernel
def leave_wall(flights, i, row, space):
    """Move a particle that has reached the end of a wall beyond the end."""
    for edge in range(len(space.lengths) - 1):
        at, length, u = coordinate_along(flights, i, row, edge, space.lengths)
        leave(flights, i, u, at, length, space)


@inner_helper
def leaves(flights, i, m, space, walls, gravity):
    """Return True if a particle that has slid along a wall leaves it. Such a particle is released."""
    if gravity is None:
        return False
    if is_resting_on(gravity.support, i, m):
        release(flights, i, space, gravity.support)
        leave_wall(flights, i, walls.rows[m], space)
        return True
    return False


@inner_helper
def settle_on(flights, i, m, normal, model, tally, walls, gravity):
    """Put a particle to rest on an interior wall if its bounce cannot be resolved."""
    if gravity is not None:
        mass = mass_of(i, model.masses, model.law)
        at_end = is_at_end(flights, i, walls.rows[m], model.space.lengths)
        contact = m, at_end, longest_rest(flights, i, gravity, model.law)
        come_to_rest(flights, i, normal, contact, mass, model.space, tally, gravity)


@inner_helper
def bounce_off(flights, i, normal, model, tally, law):
    """Reflect a particle at a hard wall; return the momentum given to the wall. `normal`: (3,), unit vector
    towards the wall.
    """
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
    """Reflect a particle at an interior wall, or draw a velocity from the wall's temperature. The particle
    touches the wall at a side or at the rim. Returns the number of the wall.
    """
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
    """Perform `collide_wall`, or `collide_moving_wall` if the wall moves."""
    if moving is not None:
        return collide_moving_wall(flights, i, model, tally, moving)
    return collide_wall(flights, i, m, model, tally, walls, model.law)


@inner_helper
def meet_wall(flights, i, face, time, model, tally, walls):
    """Advance a particle to an interior wall and reflect it; return the wall's number, NONE if it
    slid off.
    """
    if walls is not None:
        advance(flights, i, time, model.space, model.gravity)
        if leaves(flights, i, face - WALLS, model.space, walls, model.gravity):
            return NONE
        return collide_interior(flights, i, face - WALLS, model, tally, walls, walls.moving)
    return face
