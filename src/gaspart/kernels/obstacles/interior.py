"""Interior walls, hit from both sides: segments with solid ends, and plates with solid rims."""

from math import sqrt

from gaspart.kernels.compilation import inner_kernel
from gaspart.kernels.contact import normal_change
from gaspart.kernels.event.box_lists import box_of
from gaspart.kernels.event.model import WALLS
from gaspart.kernels.flight import advance_row
from gaspart.kernels.impact import LEAST, push, strike_wall
from gaspart.kernels.obstacles.distance import gap_to_plate
from gaspart.kernels.obstacles.plate import time_to_plate
from gaspart.kernels.obstacles.segment import time_to_segment
from gaspart.kernels.running_sum import add


@inner_kernel
def find_wall(rows, plans, body, space, partition, gravity, walls, soon, face):
    """The next wall that the body comes to of those near its box, if before `soon`: (time, code)."""
    box = box_of(plans, partition, body)
    if rows[body, 2 * len(space.lengths) + 1] > walls.above:
        box = len(walls.first) - 2
    for n in range(walls.first[box], walls.first[box + 1]):
        m = walls.listed[n]
        if len(space.lengths) == 2:
            time = time_to_segment(rows, body, walls.pieces, m, space, gravity)
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


@inner_kernel
def meet_wall(rows, body, m, time, space, masses, counters, gravity, law, walls):
    """Reflect a body at a wall, from its side or its rim. Returns the number of the wall."""
    d = len(space.lengths)
    advance_row(rows, body, time, space, gravity)
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
    wall = 2 * d + walls.wall[m]
    counters.wall_hits[wall] += 1
    add(counters.wall_impulse, wall, impulse)
    square = distance / rows[body, 2 * d + 1]
    counters.worst[0] = max(counters.worst[0], abs(square * square - 1.0))
    return wall
