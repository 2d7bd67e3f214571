"""Interior walls, hit from both sides: segments with solid ends, and plates with solid rims."""

from math import inf, sqrt

from gaspart.contact import normal_change, time_to_contact
from gaspart.engines.flight import acceleration, advance_row
from gaspart.engines.impact import LEAST, push, strike_wall
from gaspart.engines.layout import NOTHING, WALLS
from gaspart.engines.lists import box_of
from gaspart.engines.plates import time_to_plate
from gaspart.engines.resting import come_to_rest, is_resting_on, leave, release, time_to_leave
from gaspart.engines.running_sum import add
from gaspart.engines.surfaces import mass_of
from gaspart.falling import time_to_contact_pulled, time_to_far_side, time_to_side
from gaspart.kernel import inner_helper, inner_kernel
from gaspart.plates import gap_to_plate


@inner_kernel
def time_to_wall(rows, body, segments, m, space, gravity):
    """When a body touches a segment, on a side (Spencer 2022, Eqs. 3-12) or at an end; inf if it does not."""
    radius = rows[body, 5]
    ux, uy, length = segments[m, 2], segments[m, 3], segments[m, 4]
    dx = rows[body, 0] - segments[m, 0]
    dy = rows[body, 1] - segments[m, 1]
    vx, vy = rows[body, 2], rows[body, 3]
    gx = gy = 0.0
    if gravity is not None:
        gx = acceleration(rows, body, 0, space, gravity)
        gy = acceleration(rows, body, 1, space, gravity)
    along, speed, pull = ux * dx + uy * dy, ux * vx + uy * vy, ux * gx + uy * gy
    if gravity is not None:
        if is_resting_on(gravity.support, body, m):
            return rows[body, 4] + time_to_leave(along, speed, pull, length)
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
    return rows[body, 4] + best


@inner_kernel
def find_wall(rows, plans, body, space, partition, gravity, walls, soon, face):
    """The next wall that the body comes to of those near its box, if before `soon`: (time, code)."""
    box = box_of(plans, partition, body)
    if rows[body, 2 * len(space.lengths) + 1] > walls.above:
        box = len(walls.first) - 2
    for n in range(walls.first[box], walls.first[box + 1]):
        m = walls.listed[n]
        if len(space.lengths) == 2:
            time = time_to_wall(rows, body, walls.pieces, m, space, gravity)
        else:
            time = time_to_plate(rows, body, walls.pieces, m, space, gravity)
        if time < soon:
            soon = time
            face = WALLS + m
    return soon, face


@inner_kernel
def gap_to_wall(rows, body, m, space, walls):
    """The vector from the centre of a body to the nearest point of a wall."""
    if len(space.lengths) == 3:
        return gap_to_plate(walls.pieces, m, rows[body, 0], rows[body, 1], rows[body, 2])
    ux, uy = walls.pieces[m, 2], walls.pieces[m, 3]
    dx = rows[body, 0] - walls.pieces[m, 0]
    dy = rows[body, 1] - walls.pieces[m, 1]
    s = min(max(ux * dx + uy * dy, 0.0), walls.pieces[m, 4])
    return s * ux - dx, s * uy - dy, 0.0


@inner_helper
def coordinate_along(rows, body, m, edge, space, walls):
    """Where the centre of a body is along an edge of a wall: (coordinate, length, the edge's unit vector)."""
    pieces = walls.pieces
    if len(space.lengths) == 2:
        ux, uy, uz, length = pieces[m, 2], pieces[m, 3], 0.0, pieces[m, 4]
        return ux * (rows[body, 0] - pieces[m, 0]) + uy * (rows[body, 1] - pieces[m, 1]), length, ux, uy, uz
    first = 7 if edge else 3
    ux, uy, uz, length = pieces[m, first], pieces[m, first + 1], pieces[m, first + 2], pieces[m, first + 3]
    at = (
        ux * (rows[body, 0] - pieces[m, 0])
        + uy * (rows[body, 1] - pieces[m, 1])
        + uz * (rows[body, 2] - pieces[m, 2])
    )
    return at, length, ux, uy, uz


@inner_kernel
def is_at_end(rows, body, m, space, walls):
    """Whether a body touches a wall at an end, an edge or a corner."""
    outside = False
    for edge in range(len(space.lengths) - 1):
        at, length, _, _, _ = coordinate_along(rows, body, m, edge, space, walls)
        outside |= not 0.0 <= at <= length
    return outside


@inner_kernel
def leave_wall(rows, body, m, space, walls):
    """Move a body that has come to the end of a wall beyond it."""
    for edge in range(len(space.lengths) - 1):
        at, length, ux, uy, uz = coordinate_along(rows, body, m, edge, space, walls)
        leave(rows, body, ux, uy, uz, at, length, space)


@inner_kernel
def meet_wall(rows, body, m, time, space, masses, counters, gravity, law, walls):
    """Reflect a body at a wall, from its side or its rim. Returns the number of the wall, or NOTHING if the
    body has slid along the wall and leaves it."""
    d = len(space.lengths)
    advance_row(rows, body, time, space, gravity)
    if gravity is not None:
        if is_resting_on(gravity.support, body, m):
            release(rows, body, space, gravity.support)
            leave_wall(rows, body, m, space, walls)
            return NOTHING
    x, y, z = gap_to_wall(rows, body, m, space, walls)
    distance = sqrt(x * x + y * y + z * z)
    x /= distance
    y /= distance
    z /= distance
    least = 0.0
    for k in range(d):
        least = max(least, abs(rows[body, d + k]))
    least *= LEAST
    if law is None:
        mass = 1.0 if masses is None else masses[body]
        approach = x * rows[body, d] + y * rows[body, d + 1]
        if d == 3:
            approach += z * rows[body, d + 2]
        change = normal_change(approach, 1.0, least)
        push(rows, body, -(change * x), -(change * y), -(change * z), space)
        impulse = mass * change
    else:
        impulse = strike_wall(rows, body, x, y, z, least, space, counters, law)
    if gravity is not None:
        mass = mass_of(body, masses, law)
        at_end = is_at_end(rows, body, m, space, walls)
        come_to_rest(rows, body, x, y, z, m, at_end, mass, space, counters, gravity)
    wall = 2 * d + walls.wall[m]
    counters.wall_hits[wall] += 1
    add(counters.wall_impulse, wall, impulse)
    square = distance / rows[body, 2 * d + 1]
    counters.worst[0] = max(counters.worst[0], abs(square * square - 1.0))
    return wall
