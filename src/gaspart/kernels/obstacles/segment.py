"""Interior walls of two dimensions: segments with solid ends, hit from both sides."""

from math import inf

from gaspart.kernels.compile.policy import inner_kernel
from gaspart.kernels.obstacles.resting import time_to_leave
from gaspart.kernels.obstacles.support import rests_on
from gaspart.kernels.physics.ballistic import time_to_contact_pulled, time_to_far_side, time_to_side
from gaspart.kernels.physics.contact import time_to_contact
from gaspart.kernels.physics.flight import acceleration_of


@inner_kernel
def time_to_segment(flights, i, rows, m, space, gravity):
    """When a disc touches a segment, on a side (Spencer 2022, Eqs. 3-12) or at an end; inf if it does not."""
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
