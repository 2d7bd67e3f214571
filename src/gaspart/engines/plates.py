"""When a sphere touches a plate, an interior wall of three dimensions: on a side, an edge or a corner.

Everything is reckoned in the plate's own axes: along its two edges, and across it.
"""

from math import inf

from gaspart.contact import time_to_contact
from gaspart.engines.flight import acceleration
from gaspart.engines.resting import is_resting_on, time_to_leave
from gaspart.falling import flown, time_of_summit, time_to_contact_pulled, time_to_far_side, time_to_side
from gaspart.kernel import inner_helper, inner_kernel


@inner_helper
def _along(plates, m, first, x, y, z):
    """The component of a vector along an edge, whose unit vector begins at column `first`."""
    return x * plates[m, first] + y * plates[m, first + 1] + z * plates[m, first + 2]


@inner_kernel
def time_to_point(x, y, z, vx, vy, vz, gx, gy, gz, radius):
    """Time until a body at (x, y, z) of a point touches it; of a line, with the components along it 0."""
    rr, rv, vv = x * x + y * y + z * z, x * vx + y * vy + z * vz, vx * vx + vy * vy + vz * vz
    gg = gx * gx + gy * gy + gz * gz
    if gg > 0.0:
        ra, va = x * gx + y * gy + z * gz, vx * gx + vy * gy + vz * gz
        return time_to_contact_pulled(rr - radius * radius, rv, vv, ra, va, gg)
    return time_to_contact(rr, rv, vv, radius * radius)


@inner_kernel
def time_to_edge(x, z, vx, vz, gx, gz, y, vy, gy, length, radius):
    """Time until a body touches an edge: (x, z) across the line, y along it from its start.

    A falling body may come to the line beside the edge, leave it, and come back to it at the edge.
    """
    start = 0.0
    for _ in range(2):
        time = time_to_point(
            flown(x, vx, gx, start), 0.0, flown(z, vz, gz, start),
            vx + gx * start, 0.0, vz + gz * start, gx, 0.0, gz, radius,
        )  # fmt: skip
        if time == inf:
            return inf
        time += start
        if 0.0 <= flown(y, vy, gy, time) <= length:
            return time
        gg = gx * gx + gz * gz
        if gg == 0.0:
            return inf
        start = time_of_summit(x * vx + z * vz, vx * vx + vz * vz, x * gx + z * gz, vx * gx + vz * gz, gg)
        if not time < start < inf:
            return inf
    return inf


@inner_kernel
def time_to_plate(rows, body, plates, m, space, gravity):
    """When a body touches a plate; inf if it does not."""
    radius = rows[body, 7]
    dx, dy, dz = rows[body, 0] - plates[m, 0], rows[body, 1] - plates[m, 1], rows[body, 2] - plates[m, 2]
    vx, vy, vz = rows[body, 3], rows[body, 4], rows[body, 5]
    gx = gy = gz = 0.0
    if gravity is not None:
        gx = acceleration(rows, body, 0, space, gravity)
        gy = acceleration(rows, body, 1, space, gravity)
        gz = acceleration(rows, body, 2, space, gravity)
    nx = plates[m, 4] * plates[m, 9] - plates[m, 5] * plates[m, 8]
    ny = plates[m, 5] * plates[m, 7] - plates[m, 3] * plates[m, 9]
    nz = plates[m, 3] * plates[m, 8] - plates[m, 4] * plates[m, 7]
    x, y, z = _along(plates, m, 3, dx, dy, dz), _along(plates, m, 7, dx, dy, dz), nx * dx + ny * dy + nz * dz
    u, v, w = _along(plates, m, 3, vx, vy, vz), _along(plates, m, 7, vx, vy, vz), nx * vx + ny * vy + nz * vz
    a, b, c = _along(plates, m, 3, gx, gy, gz), _along(plates, m, 7, gx, gy, gz), nx * gx + ny * gy + nz * gz
    length, width = plates[m, 6], plates[m, 10]
    if gravity is not None:
        if is_resting_on(gravity.support, body, m):
            return rows[body, 6] + min(time_to_leave(x, u, a, length), time_to_leave(y, v, b, width))
    side = 1.0 if z >= 0.0 else -1.0
    best = inf
    for far in range(2):
        if far == 0:
            time = time_to_side(abs(z) - radius, -side * w, -side * c)
        else:
            time = time_to_far_side(-abs(z) - radius, side * w, side * c)
        if time < best and 0.0 <= flown(x, u, a, time) <= length and 0.0 <= flown(y, v, b, time) <= width:
            best = time
    for upper in range(2):
        far_x, far_y = x - upper * length, y - upper * width
        best = min(best, time_to_edge(far_x, z, u, w, a, c, y, v, b, width, radius))
        best = min(best, time_to_edge(far_y, z, v, w, b, c, x, u, a, length, radius))
        for other in range(2):
            corner_y = y - other * width
            best = min(best, time_to_point(far_x, corner_y, z, u, v, w, a, b, c, radius))
    return rows[body, 6] + best
