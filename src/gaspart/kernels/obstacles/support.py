"""The planes of walls on which particles rest, or along which they slide, under gravity.

Of gravity there remains what no wall supports: its projection on the directions that lead into none of them.
"""

from math import sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import NONE
from gaspart.kernels.physics.flight import face_plane

_INTO = 2.0**-40  # of gravity: what leads less into a wall runs along it
_PARALLEL = 2.0**-40  # squared sine of an angle between planes that are taken for one


@inner_kernel
def pull_along(gravity, axis):
    """Gravity along an axis, 0 along a third one in 2D."""
    return gravity.acceleration[axis] if axis < len(gravity.acceleration) else 0.0


@inner_helper
def dot(a, b):
    """The scalar product of two vectors (3,)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inner_helper
def is_resting_on(support, i, row):
    """Whether a particle rests on the row of an interior wall, or slides along it."""
    if support is None:
        return False
    found = False
    for n in range(support.number[i]):
        found |= support.row[i, n] == row
    return found


@inner_helper
def rests_on(i, row, gravity):
    """The same where there may be no gravity."""
    if gravity is None:
        return False
    return is_resting_on(gravity.support, i, row)


@inner_kernel
def within(support, i, planes, vector, dimension):
    """(3,) the projection of a vector on the first of two planes, or on their intersection if the second is
    not -1."""
    first, second = planes
    n = support.normal[i, first]
    part = dot(n, vector)
    flat = vector[0] - part * n[0], vector[1] - part * n[1], vector[2] - part * n[2]
    if second < 0:
        return flat
    m = support.normal[i, second]
    line = n[1] * m[2] - n[2] * m[1], n[2] * m[0] - n[0] * m[2], n[0] * m[1] - n[1] * m[0]
    square = dot(line, line)
    if square <= _PARALLEL:
        return flat
    if dimension == 2:
        return 0.0, 0.0, 0.0
    part = dot(vector, line) / square
    return part * line[0], part * line[1], part * line[2]


@inner_kernel
def leave_of(whole, support, i, dimension):
    """Determine the acceleration that the planes of a particle leave of a `whole` one (3,): the largest
    projection on one or two of them that leads into none; zero if there is none. Returns its square."""
    least = _INTO * sqrt(dot(whole, whole))
    best, pull = 0.0, support.pull[i]
    pull[:] = 0.0
    for first in range(support.number[i]):
        for second in range(-1, first):
            part = within(support, i, (first, second), whole, dimension)
            square = dot(part, part)
            leads_into = False
            for n in range(support.number[i]):
                leads_into |= dot(support.normal[i, n], part) < -least
            if square > best and not leads_into:
                best, pull[0], pull[1], pull[2] = square, part[0], part[1], part[2]
    return best


@inner_kernel
def find_pull(gravity, i, dimension):
    """Determine the acceleration that the planes of a particle leave of gravity. Remove planes that it leads
    away from."""
    support = gravity.support
    whole = pull_along(gravity, 0), pull_along(gravity, 1), pull_along(gravity, 2)
    leave_of(whole, support, i, dimension)
    least, pull, kept = _INTO * sqrt(dot(whole, whole)), support.pull[i], 0
    for n in range(support.number[i]):
        if dot(support.normal[i, n], pull) <= least:
            for k in range(3):
                support.normal[i, kept, k] = support.normal[i, n, k]
            support.plane[i, kept] = support.plane[i, n]
            support.row[i, kept] = support.row[i, n]
            kept += 1
    support.number[i] = kept


@inner_helper
def add_plane(flights, i, normal, row, space, support):
    """Add the plane that a particle touches in the direction of a unit vector (3,); the third gives way to a
    fourth one."""
    n = min(support.number[i], 2)
    support.normal[i, n, 0], support.normal[i, n, 1], support.normal[i, n, 2] = (
        -normal[0],
        -normal[1],
        -normal[2],
    )
    support.plane[i, n] = 0.0
    for k in range(len(space.lengths)):
        support.plane[i, n] += support.normal[i, n, k] * flights[i].position[k]
    support.row[i, n] = row
    support.number[i] = n + 1


@inner_helper
def lies_on_floor(flights, i, axis, space, gravity, longest):
    """Whether a particle lies on a face of the container along an axis, or bounces there no longer than the
    longest bounce that is taken for rest."""
    if axis >= len(space.lengths) or space.periodic[axis]:
        return False
    pull, x = gravity.acceleration[axis], flights[i].position[axis]
    if pull == 0.0 or abs(flights[i].velocity[axis]) > abs(pull) * longest:
        return False
    floor = face_plane(flights, i, axis, pull > 0.0, space)
    return x >= floor if pull > 0.0 else x <= floor


@inner_kernel
def add_floors(flights, i, space, gravity, longest):
    """Add the faces of the container on which a particle lies at rest (`flight.acceleration_of`)."""
    for k in range(len(space.lengths)):
        if lies_on_floor(flights, i, k, space, gravity, longest):
            side = 1.0 if gravity.acceleration[k] > 0.0 else -1.0
            normal = side if k == 0 else 0.0, side if k == 1 else 0.0, side if k == 2 else 0.0
            add_plane(flights, i, normal, NONE, space, gravity.support)


@inner_kernel
def pressing(flights, i, normal, space, gravity, longest):
    """The acceleration of a particle in the direction of a unit vector (3,): by gravity, or if that leads
    away, by what the floors on which the particle lies leave of it."""
    if gravity.support.number[i] > 0:
        return dot(normal, gravity.support.pull[i])
    press = remaining = 0.0
    for k in range(len(space.lengths)):
        press += normal[k] * gravity.acceleration[k]
        if not lies_on_floor(flights, i, k, space, gravity, longest):
            remaining += normal[k] * gravity.acceleration[k]
    return press if press > 0.0 else remaining


@inner_kernel
def release(flights, i, space, support):
    """Let gravity act on a particle in full, which is exactly at the walls that it rested on until now."""
    if support is None:
        return
    for n in range(support.number[i]):
        off = support.plane[i, n]
        for k in range(len(space.lengths)):
            off -= support.normal[i, n, k] * flights[i].position[k]
        for k in range(len(space.lengths)):
            flights[i].position[k] += off * support.normal[i, n, k]
    support.number[i] = 0


@inner_helper
def release_after(flights, i, space, gravity):
    """The same where there may be no gravity."""
    if gravity is not None:
        release(flights, i, space, gravity.support)
