"""Interior walls of two dimensions: segments with solid ends, hit from both sides.

A row of a segment is (ax, ay, ux, uy, length): its start, the unit vector along it, its length.
"""

from math import inf

from gaspart.kernels.ballistic import time_to_contact_pulled, time_to_far_side, time_to_side
from gaspart.kernels.compilation import inner_kernel
from gaspart.kernels.contact import time_to_contact
from gaspart.kernels.flight import acceleration


@inner_kernel
def time_to_segment(rows, body, segments, m, space, gravity):
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
