"""Contacts that know more than momenta: faces with a kind, rough bodies, bodies that vibrate.

Their physics is the event-driven engine's own, on rows as it lays bodies out: what is here only puts a body
into its row, its clock at 0, the end of the step, finds out when in the past it came to a face, and takes it
back. Only one thread does this; the sums are whole numbers all the same, since slots know no fixed order.
"""

from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from gaspart.contact import time_to_plane
from gaspart.engines import layout
from gaspart.engines.faces import bounce
from gaspart.engines.flight import advance_row, face_plane
from gaspart.engines.impact import strike
from gaspart.engines.layout import EDGES, NOTHING, STICKY
from gaspart.engines.running_sum import add, add_whole
from gaspart.engines.step_layout import LOSS, VIRIAL
from gaspart.engines.surfaces import cross_edge, find_edge
from gaspart.kernel import helper, kernel

_SHORT = 2.0**-12  # of a step: bounces on a floor in less time are not told apart


class Rules(NamedTuple):
    """rows (N, 8): room for bodies; surfaces, gravity (None if there is none): as the event-driven engine
    has them; gains: its counters, room for what one event adds to them. free (d, 2): between which
    coordinates a body that is held nowhere meets no face and no edge; holds: whether any face may hold
    bodies. heat (2d, 2): given to each face, by `running_sum.add_whole`."""

    rows: np.ndarray
    surfaces: layout.Surfaces
    gravity: layout.Gravity | None
    gains: layout.Counters
    free: np.ndarray
    holds: bool
    heat: np.ndarray


@helper
def is_free(bodies, rules, slot):
    """Whether an ordinary body cannot have met a face, nor the edge of a well."""
    free = True
    for k in range(bodies.positions.shape[0]):
        x = bodies.positions[k, slot]
        free &= (x >= rules.free[k, 0]) & (x < rules.free[k, 1])
        if rules.holds:
            free &= rules.surfaces.place[bodies.index[slot], k] == 0
    return free


@kernel
def take_up(bodies, rules, slot):
    """Put the body in a slot into its row; returns which one it is."""
    d, body = bodies.positions.shape[0], np.int64(bodies.index[slot])
    for k in range(d):
        rules.rows[body, k] = bodies.positions[k, slot]
        rules.rows[body, d + k] = bodies.velocities[k, slot]
    rules.rows[body, 2 * d] = 0.0
    rules.rows[body, 2 * d + 1] = bodies.radii[slot]
    return body


@kernel
def put_back(bodies, rules, slot):
    """The way back; returns the square of the body's speed."""
    d, body = bodies.positions.shape[0], bodies.index[slot]
    square = 0.0
    for k in range(d):
        bodies.positions[k, slot] = rules.rows[body, k]
        bodies.velocities[k, slot] = rules.rows[body, d + k]
        square += rules.rows[body, d + k] * rules.rows[body, d + k]
    return square


@kernel
def came(rows, body, axis, space, dt, surfaces):
    """When a body on its present flight came through a face across an axis, or the edge of a well there:
    (time, face code), a time up to the end of the step, or (inf, NOTHING).

    A body that is stuck to a face and moves all the same was set free, to be judged, when it left its plane.
    """
    v = rows[body, len(space.lengths) + axis]
    if v == 0.0:
        return inf, NOTHING
    upper = v > 0.0
    place = surfaces.place[body, axis]
    if place != 0 and surfaces.kind[2 * axis + (1 if place > 0 else 0)] == STICKY:
        upper = place > 0
    else:  # no body comes to a plane before the edge of its well
        time, face = find_edge(rows, body, axis, space, surfaces)
        if time <= 0.0:
            return time, face
    time = time_to_plane(rows[body, axis], v, face_plane(rows, body, axis, upper, space))
    return (time, 2 * axis + (1 if upper else 0)) if time <= 0.0 else (inf, NOTHING)


@kernel
def came_pulled(rows, body, axis, pull, space, dt):
    """The same under a pull along the axis, with the formulas of `step_motion.reflect_falling`. A body that
    was pushed out by a contact, or that comes down too slowly to tell its bounces apart, does so now."""
    v = rows[body, len(space.lengths) + axis]
    for side in range(2):
        plane = face_plane(rows, body, axis, side == 1, space)
        y, u, a = rows[body, axis] - plane, v, pull
        if side == 1:
            y, u, a = -y, -u, -a
        if y < 0.0:
            w = sqrt(max(0.0, u * u - 2.0 * y * a))
            if u < 0.0 and w <= _SHORT * dt * abs(a):
                return 0.0, 2 * axis + side
            past = 2.0 * y / (u - w)
            if u < 0.0 or (a > 0.0 and past <= dt):
                return -past, 2 * axis + side
    return inf, NOTHING


@kernel
def last_came(rows, body, space, dt, surfaces, gravity):
    """What the body came to first, of all that it came through: (time, face code) as in `came`."""
    first, face = inf, NOTHING
    for k in range(len(space.lengths)):
        if not space.periodic[k]:
            pull = 0.0
            if gravity is not None:
                pull = gravity.pull[k]
            if pull == 0.0:
                time, code = came(rows, body, k, space, dt, surfaces)
            else:
                time, code = came_pulled(rows, body, k, pull, space, dt)
            if time < first:
                first, face = time, code
    return first, face


@helper
def taken(sums, n):
    """What one of some sums (K, 2) holds, which is zero afterwards."""
    x = sums[n, 0] + sums[n, 1]
    sums[n, 0] = sums[n, 1] = 0.0
    return x


@kernel
def book(face, rules, counters):
    """Enter what an event at a face has added to the counters of its own."""
    gains = rules.gains
    counters.wall_hits[0, face] += gains.wall_hits[face]
    add_whole(counters.wall_impulse[0, face], taken(gains.wall_impulse, face), counters.momentum)
    add_whole(counters.wall_loss[0], taken(gains.sums, layout.LOSS), counters.energy)
    add_whole(rules.heat[face], taken(gains.wall_energy, face), counters.energy)
    gains.wall_hits[face] = 0


@kernel
def meet_faces(bodies, space, rules, law, slot, dt, counters):
    """Let a body meet all that it has come through, one after another. Returns whether there was anything."""
    body = take_up(bodies, rules, slot)
    rows, surfaces, met = rules.rows, rules.surfaces, False
    while True:
        time, face = last_came(rows, body, space, dt, surfaces, rules.gravity)
        if face == NOTHING:
            break
        met = True
        advance_row(rows, body, time, space, rules.gravity)
        if face >= EDGES:
            face -= EDGES
            cross_edge(rows, body, face, space, bodies.masses, rules.gains, law, surfaces)
        else:
            if time < 0.0:
                rows[body, face // 2] = face_plane(rows, body, face // 2, face % 2 == 1, space)
            bounce(rows, body, face, space, bodies.masses, rules.gains, law, surfaces)
        advance_row(rows, body, 0.0, space, rules.gravity)
        book(face, rules, counters)
    if met:
        put_back(bodies, rules, slot)
    return met


@kernel
def strike_in_rows(bodies, space, i, j, ago, rr, rv, rules, law, counters):
    """A contact under a law, at the time `ago` with the invariants rr, rv; the squares of the two speeds
    then.

    Bodies fall alike, so that relative to each other they move straight.
    """
    one, other = take_up(bodies, rules, i), take_up(bodies, rules, j)
    advance_row(rules.rows, one, ago, space, None)
    advance_row(rules.rows, other, ago, space, None)
    add(counters.sums, VIRIAL, strike(rules.rows, one, other, rr, rv, space, rules.gains, law))
    add(counters.sums, LOSS, taken(rules.gains.sums, layout.LOSS))
    advance_row(rules.rows, one, 0.0, space, None)
    advance_row(rules.rows, other, 0.0, space, None)
    return put_back(bodies, rules, i), put_back(bodies, rules, j)
