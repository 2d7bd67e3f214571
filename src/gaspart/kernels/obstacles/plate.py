"""When a sphere touches a plate, an interior wall of three dimensions: on a side, an edge or a corner.

Everything is computed in the plate's own axes: along its two edges, and across it.
"""

from math import inf

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.obstacles.resting import time_to_leave
from gaspart.kernels.obstacles.support import rests_on
from gaspart.kernels.physics.ballistic import (
    flown,
    time_of_summit,
    time_to_contact_pulled,
    time_to_far_side,
    time_to_side,
)
from gaspart.kernels.physics.contact import time_to_contact
from gaspart.kernels.physics.flight import acceleration_of


@inner_helper
def _components(row, x, y, z):
    """(3,) a vector in the plate's axes: along its two edges, and across the plate."""
    a, b = row.along, row.across
    nx, ny, nz = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    return x * a[0] + y * a[1] + z * a[2], x * b[0] + y * b[1] + z * b[2], nx * x + ny * y + nz * z


@inner_kernel
def time_to_point(r, v, g, radius):
    """Time until a sphere touches a point: r, v, g (3,), its separation, velocity and acceleration from
    there; or a line, with the components along it 0."""
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
    """Time until a sphere touches an edge: of r, v, g (3,) the first two components are across the line, the
    third along it from its start.

    A falling sphere may come to the line beside the edge, leave it, and come back to it at the edge.
    """
    x, z, y = r
    vx, vz, vy = v
    gx, gz, gy = g
    start = 0.0
    for _ in range(2):
        place = (flown(x, vx, gx, start), 0.0, flown(z, vz, gz, start))
        time = time_to_point(place, (vx + gx * start, 0.0, vz + gz * start), (gx, 0.0, gz), radius)
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
def time_to_plate(flights, i, rows, m, space, gravity):
    """When a sphere touches a plate; inf if it does not."""
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
        if time < best and 0.0 <= flown(x, u, a, time) <= length and 0.0 <= flown(y, v, b, time) <= width:
            best = time
    for upper in range(2):
        far_x, far_y = x - upper * length, y - upper * width
        best = min(best, time_to_edge((far_x, z, y), (u, w, v), (a, c, b), width, radius))
        best = min(best, time_to_edge((far_y, z, x), (v, w, u), (b, c, a), length, radius))
        for other in range(2):
            corner_y = y - other * width
            best = min(best, time_to_point((far_x, corner_y, z), (u, v, w), (a, b, c), radius))
    return flights[i].clock + best
