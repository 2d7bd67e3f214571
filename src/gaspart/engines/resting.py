"""Bodies that rest on walls, or slide along them, under gravity.

A bounce too low for positions, or too short for clocks, to resolve is taken for rest: the velocity across the
wall becomes zero, and of gravity there remains what no wall supports, its projection on the directions that
lead into none of them. The body is released by the next contact that moves it, and where it leaves the wall.
"""

from math import inf, sqrt

from gaspart.engines.flight import face_plane
from gaspart.engines.layout import LOSS, NOTHING
from gaspart.engines.running_sum import add
from gaspart.falling import time_to_side
from gaspart.kernel import inner_helper, inner_kernel

_INTO = 2.0**-40  # of gravity: what leads less into a wall runs along it
_PARALLEL = 2.0**-40  # squared sine of an angle between planes that are taken for one
_HOP = 2.0**20  # times `blink`: the shortest bounce where a body cannot rest, as at the end of a wall


@inner_kernel
def pull_along(gravity, axis):
    """Gravity along an axis, 0 along a third one that does not exist."""
    return gravity.pull[axis] if axis < len(gravity.pull) else 0.0


@inner_kernel
def release(rows, body, space, support):
    """Let gravity act on a body in full, which is exactly at the walls that it rested on until now."""
    if support is None:
        return
    for n in range(support.number[body]):
        off = support.plane[body, n]
        for k in range(len(space.lengths)):
            off -= support.normal[body, n, k] * rows[body, k]
        for k in range(len(space.lengths)):
            rows[body, k] += off * support.normal[body, n, k]
    support.number[body] = 0


@inner_helper
def is_resting_on(support, body, piece):
    """Whether a body rests on a piece of an interior wall, or slides along it."""
    if support is None:
        return False
    found = False
    for n in range(support.number[body]):
        found |= support.piece[body, n] == piece
    return found


@inner_helper
def across(support, body, n, x, y, z):
    """The component of a vector along the normal of the n-th plane."""
    return support.normal[body, n, 0] * x + support.normal[body, n, 1] * y + support.normal[body, n, 2] * z


@inner_kernel
def within(support, body, first, second, x, y, z, d):
    """The projection of a vector on a plane, or on its intersection with a second one if that is not -1."""
    part = across(support, body, first, x, y, z)
    n = support.normal[body, first]
    if second < 0:
        return x - part * n[0], y - part * n[1], z - part * n[2]
    m = support.normal[body, second]
    lx, ly, lz = n[1] * m[2] - n[2] * m[1], n[2] * m[0] - n[0] * m[2], n[0] * m[1] - n[1] * m[0]
    square = lx * lx + ly * ly + lz * lz
    if square <= _PARALLEL:
        return x - part * n[0], y - part * n[1], z - part * n[2]
    if d == 2:
        return 0.0, 0.0, 0.0
    part = (x * lx + y * ly + z * lz) / square
    return part * lx, part * ly, part * lz


@inner_kernel
def find_pull(gravity, body, d):
    """Write down the acceleration that the planes of a body leave of gravity: the largest projection on one
    or two of them that leads into none; zero if there is no such one. Forget planes that it leads away from.
    """
    support = gravity.support
    gx, gy, gz = pull_along(gravity, 0), pull_along(gravity, 1), pull_along(gravity, 2)
    least = _INTO * sqrt(gx * gx + gy * gy + gz * gz)
    best, pull = 0.0, support.pull[body]
    pull[:] = 0.0
    for first in range(support.number[body]):
        for second in range(-1, first):
            x, y, z = within(support, body, first, second, gx, gy, gz, d)
            square = x * x + y * y + z * z
            leads_into = False
            for n in range(support.number[body]):
                leads_into |= across(support, body, n, x, y, z) < -least
            if square > best and not leads_into:
                best, pull[0], pull[1], pull[2] = square, x, y, z
    kept = 0
    for n in range(support.number[body]):
        if across(support, body, n, pull[0], pull[1], pull[2]) <= least:
            for k in range(3):
                support.normal[body, kept, k] = support.normal[body, n, k]
            support.plane[body, kept] = support.plane[body, n]
            support.piece[body, kept] = support.piece[body, n]
            kept += 1
    support.number[body] = kept


@inner_helper
def add_plane(rows, body, x, y, z, piece, space, support):
    """Add the plane that a body touches in the direction of the unit vector (x, y, z); the third gives way to
    a fourth one."""
    n = min(support.number[body], 2)
    support.normal[body, n, 0], support.normal[body, n, 1], support.normal[body, n, 2] = -x, -y, -z
    support.plane[body, n] = 0.0
    for k in range(len(space.lengths)):
        support.plane[body, n] += support.normal[body, n, k] * rows[body, k]
    support.piece[body, n] = piece
    support.number[body] = n + 1


@inner_kernel
def add_floors(rows, body, space, gravity):
    """Add the faces of the container on which a body lies still (`flight.acceleration`)."""
    d = len(space.lengths)
    for k in range(d):
        pull = gravity.pull[k]
        if pull != 0.0 and rows[body, d + k] == 0.0:
            floor = face_plane(rows, body, k, pull > 0.0, space)
            if (rows[body, k] >= floor) if pull > 0.0 else (rows[body, k] <= floor):
                side = 1.0 if pull > 0.0 else -1.0
                x, y, z = side if k == 0 else 0.0, side if k == 1 else 0.0, side if k == 2 else 0.0
                add_plane(rows, body, x, y, z, NOTHING, space, gravity.support)


@inner_helper
def pressing(body, x, y, z, gravity):
    """The acceleration of a body in the direction of the unit vector (x, y, z)."""
    if gravity.support.number[body] > 0:
        pull = gravity.support.pull[body]
        return x * pull[0] + y * pull[1] + z * pull[2]
    return x * pull_along(gravity, 0) + y * pull_along(gravity, 1) + z * pull_along(gravity, 2)


@inner_kernel
def come_to_rest(rows, body, x, y, z, piece, at_end, mass, space, counters, gravity):
    """After a bounce on a wall in the direction of the unit vector (x, y, z): let the body rest there if the
    bounce cannot be resolved, or else make it as long as can be. `at_end` of a wall only what is balanced
    can rest.
    """
    d, support = len(space.lengths), gravity.support
    press = pressing(body, x, y, z, gravity)
    vx, vy, vz = rows[body, d], rows[body, d + 1], 0.0
    if d == 3:
        vz = rows[body, d + 2]
    speed = -(x * vx + y * vy + z * vz)
    highest = 2.0 * press * support.height
    if not (press > 0.0 and (speed * speed <= highest or speed < press * gravity.blink)):
        release(rows, body, space, support)
        return
    if support.number[body] == 0:
        add_floors(rows, body, space, gravity)
    add_plane(rows, body, x, y, z, piece, space, support)
    find_pull(gravity, body, d)
    last = support.number[body] - 1
    wx, wy, wz = within(support, body, last, last - 1 if last > 0 else -1, vx, vy, vz, d)
    if last == 2:
        wx = wy = wz = 0.0
    lost = (vx - wx) * (vx - wx) + (vy - wy) * (vy - wy) + (vz - wz) * (vz - wz)
    pull = support.pull[body]
    moves = wx != 0.0 or wy != 0.0 or wz != 0.0 or pull[0] != 0.0 or pull[1] != 0.0 or pull[2] != 0.0
    if lost <= 4.0 * max(highest, speed * speed) and not (at_end and moves):
        lost = vx * vx + vy * vy + vz * vz - (wx * wx + wy * wy + wz * wz)
    else:
        release(rows, body, space, support)
        more = max(0.0, press * gravity.blink * _HOP - speed)
        wx, wy, wz = vx - more * x, vy - more * y, vz - more * z
        lost = -more * (2.0 * speed + more)
    rows[body, d], rows[body, d + 1] = wx, wy
    if d == 3:
        rows[body, d + 2] = wz
    add(counters.sums, LOSS, 0.5 * mass * lost)


@inner_helper
def time_to_leave(at, speed, pull, length):
    """Time until a coordinate along a wall is outside of [0, length]; inf if it never is."""
    time = inf
    if at <= length:
        time = time_to_side(length - at, speed, pull)
    if at >= 0.0:
        time = min(time, time_to_side(at, -speed, -pull))
    return time


@inner_helper
def leave(rows, body, x, y, z, at, length, space):
    """Move a body that is at the end of a wall beyond it, in the direction of the unit vector (x, y, z) along
    which its coordinate is `at`, by more than that is rounded by."""
    d = len(space.lengths)
    beyond = length
    for k in range(d):
        beyond += abs(rows[body, k])
    beyond *= 2.0**-46
    more = 0.0
    if at > 0.5 * length and at < length + beyond and at > length - beyond:
        more = length + beyond - at
    if at < 0.5 * length and at > -beyond and at < beyond:
        more = -beyond - at
    rows[body, 0] += more * x
    rows[body, 1] += more * y
    if d == 3:
        rows[body, 2] += more * z
