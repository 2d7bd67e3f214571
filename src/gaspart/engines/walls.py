"""Interior walls: segments that are hit from both sides, with solid ends."""

from math import inf, sqrt

from gaspart.contact import normal_change, time_to_contact
from gaspart.engines.flight import acceleration, advance_row
from gaspart.engines.impact import LEAST, strike_wall
from gaspart.engines.layout import WALLS, WORST
from gaspart.engines.lists import box_of
from gaspart.falling import time_against, time_along, time_to_contact_pulled
from gaspart.kernel import helper, kernel


@helper
def time_to_side(gap, closing, pull):
    """Time until a body touches the side that it is on: `gap` from it, approaching at `closing`, drawn
    towards it by `pull`; inf if it never does."""
    if pull > 0.0:
        return time_along(gap, closing, pull)
    if closing <= 0.0:
        return inf
    if pull < 0.0:
        return time_against(gap, closing, -pull)
    return max(0.0, gap / closing)


@helper
def time_to_far_side(gap, closing, pull):
    """The same for the side that it is not on yet (gap < 0): it must pass the line, turn and come back."""
    if closing >= 0.0 or pull <= 0.0:
        return inf
    square = closing * closing + 2.0 * pull * gap
    return (sqrt(square) - closing) / pull if square > 0.0 else inf


@kernel
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
    height = ux * dy - uy * dx
    side = 1.0 if height >= 0.0 else -1.0
    along, speed, pull = ux * dx + uy * dy, ux * vx + uy * vy, ux * gx + uy * gy
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


@kernel
def find_wall(rows, plans, body, space, partition, gravity, walls, soon, face):
    """The next wall that the body comes to of those near its box, if before `soon`: (time, code)."""
    box = box_of(plans, partition, body)
    if rows[body, 5] > walls.above:
        box = len(walls.first) - 2
    for n in range(walls.first[box], walls.first[box + 1]):
        m = walls.listed[n]
        time = time_to_wall(rows, body, walls.segments, m, space, gravity)
        if time < soon:
            soon = time
            face = WALLS + m
    return soon, face


@kernel
def meet_wall(rows, plans, body, m, time, space, masses, counters, gravity, law, walls):
    """Reflect a body at a segment, from its side or its end. Returns the number of the wall."""
    advance_row(rows, body, time, space, gravity)
    plans[body].changes += 1
    ux, uy = walls.segments[m, 2], walls.segments[m, 3]
    dx = rows[body, 0] - walls.segments[m, 0]
    dy = rows[body, 1] - walls.segments[m, 1]
    s = min(max(ux * dx + uy * dy, 0.0), walls.segments[m, 4])
    x, y = s * ux - dx, s * uy - dy  # from the centre to the point of contact
    distance = sqrt(x * x + y * y)
    x /= distance
    y /= distance
    least = LEAST * max(abs(rows[body, 2]), abs(rows[body, 3]))
    if law is None:
        mass = 1.0 if masses is None else masses[body]
        change = normal_change(x * rows[body, 2] + y * rows[body, 3], 1.0, least)
        rows[body, 2] -= change * x
        rows[body, 3] -= change * y
        impulse = mass * change
    else:
        impulse = strike_wall(rows, body, x, y, 0.0, least, space, counters, law)
    wall = 4 + walls.wall[m]
    counters.wall_hits[wall] += 1
    counters.wall_impulse[wall] += impulse
    square = distance / rows[body, 5]
    counters.sums[WORST] = max(counters.sums[WORST], abs(square * square - 1.0))
    return wall
