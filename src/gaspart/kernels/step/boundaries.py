"""Contacts with rules of the event-driven engine: special faces, and rough or vibrating particles.

The functions of the event-driven engine are applied to its flights. This module writes a particle into its
flight with the clock at 0, the end of the step. It finds the past time at which the particle reached a face,
and writes the flight back. Only one thread does this. The sums are nevertheless integers, because the order
of slots is not fixed.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import LOSS as LOST
from gaspart.kernels.model import NONE, STICKY, WELL_EDGES, Model, Tally
from gaspart.kernels.obstacles.face import collide_face
from gaspart.kernels.obstacles.thermal import cross_edge, time_to_edge
from gaspart.kernels.physics.collision import collide_by_law
from gaspart.kernels.physics.contact import time_to_plane
from gaspart.kernels.physics.flight import advance, bin_at, face_plane, row_of
from gaspart.kernels.physics.running_sum import add, add_whole
from gaspart.kernels.step.model import LOSS, VIRIAL

# Impulses, tallied by the position where a particle receives them, along one axis (`kernels.physics.flight`),
# for time steps.
#
# Between two impulses a particle flies freely, possibly for a negative time. The position of a contact is the
# position to which the pair is rewound, and the position of a reflection is the face. So positions change
# only by flights, and the transport through planes follows from the impulses, up to rounding, for any step.


@inner_helper
def place_and_speed(particles, slot, ago, tally, impulses):
    """Return the past position of a particle, and its velocity at the end of the step. The position is on its
    present flight. Both are along the axis of the impulses. They are 0 if no impulses are tallied. `ago`:
    time relative to the end of the step, negative.
    """
    if impulses is not None:
        v = np.float64(particles.velocities[tally.axis, slot])
        return particles.positions[tally.axis, slot] + ago * (v + 0.5 * tally.pull * ago), v
    return 0.0, 0.0


@inner_helper
def add_impulse(particles, slot, position, change, tally, thread, impulses):
    """Add the impulse that has changed a particle's velocity, at a position along the axis."""
    if impulses is not None:
        if change != 0.0:
            bins, number = impulses.shape[2] - 1, particles.index[slot]
            position *= tally.per_length
            position -= np.floor(position * tally.turns) * bins
            bin_, part = bin_at(position, bins)
            row = row_of(number, tally.row)
            impulse = np.float64(particles.masses[number]) * change
            upper = impulse * part
            add_whole(impulses[thread, row, bin_], impulse - upper, tally.momentum)
            add_whole(impulses[thread, row, bin_ + 1], upper, tally.momentum)


@inner_helper
def add_contact(particles, slot, before, tally, impulses):
    """Add the impulse of a contact. `before`: result of `place_and_speed` before the contact."""
    if impulses is not None:
        position, speed = before
        change = particles.velocities[tally.axis, slot] - speed
        add_impulse(particles, slot, position, change, tally, 0, impulses)


@inner_helper
def add_reflection(particles, slot, axis, at, tally, thread, impulses):
    """Add the impulse of a face across an axis. `at`: position of the face, and change of the velocity."""
    if impulses is not None:
        if axis == tally.axis:
            position, change = np.float64(at[0]), np.float64(at[1])
            add_impulse(particles, slot, position, change, tally, thread, impulses)


@inner_helper
def add_share(i, face, transfer, tally, thread, per_area):
    """Add momentum and heat given to a face to the sums per accessible area."""
    if per_area is not None:
        share, (impulse, heat) = tally.share[tally.size[i], face], transfer
        add_whole(per_area[thread, face, 0], share * impulse, tally.momentum)
        add_whole(per_area[thread, face, 1], share * heat, tally.energy)


@inner_helper
def own_impulses(impulses, part):
    """Return the sums of one thread in the form of the sums of all threads."""
    if impulses is None:
        return None
    return impulses[part : part + 1]


_SHORT = 2.0**-12  # fraction of a step below which bounces on a floor are not distinguished


class Rules(NamedTuple):
    """Data of the event-driven engine's kernels."""

    flights: np.ndarray
    model: Model
    tally: Tally
    free: np.ndarray
    holds: bool
    heat: np.ndarray


@inner_helper
def is_free(particles, slot, rules):
    """Return True if an ordinary particle cannot have hit a face or a well's edge."""
    free = True
    for k in range(particles.positions.shape[0]):
        x = particles.positions[k, slot]
        free &= (x >= rules.free[k, 0]) & (x < rules.free[k, 1])
        if rules.holds:
            free &= rules.model.faces.well_side[particles.index[slot], k] == 0
    return free


@inner_kernel
def gather(particles, slot, rules):
    """Write the particle in a slot into its flight, with the clock at 0; return its number."""
    flights, i = rules.flights, np.int64(particles.index[slot])
    for k in range(particles.positions.shape[0]):
        flights[i].position[k] = particles.positions[k, slot]
        flights[i].velocity[k] = particles.velocities[k, slot]
    flights[i].clock = 0.0
    flights[i].radius = particles.radii[slot]
    return i


@inner_kernel
def scatter(particles, slot, rules):
    """Write a flight back into its slot; return the squared speed of the particle."""
    flights, i = rules.flights, particles.index[slot]
    square = 0.0
    for k in range(particles.positions.shape[0]):
        particles.positions[k, slot] = flights[i].position[k]
        particles.velocities[k, slot] = flights[i].velocity[k]
        square += flights[i].velocity[k] * flights[i].velocity[k]
    return square


@inner_kernel
def crossing_time(flights, i, axis, space, faces):
    """Return when a particle crossed a face or the edge of a well: (time, face code). The crossing is along
    an axis, on the present flight, before the end of the step. Without a crossing the result is (inf, NONE).
    """
    v = flights[i].velocity[axis]
    if v == 0.0:
        return inf, NONE
    upper = v > 0.0
    side = faces.well_side[i, axis]
    if side != 0 and faces.kind[2 * axis + (1 if side > 0 else 0)] == STICKY:
        upper = side > 0
    else:  # no particle reaches a plane before the edge of its well
        time, face = time_to_edge(flights, i, axis, space, faces)
        if time <= 0.0:
            return time, face
    time = time_to_plane(flights[i].position[axis], v, face_plane(flights, i, axis, upper, space))
    return (time, 2 * axis + (1 if upper else 0)) if time <= 0.0 else (inf, NONE)


@inner_kernel
def crossing_time_pulled(flights, i, axis, pull, space, dt):
    """Return the time at which a particle crossed a face under gravity: (time, face code).
    `motion.reflect_falling` has the same formulas. If a contact has pushed a particle out, or if it falls too
    slowly to resolve its bounces, the time is the end of the step.
    """
    v = flights[i].velocity[axis]
    for side in range(2):
        plane = face_plane(flights, i, axis, side == 1, space)
        y, u, a = flights[i].position[axis] - plane, v, pull
        if side == 1:
            y, u, a = -y, -u, -a
        if y < 0.0:
            w = sqrt(max(0.0, u * u - 2.0 * y * a))
            if u < 0.0 and w <= _SHORT * dt * abs(a):
                return 0.0, 2 * axis + side
            past = 2.0 * y / (u - w)
            if u < 0.0 or (a > 0.0 and past <= dt):
                return -past, 2 * axis + side
    return inf, NONE


@inner_kernel
def first_crossing(flights, i, space, dt, faces, gravity):
    """Return the first of all faces and edges that a particle crossed, as `crossing_time`."""
    first, face = inf, NONE
    for k in range(len(space.lengths)):
        if not space.periodic[k]:
            pull = 0.0
            if gravity is not None:
                pull = gravity.acceleration[k]
            if pull == 0.0:
                time, code = crossing_time(flights, i, k, space, faces)
            else:
                time, code = crossing_time_pulled(flights, i, k, pull, space, dt)
            if time < first:
                first, face = time, code
    return first, face


@inner_helper
def pop_sum(sums, n):
    """Reset one of the sums (K, 2) to zero; return its previous value."""
    x = sums[n, 0] + sums[n, 1]
    sums[n, 0] = sums[n, 1] = 0.0
    return x


@inner_kernel
def record_face(i, face, rules, tally):
    """Move the contribution of an event at a face from the rules' tally to the engine's."""
    event = rules.tally
    tally.wall_hits[0, face] += event.wall_hits[face]
    transfer = pop_sum(event.wall_impulse, face), pop_sum(event.wall_energy, face)
    add_whole(tally.wall_impulse[0, face], transfer[0], tally.momentum)
    add_whole(tally.wall_loss[0], pop_sum(event.sums, LOST), tally.energy)
    add_whole(rules.heat[face], transfer[1], tally.energy)
    add_share(i, face, transfer, tally, 0, tally.per_area)
    event.wall_hits[face] = 0


@inner_helper
def speed_at_face(flights, i, tally, impulses):
    """Return a particle's velocity along the axis of impulses; 0 without a tally."""
    if impulses is not None:
        return flights[i].velocity[tally.axis]
    return 0.0


@inner_helper
def add_impulse_of_face(particles, slot, before, rules, tally, impulses):
    """Add the impulse of a face at the present position of a particle. `before`: velocity of the particle
    before it hit the face.
    """
    if impulses is not None:
        flight = rules.flights[particles.index[slot]]
        change, position = flight.velocity[tally.axis] - before, flight.position[tally.axis]
        add_impulse(particles, slot, position, change, tally, 0, impulses)


@inner_kernel
def meet_faces(particles, slot, rules, dt, tally, law):
    """Process all faces that a particle has crossed, one after another. Returns True if there was any."""
    i = gather(particles, slot, rules)
    flights, model, met = rules.flights, rules.model, False
    space, gravity, faces = model.space, model.gravity, model.faces
    while True:
        time, face = first_crossing(flights, i, space, dt, faces, gravity)
        if face == NONE:
            break
        met = True
        advance(flights, i, time, space, gravity)
        before = speed_at_face(flights, i, tally, tally.impulses)
        if face >= WELL_EDGES:
            face -= WELL_EDGES
            cross_edge(flights, i, face, model, rules.tally, law, faces)
        else:
            if time < 0.0:
                flights[i].position[face // 2] = face_plane(flights, i, face // 2, face % 2 == 1, space)
            collide_face(flights, i, face, model, rules.tally, law, faces)
        add_impulse_of_face(particles, slot, before, rules, tally, tally.impulses)
        advance(flights, i, 0.0, space, gravity)
        record_face(particles.index[slot], face, rules, tally)
    if met:
        scatter(particles, slot, rules)
    return met


@inner_kernel
def collide_flights(particles, i, j, contact, rules, tally, law):
    """Apply the collision law to the particles in two slots; return both squared speeds. All particles have
    the same acceleration, so they move uniformly relative to each other. `contact`: time of the contact,
    negative, and the invariants rr, rv at this time.
    """
    ago, rr, rv = contact
    flights, space = rules.flights, rules.model.space
    first, second = gather(particles, i, rules), gather(particles, j, rules)
    advance(flights, first, ago, space, None)
    advance(flights, second, ago, space, None)
    add(tally.sums, VIRIAL, collide_by_law(flights, first, second, rr, rv, space, rules.tally, law))
    add(tally.sums, LOSS, pop_sum(rules.tally.sums, LOST))
    advance(flights, first, 0.0, space, None)
    advance(flights, second, 0.0, space, None)
    return scatter(particles, i, rules), scatter(particles, j, rules)
