"""Planes of walls on which particles rest, or along which they slide, under gravity.

The part of gravity that no wall supports remains. It is the projection of gravity on the directions that lead
into none of the walls.
"""

from __future__ import annotations

from math import inf, sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import LOSS, NONE
from gaspart.kernels.physics.ballistic import time_to_side
from gaspart.kernels.physics.collision import velocity_of
from gaspart.kernels.physics.contact import SHORTEST, is_alone
from gaspart.kernels.physics.flight import face_plane
from gaspart.kernels.physics.running_sum import add

_PARALLEL = 2.0**-40  # squared sine of the angle below which two planes count as one


@inner_kernel
def pull_along(gravity, axis):
    """Return gravity along an axis; 0 along a third axis in two dimensions."""
    return gravity.acceleration[axis] if axis < len(gravity.acceleration) else 0.0


@inner_helper
def dot(a, b):
    """Compute the scalar product of two vectors (3,)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inner_helper
def is_resting_on(support, i, row):
    """Return True if a particle rests on, or slides along, the interior wall of this row."""
    if support is None:
        return False
    rests = False
    for n in range(support.number[i]):
        rests |= support.row[i, n] == row
    return rests


@inner_helper
def rests_on(i, row, gravity):
    """Return True if a particle rests on, or slides along, the wall of this row; False without gravity."""
    if gravity is None:
        return False
    return is_resting_on(gravity.support, i, row)


@inner_kernel
def within(support, i, planes, vector, dimension):
    """Project a vector on a plane, or on the intersection of two planes. `planes`: two planes; if the second
    is -1, the projection is on the first plane.
    """
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
def leave_of(acceleration, support, i, dimension):
    """Compute the acceleration that the planes of a particle leave; return its square. It is the largest
    projection of the `acceleration` (3,) on one or two planes that leads into no plane; without such a
    projection it is zero.
    """
    least = _INTO * sqrt(dot(acceleration, acceleration))
    best, pull = 0.0, support.pull[i]
    pull[:] = 0.0
    for first in range(support.number[i]):
        for second in range(-1, first):
            part = within(support, i, (first, second), acceleration, dimension)
            square = dot(part, part)
            leads_into = False
            for n in range(support.number[i]):
                leads_into |= dot(support.normal[i, n], part) < -least
            if square > best and not leads_into:
                best, pull[0], pull[1], pull[2] = square, part[0], part[1], part[2]
    return best


@inner_kernel
def find_pull(gravity, i, dimension):
    """Compute the part of gravity that a particle's planes leave, and remove planes from which it
    leads away.
    """
    support = gravity.support
    acceleration = pull_along(gravity, 0), pull_along(gravity, 1), pull_along(gravity, 2)
    leave_of(acceleration, support, i, dimension)
    least, pull, kept = _INTO * sqrt(dot(acceleration, acceleration)), support.pull[i], 0
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
    """Add the plane that a particle touches in the direction of a unit vector (3,); a fourth replaces the
    third.
    """
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
    """Return True if a particle lies on a face of the container along an axis. It also lies there if its
    bounce is at most as long as the longest bounce that counts as rest.
    """
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
    """Return the acceleration of a particle in the direction of a unit vector (3,). It is the component of
    gravity. If this leads away, it is the part that the floors below the particle leave.
    """
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
    """Release a particle, exactly at the walls on which it rested, to the full gravity."""
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
    """Release a particle if there is gravity."""
    if gravity is not None:
        release(flights, i, space, gravity.support)


# Particles that slide along a wall into an acute wedge, under an overhanging wall or fixed particle.
#
# The overhang reflects the particle downwards. The particle comes to rest below, and hits the overhang again
# at once with a lower speed, so there would be infinitely many hits in zero time. Therefore it is put to rest
# between both obstacles. Its velocity along both remains.


_INTO = 2.0**-40  # fraction of the speed; smaller components into a plane count as motion along it


@inner_helper
def count_planes(support, i):
    """Return the number of planes of interior walls on which a particle rests."""
    if support is None:
        return 0
    return support.number[i]


@inner_helper
def plane_normal(support, i, n):
    """Return the unit vector (3,) from one of these planes to the particle."""
    if support is None:
        return 0.0, 0.0, 0.0
    return support.normal[i, n, 0], support.normal[i, n, 1], support.normal[i, n, 2]


@inner_helper
def fastest_at_rest(gravity, longest, support):
    """Return the speed across a horizontal wall below which a bounce counts as rest."""
    square = 0.0
    for k in range(len(gravity.acceleration)):
        square += gravity.acceleration[k] * gravity.acceleration[k]
    strength = sqrt(square)
    speed = strength * longest
    if support is not None:
        speed = max(speed, sqrt(2.0 * strength * support.height))
    return speed


@inner_kernel
def come_to_rest_again(flights, i, longest, space, gravity, support):
    """Return the velocity of a bounced particle that comes to rest again on its support. The result is
    (velocity (3,), number of planes into which it led, normal (3,) of the last such plane). The number is 0
    without such planes, or if the particle is fast enough to bounce on them as well.
    """
    w, normal, number = velocity_of(flights, i, space), (0.0, 0.0, 0.0), 0
    planes, fastest = count_planes(support, i), fastest_at_rest(gravity, longest, support)
    for n in range(planes if planes > 0 else 3):
        if planes > 0:
            p = plane_normal(support, i, n)
        elif lies_on_floor(flights, i, n, space, gravity, longest):
            side = -1.0 if gravity.acceleration[n] > 0.0 else 1.0
            p = side if n == 0 else 0.0, side if n == 1 else 0.0, side if n == 2 else 0.0
        else:
            continue
        into = -dot(p, w)
        if into >= fastest:
            return w, 0, normal
        if into > _INTO * sqrt(dot(w, w)):
            w = w[0] + into * p[0], w[1] + into * p[1], w[2] + into * p[2]
            normal, number = p, number + 1
    return w, number, normal


@inner_kernel
def rest_in_wedge(flights, i, normal, particle, space, tally, gravity, support):
    """Put a particle to rest in a wedge after a bounce; return True if it rests. It rests between its support
    and the obstacle of the bounce, which is in the direction of the unit vector `normal` (3,), if it would
    hit the obstacle again at once. `particle`: its mass, and the longest bounce that counts as rest.
    """
    mass, longest = particle
    v = velocity_of(flights, i, space)
    w, number, p = come_to_rest_again(flights, i, longest, space, gravity, support)
    if number == 0 or dot(normal, w) <= _INTO * sqrt(dot(v, v)):
        return False
    part = 0.0
    x, y, z = (
        p[1] * normal[2] - p[2] * normal[1],
        p[2] * normal[0] - p[0] * normal[2],
        p[0] * normal[1] - p[1] * normal[0],
    )
    if number == 1 and len(space.lengths) == 3:
        part = (v[0] * x + v[1] * y + v[2] * z) / (x * x + y * y + z * z)
    lost = dot(v, v)
    for k in range(len(space.lengths)):
        flights[i].velocity[k] = part * (x if k == 0 else y if k == 1 else z)
        lost -= flights[i].velocity[k] * flights[i].velocity[k]
    add(tally.sums, LOSS, 0.5 * mass * lost)
    return True


# Particles that come to rest on walls under gravity, or leave the walls.
#
# A bounce that positions or clocks cannot resolve counts as rest: the velocity across the wall becomes zero.
# The particle is released at the next contact that moves it, and at the end of the wall.


_HOP = 2.0**20  # shortest bounce where a particle cannot rest, in units of `shortest_bounce`


@inner_kernel
def come_to_rest(flights, i, normal, contact, mass, space, tally, gravity):
    """Put a particle to rest after a bounce that is too short to be resolved. If the particle cannot rest
    there, its bounce is made long enough to be resolved. `normal`: (3,), unit vector towards the wall.
    `contact`: row of the wall, True if it is touched at an end (where only a balanced particle can rest), and
    the longest bounce that counts as rest.
    """
    row, at_end, longest = contact
    support = gravity.support
    press = pressing(flights, i, normal, space, gravity, longest)
    v = velocity_of(flights, i, space)
    speed = -dot(normal, v)
    highest = 2.0 * press * support.height
    if not (press > 0.0 and (speed * speed <= highest or speed < press * longest)):
        if not rest_in_wedge(flights, i, normal, (mass, longest), space, tally, gravity, support):
            release(flights, i, space, support)
        return
    if support.number[i] == 0:
        add_floors(flights, i, space, gravity, longest)
    add_plane(flights, i, normal, row, space, support)
    dimension = len(space.lengths)
    find_pull(gravity, i, dimension)
    last = support.number[i] - 1
    wx, wy, wz = within(support, i, (last, last - 1 if last > 0 else -1), v, dimension)
    if last == 2:
        wx = wy = wz = 0.0
    lost = (v[0] - wx) * (v[0] - wx) + (v[1] - wy) * (v[1] - wy) + (v[2] - wz) * (v[2] - wz)
    pull = support.pull[i]
    moves = wx != 0.0 or wy != 0.0 or wz != 0.0 or pull[0] != 0.0 or pull[1] != 0.0 or pull[2] != 0.0
    if lost <= 4.0 * max(highest, speed * speed) and not (at_end and moves):
        lost = dot(v, v) - (wx * wx + wy * wy + wz * wz)
    else:
        release(flights, i, space, support)
        more = max(0.0, press * gravity.shortest_bounce * _HOP - speed)
        wx, wy, wz = v[0] - more * normal[0], v[1] - more * normal[1], v[2] - more * normal[2]
        lost = -more * (2.0 * speed + more)
    flights[i].velocity[0], flights[i].velocity[1] = wx, wy
    if dimension == 3:
        flights[i].velocity[2] = wz
    add(tally.sums, LOSS, 0.5 * mass * lost)


@inner_helper
def time_to_leave(at, speed, pull, length):
    """Return the time until a coordinate along a wall is outside [0, length]; inf if never."""
    time = inf
    if at <= length:
        time = time_to_side(length - at, speed, pull)
    if at >= 0.0:
        time = min(time, time_to_side(at, -speed, -pull))
    return time


@inner_helper
def leave(flights, i, edge, at, length, space):
    """Move a particle at the end of a wall beyond the end, by more than rounding. `edge`: (3,), unit vector
    along which the coordinate of the particle is `at`.
    """
    beyond = length
    for k in range(len(space.lengths)):
        beyond += abs(flights[i].position[k])
    beyond *= 2.0**-46
    more = 0.0
    if at > 0.5 * length and at < length + beyond and at > length - beyond:
        more = length + beyond - at
    if at < 0.5 * length and at > -beyond and at < beyond:
        more = -beyond - at
    for k in range(len(space.lengths)):
        flights[i].position[k] += more * edge[k]


# If bounces become shorter than the contact duration, the particle comes to rest.
#
# The contact of a single particle with a floor then never ends. A particle that others press against the
# floor rests only after much shorter bounces. Otherwise it would absorb the energy of elastic contacts.


@inner_helper
def longest_rest(flights, i, gravity, law):
    """Return half of the duration of the longest bounce at a wall that counts as rest."""
    if law is not None:
        return _longest_rest(flights, i, gravity, law.duration)
    return gravity.shortest_bounce


@inner_helper
def _longest_rest(flights, i, gravity, duration):
    if duration is not None:
        part = 1.0 if is_alone(flights, i, duration) else SHORTEST
        return max(gravity.shortest_bounce, 0.5 * part * duration.length)
    return gravity.shortest_bounce


@inner_helper
def rest_on_floor(flights, i, face, tally, gravity, law):
    """Put a particle to rest after a bounce on a floor if the bounce is short."""
    if law is not None:
        _rest_on_floor(flights, i, face, tally, gravity, law, law.duration)


@inner_helper
def _rest_on_floor(flights, i, face, tally, gravity, law, duration):
    if duration is not None:
        axis = face // 2
        pull = gravity.acceleration[axis]
        toward = pull if face % 2 else -pull
        speed = flights[i].velocity[axis]
        if toward > 0.0 and abs(speed) < toward * _longest_rest(flights, i, gravity, duration):
            add(tally.sums, LOSS, 0.5 * speed * speed / law.inverse_mass[i])
            flights[i].velocity[axis] = 0.0
