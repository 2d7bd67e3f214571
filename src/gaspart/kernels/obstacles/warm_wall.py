"""Interior walls at a temperature: a particle leaves them with a velocity drawn from it, on its side."""

from math import sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.obstacles.support import dot, release_after
from gaspart.kernels.obstacles.thermal import draw_spin
from gaspart.kernels.physics.collision import least_speed, push, velocity_of
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.rng import flux_speed, normal_pair
from gaspart.kernels.physics.running_sum import add


@inner_helper
def leave_warm(flights, i, wall, normal, model, tally, law, warm):
    """Give a particle the velocity of one that leaves an interior wall, in the direction of the unit vector
    `normal` (3,), if that is at a temperature. Returns the momentum given to the wall along that direction,
    or -1 if it is hard."""
    if warm is None:
        return -1.0
    return _leave_warm(flights, i, wall, normal, model, tally, law, warm)


@inner_kernel
def _leave_warm(flights, i, wall, normal, model, tally, law, warm):
    level, space = warm.level[wall], model.space
    if not level > 0.0:
        return -1.0
    release_after(flights, i, space, model.gravity)
    mass, number, d = mass_of(i, model.masses, law), warm.draws[i], len(space.lengths)
    warm.draws[i] = number + 1
    width, before = sqrt(level / mass), velocity_of(flights, i, space)
    away = width * flux_speed(warm.key, i, number)
    one, other, block = normal_pair(warm.key, i, number, 1)
    first, second = tangents(normal, d)
    for k in range(d):
        flights[i].velocity[k] = width * one * first[k] - away * normal[k]
        if d == 3:
            flights[i].velocity[k] += width * other * second[k]
    more = max(0.0, least_speed(flights, i, space) - away)
    push(flights, i, -more, normal, space)
    after = velocity_of(flights, i, space)
    row = 2 * d + wall
    draw_spin(i, row, level, warm.key, (number, block), d, tally, law)
    add(tally.wall_energy, row, 0.5 * mass * (dot(before, before) - dot(after, after)))
    return mass * max(0.0, dot(normal, before) + away + more)


@inner_helper
def tangents(normal, dimension):
    """Two unit vectors (3,) at right angles to one another and to the unit vector `normal` (3,); in 2D the
    first is in the plane."""
    x, y, z = normal
    if dimension == 2:
        return (-y, x, 0.0), (0.0, 0.0, 1.0)
    if abs(x) <= abs(y) and abs(x) <= abs(z):
        size = sqrt(y * y + z * z)
        first = 0.0, -z / size, y / size
    elif abs(y) <= abs(z):
        size = sqrt(x * x + z * z)
        first = z / size, 0.0, -x / size
    else:
        size = sqrt(x * x + y * y)
        first = -y / size, x / size, 0.0
    a, b, c = first
    return first, (y * c - z * b, z * a - x * c, x * b - y * a)
