"""Flights of particles between events: straight, or parabolic under gravity.

`flights` (N,) are records of position, velocity, clock and radius (`model.flight_dtype`). If `gravity` is
None, the machine code contains no gravity.
"""

from __future__ import annotations

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.physics.ballistic import advance_coordinate, time_to_contact_pulled
from gaspart.kernels.physics.contact import TINY, time_to_contact, time_to_tiny_contact


@inner_helper
def face_plane(flights, i, axis, upper, space):
    """Return the coordinate at which a face stops, or a periodic face passes, the centre of a particle."""
    inset = 0.0 if space.periodic[axis] else space.margin * flights[i].radius
    return space.lengths[axis] - inset if upper else inset


@inner_helper
def is_supported(support, i):
    """Return True if a particle rests on walls or slides along them."""
    if support is None:
        return False
    return support.number[i] > 0


@inner_helper
def remaining_pull(support, i, axis):
    """Return the acceleration along an axis of a particle that is supported by walls."""
    if support is None:
        return 0.0
    return support.pull[i, axis]


@inner_helper
def acceleration_of(flights, i, axis, space, gravity):
    """Return the acceleration of a particle along an axis. The acceleration is 0 if the particle is fixed, or
    lies at rest on the face below. For a particle on walls, it is the part of gravity that the walls do not
    support.
    """
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
    """Mark in `resting` (N,) particles that may not be accelerated. A particle is marked if it is fixed,
    supported, or does not move along an axis with gravity (see `acceleration_of`).
    """
    if gravity is not None:
        rests = gravity.fixed[i] | is_supported(gravity.support, i)
        for k in range(len(space.lengths)):
            rests |= (gravity.acceleration[k] != 0.0) & (flights[i].velocity[k] == 0.0)
        resting[i] = rests


@inner_helper
def advance(flights, i, time, space, gravity):
    """Move a particle along its flight to `time`."""
    late = time - flights[i].clock
    for k in range(len(space.lengths)):
        if gravity is None:
            flights[i].position[k] += flights[i].velocity[k] * late
        else:
            pull = acceleration_of(flights, i, k, space, gravity)
            flights[i].position[k] = advance_coordinate(
                flights[i].position[k], flights[i].velocity[k], pull, late
            )
            flights[i].velocity[k] += pull * late
    flights[i].clock = time


@kernel
def advance_all(flights, time, space, gravity):
    """Move all particles along their flights to `time`."""
    for i in range(len(flights)):
        advance(flights, i, time, space, gravity)


@kernel
def restart_clocks(flights, time, space, gravity):
    """Move all particles to `time`, which becomes time 0 of their clocks."""
    for i in range(len(flights)):
        advance(flights, i, time, space, gravity)
        flights[i].clock = 0.0


@inner_helper
def _gap_and_velocity(flights, i, j, k, start, offset, space, gravity):
    """Return the separation and relative velocity of two particles along an axis at a time."""
    late_i, late_j = start - flights[i].clock, start - flights[j].clock
    x_i, x_j = flights[i].position[k], flights[j].position[k]
    v_i, v_j = flights[i].velocity[k], flights[j].velocity[k]
    if gravity is None:
        return (x_j + v_j * late_j) - (x_i + v_i * late_i) + offset[k], v_j - v_i
    pull_i = acceleration_of(flights, i, k, space, gravity)
    pull_j = acceleration_of(flights, j, k, space, gravity)
    r = (
        advance_coordinate(x_j, v_j, pull_j, late_j)
        - advance_coordinate(x_i, v_i, pull_i, late_i)
        + offset[k]
    )
    return r, (v_j + pull_j * late_j) - (v_i + pull_i * late_i)


@inner_helper
def encounter(flights, i, j, offset, space, gravity):
    """Return time and invariants of two particles at the later of their clocks. The invariants are the
    products rr, rv, vv, ra, va, aa of their separation r, relative velocity v and acceleration a. `offset`:
    (d,), displacement of particle j.
    """
    start = max(flights[i].clock, flights[j].clock)
    rr = rv = vv = ra = va = aa = 0.0
    for k in range(len(space.lengths)):
        r, v = _gap_and_velocity(flights, i, j, k, start, offset, space, gravity)
        if gravity is not None:
            a = acceleration_of(flights, j, k, space, gravity) - acceleration_of(
                flights, i, k, space, gravity
            )
            ra += r * a
            va += v * a
            aa += a * a
        rr += r * r
        rv += r * v
        vv += v * v
    return start, rr, rv, vv, ra, va, aa


@inner_helper
def time_of_contact(flights, i, j, offset, space, gravity):
    """Return the time at which two particles touch; inf if they do not. `offset`: (d,), displacement of
    particle j.
    """
    start, rr, rv, vv, ra, va, aa = encounter(flights, i, j, offset, space, gravity)
    sigma = flights[i].radius + flights[j].radius
    ss = sigma * sigma
    if gravity is not None:
        if aa > 0.0:
            return start + time_to_contact_pulled(rr - ss, rv, vv, ra, va, aa)
    if ss < TINY * rr and rv < 0.0:
        cross = _cross_square(flights, i, j, start, offset, space, gravity)
        return start + time_to_tiny_contact(rr, rv, vv, ss, cross)
    return start + time_to_contact(rr, rv, vv, ss)


@inner_kernel
def _cross_square(flights, i, j, start, offset, space, gravity):
    """Return |r x v|^2 of the separation and the relative velocity of two particles at a time."""
    cross = 0.0
    for k in range(len(space.lengths)):
        r_k, v_k = _gap_and_velocity(flights, i, j, k, start, offset, space, gravity)
        for m in range(k):
            r_m, v_m = _gap_and_velocity(flights, i, j, m, start, offset, space, gravity)
            area = r_k * v_m - r_m * v_k
            cross += area * area
    return cross


# Planes across an axis at the boundaries of equal bins. An impulse counts for all planes above it.
#
# An impulse dp on a particle at z changes the momentum below every plane above z. Of the planes within the
# particle's own bin, this holds for the fraction 1 - f, where f is the relative height of the particle in the
# bin. So dp (1 - f) is added to the bin and dp f to the next one. The mean over the planes of a bin is then
# the sum of all entries up to the bin (docs/estimators.md). All impulses count, from contacts, walls and
# edges of wells: every change of a velocity between two flights.


@inner_helper
def row_of(i, row):
    """Return the row of sums for a particle. `row` (N,) contains the rows of the particles, or equals None if
    there is a single row.
    """
    if row is None:
        return 0
    return np.int64(row[i])


@inner_helper
def bin_at(position, bins):
    """Return the bin of a position, and the fraction of the bin below the position. The position is in units
    of bins. A position outside the range of the bins is assigned to the nearest bin, and the fraction is
    computed by the same linear formula.
    """
    bin_ = min(max(np.int64(position), 0), bins - 1)
    return bin_, position - bin_
