"""Particles between their events: straight flight, or parabolic under gravity.

`flights` (N,) are records of position, velocity, clock and radius (`model.flight_dtype`). Where `gravity` is
None, the machine code knows none.
"""

from __future__ import annotations

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, kernel
from gaspart.kernels.physics.ballistic import flown, time_to_contact_pulled
from gaspart.kernels.physics.contact import time_to_contact


@inner_helper
def face_plane(flights, i, axis, upper, space):
    """Where a face of the container stops, or on a periodic axis passes on, the centre of a particle."""
    inset = 0.0 if space.periodic[axis] else space.margin * flights[i].radius
    return space.lengths[axis] - inset if upper else inset


@inner_helper
def is_supported(support, i):
    """Whether a particle rests on or slides along walls."""
    if support is None:
        return False
    return support.number[i] > 0


@inner_helper
def remaining_pull(support, i, axis):
    """The acceleration along an axis of a particle that is supported."""
    if support is None:
        return 0.0
    return support.pull[i, axis]


@inner_helper
def acceleration_of(flights, i, axis, space, gravity):
    """The acceleration of a particle along an axis: none if it is fixed, or lies at rest on the face below;
    what the walls that it rests on leave of gravity."""
    if is_supported(gravity.support, i) and not gravity.fixed[i]:
        return remaining_pull(gravity.support, i, axis)
    pull = gravity.acceleration[axis]
    if pull == 0.0 or gravity.fixed[i]:
        return 0.0
    if flights[i].velocity[axis] == 0.0 and not space.periodic[axis]:
        x = flights[i].position[axis]
        if pull < 0.0 and x <= face_plane(flights, i, axis, False, space):
            return 0.0
        if pull > 0.0 and x >= face_plane(flights, i, axis, True, space):
            return 0.0
    return pull


@inner_helper
def mark_resting(flights, i, space, gravity, resting):
    """Mark in `resting` (N,) whether a particle may not be accelerated (see `acceleration_of`): it is fixed,
    or does not move along an axis with a pull."""
    if gravity is not None:
        found = gravity.fixed[i] | is_supported(gravity.support, i)
        for k in range(len(space.lengths)):
            found |= (gravity.acceleration[k] != 0.0) & (flights[i].velocity[k] == 0.0)
        resting[i] = found


@inner_helper
def advance(flights, i, time, space, gravity):
    """Move a particle along its flight to `time`."""
    late = time - flights[i].clock
    for k in range(len(space.lengths)):
        if gravity is None:
            flights[i].position[k] += flights[i].velocity[k] * late
        else:
            pull = acceleration_of(flights, i, k, space, gravity)
            flights[i].position[k] = flown(flights[i].position[k], flights[i].velocity[k], pull, late)
            flights[i].velocity[k] += pull * late
    flights[i].clock = time


@kernel
def advance_all(flights, time, space, gravity):
    """Move all particles to `time`."""
    for i in range(len(flights)):
        advance(flights, i, time, space, gravity)


@kernel
def restart_clocks(flights, time, space, gravity):
    """Move all particles to `time`, and let that be time 0 of their clocks."""
    for i in range(len(flights)):
        advance(flights, i, time, space, gravity)
        flights[i].clock = 0.0


@inner_helper
def encounter(flights, i, j, offset, space, gravity):
    """Particles i and j, the latter displaced by `offset` (d,), at the later of their clocks: that time, and
    of their separation r, relative velocity v and acceleration a the products rr, rv, vv, ra, va, aa."""
    start = max(flights[i].clock, flights[j].clock)
    late_i = start - flights[i].clock
    late_j = start - flights[j].clock
    rr = rv = vv = ra = va = aa = 0.0
    for k in range(len(space.lengths)):
        x_i, x_j = flights[i].position[k], flights[j].position[k]
        v_i, v_j = flights[i].velocity[k], flights[j].velocity[k]
        if gravity is None:
            v = v_j - v_i
            r = (x_j + v_j * late_j) - (x_i + v_i * late_i) + offset[k]
        else:
            pull_i = acceleration_of(flights, i, k, space, gravity)
            pull_j = acceleration_of(flights, j, k, space, gravity)
            a = pull_j - pull_i
            v = (v_j + pull_j * late_j) - (v_i + pull_i * late_i)
            r = flown(x_j, v_j, pull_j, late_j) - flown(x_i, v_i, pull_i, late_i) + offset[k]
            ra += r * a
            va += v * a
            aa += a * a
        rr += r * r
        rv += r * v
        vv += v * v
    return start, rr, rv, vv, ra, va, aa


@inner_helper
def time_of_contact(flights, i, j, offset, space, gravity):
    """When particles i and j touch, j displaced by `offset` (d,); inf if they do not."""
    start, rr, rv, vv, ra, va, aa = encounter(flights, i, j, offset, space, gravity)
    sigma = flights[i].radius + flights[j].radius
    ss = sigma * sigma
    if gravity is not None:
        if aa > 0.0:
            return start + time_to_contact_pulled(rr - ss, rv, vv, ra, va, aa)
    return start + time_to_contact(rr, rv, vv, ss)


# Along one axis of the container: the box that holds a coordinate, the nearest image of a difference.


@inner_helper
def box_coordinate(x, width, per_side):
    """Which box along an axis holds coordinate x; the outermost one for x outside."""
    c = int(x / width)
    return min(max(c, 0), per_side - 1)


@inner_helper
def nearest(gap, length, periodic):
    """A difference of two coordinates of the container, by the nearest image on a periodic axis."""
    if periodic:
        if gap + gap > length:
            return gap - length
        if gap + gap < -length:
            return gap + length
    return gap


# Planes across an axis, those of equal bins: which of them an impulse acts below.
#
# An impulse dp on a particle at z changes the momentum below every plane above z. Of the planes of one bin
# that is the part 1 - f, where f is how far up in the bin the particle is: the bin is given dp (1 - f),
# the next one dp f, and the mean over the planes of a bin is the sum of all up to it
# (docs/estimators.md). Impulses of any origin count, of contacts, walls and edges of wells: all that
# changes a velocity between two flights.


@inner_helper
def row_of(i, row):
    """The row of sums that a particle adds to, of `row` (N,), or None if there is one."""
    if row is None:
        return 0
    return np.int64(row[i])


@inner_helper
def bin_at(place, bins):
    """In which of so many bins a place is, counted in bins, and how far up in it. What is outside counts as
    in the last bin on that side, by the same line."""
    bin_ = min(max(np.int64(place), 0), bins - 1)
    return bin_, place - bin_
