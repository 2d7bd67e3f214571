"""The faces of the container, and of the boxes in it: when a body comes to one, and what happens there."""

from math import inf

from gaspart.contact import time_to_plane
from gaspart.engines.flight import acceleration, advance_row, face_plane
from gaspart.engines.impact import strike_wall
from gaspart.engines.layout import INNER, NOTHING
from gaspart.engines.resting import come_to_rest, release
from gaspart.engines.running_sum import add
from gaspart.engines.surfaces import find_edge, mass_of, touch_surface
from gaspart.falling import time_against, time_along
from gaspart.kernel import inner_helper, inner_kernel


@inner_helper
def plane_of(rows, plans, body, axis, upper, space, partition, big):
    """The lower or upper face of the body's box along an axis: (coordinate for its centre, face code). A wall
    stops a big body some boxes before the last."""
    at = plans[body].at[axis]
    code = 2 * axis + (1 if upper else 0)
    if at == (partition.per_side[axis] - 1 if upper else 0):
        return face_plane(rows, body, axis, upper, space), code
    plane = (at + 1 if upper else at) * partition.widths[axis]
    if big is not None:
        outer = face_plane(rows, body, axis, upper, space)
        if outer <= plane if upper else outer >= plane:
            return outer, code
    return plane, code + INNER


@inner_helper
def find_face(rows, plans, body, space, partition, now, gravity, surfaces, big):
    """The next face that the body comes to, of its box or of the container, or the edge of a well: (time,
    face code).

    A falling body may cross the face of a box, turn, and cross it again in the same flight: `now` tells which
    of its crossings lie behind it.
    """
    d = len(space.lengths)
    soon = inf
    face = NOTHING
    for k in range(d):
        v = rows[body, d + k]
        if gravity is not None:
            pull = acceleration(rows, body, k, space, gravity)
            if pull != 0.0:
                time, code = find_face_pulled(rows, plans, body, k, pull, space, partition, now, big)
                if time < soon:
                    soon = time
                    face = code
                continue
        if v == 0.0:
            continue
        if surfaces is not None:
            time, code = find_edge(rows, body, k, space, surfaces)
            if time < soon:
                soon = time
                face = code
        plane, code = plane_of(rows, plans, body, k, v > 0.0, space, partition, big)
        time = rows[body, 2 * d] + time_to_plane(rows[body, k], v, plane)
        if time < soon:
            soon = time
            face = code
    return soon, face


@inner_kernel
def find_face_pulled(rows, plans, body, axis, pull, space, partition, now, big):
    """The same along one axis with a pull: (time, face code).

    Until a body that rises against the pull turns, it can only leave through the face ahead, and afterwards
    only through the one that the pull leads to, so no face is ever crossed twice in the same direction (the
    rule of Spencer 2022, section 2.1.2, in a form that rounding cannot turn into a loop).
    """
    d = len(space.lengths)
    x = rows[body, axis]
    clock = rows[body, 2 * d]
    upper = pull > 0.0
    strength = abs(pull)
    along = rows[body, d + axis] if upper else -rows[body, d + axis]  # speed towards where the pull leads
    turn = clock if along >= 0.0 else clock - along / strength
    if along < 0.0:
        plane, code = plane_of(rows, plans, body, axis, not upper, space, partition, big)
        gap = x - plane if upper else plane - x
        time = clock + time_against(gap, -along, strength)
        if code < INNER:
            if time < inf:
                return time, code
        elif now < turn and time < inf:
            return min(time, turn), code
    plane, code = plane_of(rows, plans, body, axis, upper, space, partition, big)
    gap = plane - x if upper else x - plane
    time = clock + time_along(gap, along, strength)
    if code >= INNER:
        time = max(time, turn)
    return time, code


@inner_kernel
def meet_face(rows, images, body, face, time, space, masses, counters, gravity, law, surfaces):
    """Reflect a body at a wall, or take it from a periodic face to the opposite one. True if a wall."""
    d = len(space.lengths)
    axis = face // 2
    upper = face % 2 == 1
    advance_row(rows, body, time, space, gravity)
    if gravity is not None:
        if space.periodic[axis]:  # it comes to rest anew, on another image of the wall
            release(rows, body, space, gravity.support)
    if space.periodic[axis]:
        rows[body, axis] = 0.0 if upper else space.lengths[axis]
        images[body, axis] += 1 if upper else -1
        return False
    rows[body, axis] = face_plane(rows, body, axis, upper, space)
    hard = bounce(rows, body, face, space, masses, counters, law, surfaces)
    if gravity is not None:
        # a bounce too short for the clocks to tell is rest; otherwise it would be repeated for ever
        if hard and abs(rows[body, d + axis]) < abs(gravity.pull[axis]) * gravity.blink:
            rows[body, d + axis] = 0.0
        rest_on_face(rows, body, face, hard, space, masses, counters, gravity, law, gravity.support)
    return True


@inner_kernel
def rest_on_face(rows, body, face, hard, space, masses, counters, gravity, law, support):
    """Let a body that slides along an interior wall down to a face rest on both, or release it."""
    if support is None:
        return
    if support.number[body] > 0:
        if not hard:
            release(rows, body, space, support)
            return
        axis, side = face // 2, 1.0 if face % 2 else -1.0
        x, y, z = side if axis == 0 else 0.0, side if axis == 1 else 0.0, side if axis == 2 else 0.0
        mass = mass_of(body, masses, law)
        come_to_rest(rows, body, x, y, z, NOTHING, False, mass, space, counters, gravity)


@inner_helper
def bounce(rows, body, face, space, masses, counters, law, surfaces):
    """Let a wall act on a body that has come to it. Returns whether it is a hard one."""
    d = len(space.lengths)
    axis = face // 2
    counters.wall_hits[face] += 1
    if surfaces is not None:
        if touch_surface(rows, body, face, space, masses, counters, law, surfaces):
            return False
    if law is None:
        mass = 1.0 if masses is None else masses[body]
        add(counters.wall_impulse, face, 2.0 * mass * abs(rows[body, d + axis]))
        rows[body, d + axis] = -rows[body, d + axis]
    else:
        side = 1.0 if face % 2 else -1.0
        x = side if axis == 0 else 0.0
        y = side if axis == 1 else 0.0
        z = side if axis == 2 else 0.0
        add(counters.wall_impulse, face, strike_wall(rows, body, x, y, z, 0.0, space, counters, law))
    return True
