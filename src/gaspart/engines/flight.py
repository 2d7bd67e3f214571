"""Bodies between their events, as rows: straight flight, or parabolic under gravity.

A row of 8 numbers, one cache line, holds a body's position (d), velocity (d), clock and radius, true at that
clock. Where `gravity` is None, the machine code knows none.
"""

from gaspart.contact import time_to_contact
from gaspart.falling import flown, time_to_contact_pulled
from gaspart.kernel import inner_helper, kernel


@inner_helper
def face_plane(rows, body, axis, upper, space):
    """Where a face of the container stops, or on a periodic axis passes on, this body's centre."""
    inset = 0.0 if space.periodic[axis] else space.margin * rows[body, 2 * len(space.lengths) + 1]
    return space.lengths[axis] - inset if upper else inset


@inner_helper
def is_supported(support, body):
    """Whether a body rests on or slides along walls."""
    if support is None:
        return False
    return support.number[body] > 0


@inner_helper
def remaining_pull(support, body, axis):
    """The acceleration along an axis of a body that is supported."""
    if support is None:
        return 0.0
    return support.pull[body, axis]


@inner_helper
def acceleration(rows, body, axis, space, gravity):
    """What pulls a body along an axis: nothing if it is fixed, or lies still on the face below; what the
    walls leave that it rests on."""
    if is_supported(gravity.support, body):
        return remaining_pull(gravity.support, body, axis)
    pull = gravity.pull[axis]
    if pull == 0.0 or gravity.fixed[body]:
        return 0.0
    if rows[body, len(space.lengths) + axis] == 0.0:
        x = rows[body, axis]
        if pull < 0.0 and x <= face_plane(rows, body, axis, False, space):
            return 0.0
        if pull > 0.0 and x >= face_plane(rows, body, axis, True, space):
            return 0.0
    return pull


@inner_helper
def note_still(rows, body, space, gravity, still):
    """Note whether a body may be one that is not pulled (see `acceleration`): it is fixed, or does not move
    along an axis with a pull."""
    d = len(space.lengths)
    found = gravity.fixed[body] | is_supported(gravity.support, body)
    for k in range(d):
        found |= (gravity.pull[k] != 0.0) & (rows[body, d + k] == 0.0)
    still[body] = found


@inner_helper
def advance_row(rows, body, time, space, gravity):
    """Move a body along its flight to `time`."""
    d = len(space.lengths)
    late = time - rows[body, 2 * d]
    for k in range(d):
        if gravity is None:
            rows[body, k] += rows[body, d + k] * late
        else:
            pull = acceleration(rows, body, k, space, gravity)
            rows[body, k] = flown(rows[body, k], rows[body, d + k], pull, late)
            rows[body, d + k] += pull * late
    rows[body, 2 * d] = time


@kernel
def advance_rows(rows, time, space, gravity):
    """Move all bodies to `time`."""
    for body in range(len(rows)):
        advance_row(rows, body, time, space, gravity)


@kernel
def synchronise(rows, time, space, gravity):
    """Advance all bodies to `time`, and let that be time 0 of their clocks."""
    for body in range(len(rows)):
        advance_row(rows, body, time, space, gravity)
        rows[body, 2 * len(space.lengths)] = 0.0


@inner_helper
def encounter(rows, i, j, offset, space, gravity):
    """Bodies i and j, the latter displaced by `offset` (d,), at the later of their clocks: that time, and of
    their separation r, relative velocity v and acceleration a the products rr, rv, vv, ra, va, aa."""
    d = len(space.lengths)
    start = max(rows[i, 2 * d], rows[j, 2 * d])
    late_i = start - rows[i, 2 * d]
    late_j = start - rows[j, 2 * d]
    rr = rv = vv = ra = va = aa = 0.0
    for k in range(d):
        if gravity is None:
            v = rows[j, d + k] - rows[i, d + k]
            r = (rows[j, k] + rows[j, d + k] * late_j) - (rows[i, k] + rows[i, d + k] * late_i) + offset[k]
        else:
            pull_i = acceleration(rows, i, k, space, gravity)
            pull_j = acceleration(rows, j, k, space, gravity)
            a = pull_j - pull_i
            v = (rows[j, d + k] + pull_j * late_j) - (rows[i, d + k] + pull_i * late_i)
            r = (
                flown(rows[j, k], rows[j, d + k], pull_j, late_j)
                - flown(rows[i, k], rows[i, d + k], pull_i, late_i)
                + offset[k]
            )
            ra += r * a
            va += v * a
            aa += a * a
        rr += r * r
        rv += r * v
        vv += v * v
    return start, rr, rv, vv, ra, va, aa


@inner_helper
def contact_square(rows, i, j, space):
    """The square of the distance at which two bodies touch."""
    radius = 2 * len(space.lengths) + 1
    sigma = rows[i, radius] + rows[j, radius]
    return sigma * sigma


@inner_helper
def pair_time(rows, i, j, offset, space, gravity):
    """When bodies i and j touch, j displaced by `offset` (d,); inf if they do not."""
    start, rr, rv, vv, ra, va, aa = encounter(rows, i, j, offset, space, gravity)
    ss = contact_square(rows, i, j, space)
    if gravity is not None:
        if aa > 0.0:
            return start + time_to_contact_pulled(rr - ss, rv, vv, ra, va, aa)
    return start + time_to_contact(rr, rv, vv, ss)
