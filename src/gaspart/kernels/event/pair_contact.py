"""Contact of two particles in the event-driven engine."""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.event.impulses import speed_before, tally_impulse
from gaspart.kernels.event.jams import free_if_moved, join_jam, pressed_particle
from gaspart.kernels.event.sheared import fold, unfold
from gaspart.kernels.event.stress import end_flight, note_pair, tally_contact
from gaspart.kernels.model import COLLISIONS, FIXED_COLLISIONS, LOSS, VIRIAL
from gaspart.kernels.obstacles.support import longest_rest, release, rest_in_wedge
from gaspart.kernels.obstacles.thermal import mass_of
from gaspart.kernels.physics.collision import exchange_momentum, gap_along, meets_fixed, push
from gaspart.kernels.physics.contact import SHORTEST, meet_often
from gaspart.kernels.physics.flight import acceleration_of, advance
from gaspart.kernels.physics.rng import normal_pair
from gaspart.kernels.physics.running_sum import add

# Contacts of two particles that gravity presses together, for example in a stack at rest.
#
# The lower particle may rest on a floor or a wall, or be fixed. Then the upper particle falls relative to it
# and would hit it infinitely often. Or both particles are in a row that others press. The slower they are,
# the more often they collide, because the force equals the collision rate times the momentum. With a contact
# duration their separation speed has a lower bound, so that the time until gravity brings them together again
# is at least a small fraction of this duration. The added energy is far below the energy of a fall through
# one diameter, and counts as negative dissipation.


@inner_helper
def least_parting(flights, i, j, space, gravity, law):
    """Return the minimum separation speed of two touching particles; 0 if nothing presses them."""
    if gravity is not None:
        if law is not None:
            return _pressed_parting(flights, i, j, space, gravity, law.duration)
    return 0.0


@inner_helper
def _pressed_parting(flights, i, j, space, gravity, duration):
    if duration is not None:
        square = along = gravity_square = 0.0
        for k in range(len(space.lengths)):
            gap = gap_along(flights, i, j, k, space)
            pull = acceleration_of(flights, j, k, space, gravity)
            pull -= acceleration_of(flights, i, k, space, gravity)
            square += gap * gap
            along += gap * pull
            gravity_square += gravity.acceleration[k] * gravity.acceleration[k]
        pressing = max(0.0, -along / sqrt(square))
        if meet_often(flights, i, j, duration):
            pressing = max(pressing, sqrt(gravity_square))
        return pressing * 0.5 * SHORTEST * duration.length
    return 0.0


@inner_kernel
def direction(flights, i, j, space):
    """Return the unit vector (3,) from one particle to another."""
    x, y = gap_along(flights, i, j, 0, space), gap_along(flights, i, j, 1, space)
    z = gap_along(flights, i, j, 2, space)
    distance = sqrt(x * x + y * y + z * z)
    return x / distance, y / distance, z / distance


@inner_helper
def part(flights, i, j, least, model, tally, law):
    """Apply the minimum separation speed to two particles that have collided."""
    if law is not None:
        _part_pressed(flights, i, j, least, model.space, tally, law, law.duration)


@inner_kernel
def _part_pressed(flights, i, j, least, space, tally, law, duration):
    if duration is None or least == 0.0:
        return
    normal = direction(flights, i, j, space)
    speed = 0.0
    for k in range(len(space.lengths)):
        speed += normal[k] * (flights[j].velocity[k] - flights[i].velocity[k])
    if speed < least:
        mobility = law.inverse_mass[i] + law.inverse_mass[j]
        impulse = (least - speed) / mobility
        push(flights, i, -impulse * law.inverse_mass[i], normal, space)
        push(flights, j, impulse * law.inverse_mass[j], normal, space)
        add(tally.sums, LOSS, -0.5 * (least * least - speed * speed) / mobility)


@inner_helper
def release_pair(flights, i, j, model, tally, gravity, law):
    """Release two particles after their collision, unless one rests below a fixed particle. The full gravity
    acts on released particles.
    """
    if gravity is not None:
        _release_from(flights, i, j, model, tally, gravity, law)
        _release_from(flights, j, i, model, tally, gravity, law)


@inner_helper
def _release_from(flights, i, j, model, tally, gravity, law):
    """Release the first of two particles, unless it rests below the second."""
    if not _rests_below(flights, i, j, model.space, tally, gravity, law):
        release(flights, i, model.space, gravity.support)


@inner_helper
def _rests_below(flights, i, j, space, tally, gravity, law):
    """Put a particle to rest in the wedge below a fixed one; return True if it rests there."""
    if law is not None:
        if law.inverse_mass[j] == 0.0:
            return _rests_below_fixed(flights, i, j, space, tally, gravity, law, law.duration)
    return False


@inner_kernel
def _rests_below_fixed(flights, i, j, space, tally, gravity, law, duration):
    if duration is None:
        return False
    normal = direction(flights, i, j, space)
    particle = 1.0 / law.inverse_mass[i], longest_rest(flights, i, gravity, law)
    return rest_in_wedge(flights, i, normal, particle, space, tally, gravity, gravity.support)


@inner_helper
def collide(flights, i, j, time, model, tally):
    """Advance two particles to their contact and exchange momentum."""
    space = model.space
    end_flight(flights, i, time, model, tally.stress, model.shear)
    end_flight(flights, j, time, model, tally.stress, model.shear)
    advance(flights, i, time, space, model.gravity)
    advance(flights, j, time, space, model.gravity)
    image = unfold(flights, i, j, time, space, model.shear)
    rr = 0.0
    rv = 0.0
    for k in range(len(space.lengths)):
        gap = gap_along(flights, i, j, k, space)
        rr += gap * gap
        rv += gap * (flights[j].velocity[k] - flights[i].velocity[k])
    free_if_moved(i, j, rr, rv, model.gravity, model.law)
    joins = pressed_particle(flights, i, j, model.law)
    note_pair(flights, i, j, space, model.masses, model.law, tally.stress)
    before_i = speed_before(flights, i, tally.impulses)
    before_j = speed_before(flights, j, tally.impulses)
    least = least_parting(flights, i, j, space, model.gravity, model.law)
    add(tally.sums, VIRIAL, exchange_momentum(flights, i, j, rr, rv, model, tally, model.law))
    part(flights, i, j, least, model, tally, model.law)
    release_pair(flights, i, j, model, tally, model.gravity, model.law)
    join_jam(flights, joins, i + j - joins, model, tally, model.gravity, model.law)
    tally_contact(flights, i, j, time, model, tally.stress, model.shear)
    tally_impulse(flights, i, before_i, model, tally.impulses)
    tally_impulse(flights, j, before_j, model, tally.impulses)
    fold(flights, j, image, model, tally, model.shear)
    sigma = flights[i].radius + flights[j].radius
    tally.worst[0] = max(tally.worst[0], abs(rr / (sigma * sigma) - 1.0))
    tally.counts[COLLISIONS] += 1
    tally.counts[FIXED_COLLISIONS] += meets_fixed(i, j, model.law)


# Random kicks of all particles at once: the stochastic thermostat of a driven granular gas.


@inner_helper
def _energy(flights, i, mass, space):
    square = 0.0
    for k in range(len(space.lengths)):
        square += flights[i].velocity[k] * flights[i].velocity[k]
    return 0.5 * mass * square


@inner_helper
def _kick(flights, i, width, key, number, space):
    """Add normal random numbers of this width to the velocity components."""
    first, second, block = normal_pair(key, i, number, 1)
    flights[i].velocity[0] += width * first
    flights[i].velocity[1] += width * second
    if len(space.lengths) == 3:
        first, _, _ = normal_pair(key, i, number, block)
        flights[i].velocity[2] += width * first


@kernel
def kick_all(flights, time, width, counter, model, injected_energy):
    """Advance all particles to `time`, and kick them without changing the total momentum. `width`: width of
    the distribution of kicks for mass 1. `counter`: words (2,) of the key, and number of the kick.
    `injected_energy`: (1, 2), energy given to the particles, see `physics.running_sum.add`.
    """
    (key, number), space = counter, model.space
    total = px = py = pz = 0.0
    last = len(space.lengths) - 1
    for i in range(len(flights)):
        advance(flights, i, time, space, model.gravity)
        mass = mass_of(i, model.masses, model.law)
        if mass < inf:
            add(injected_energy, 0, -_energy(flights, i, mass, space))
            velocity = flights[i].velocity
            px, py = px - mass * velocity[0], py - mass * velocity[1]
            pz -= mass * velocity[last]
            _kick(flights, i, width / sqrt(mass), key, number, space)
            px, py = px + mass * velocity[0], py + mass * velocity[1]
            pz += mass * velocity[last]
            total += mass
    mean = px / total, py / total, pz / total
    for i in range(len(flights)):
        mass = mass_of(i, model.masses, model.law)
        if mass < inf:
            for k in range(len(space.lengths)):
                flights[i].velocity[k] -= mean[k]
            add(injected_energy, 0, _energy(flights, i, mass, space))


# Observers of events: the record of events, and the detection of a collapse.


class Record(NamedTuple):
    """Record of events with space for M of them."""

    filled: np.ndarray
    time: np.ndarray
    particles: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray
    spins: np.ndarray


class CollapseWatch(NamedTuple):
    """Numbers of contacts of each particle, which reveal a collapse."""

    since: np.ndarray
    contacts: np.ndarray
    interval: float
    most: int


class Monitors(NamedTuple):
    """Record of events and detection of a collapse; each may be None."""

    record: Record | None
    collapse: CollapseWatch | None


@inner_helper
def is_full(record):
    """Return True if the record has no space for another event."""
    if record is None:
        return False
    return record.filled[0] == len(record.time)


@inner_helper
def record_spins(record, n, i, j, law):
    """Record the spins after event number n."""
    if law is not None:
        for k in range(3):
            record.spins[n, 0, k] = law.spins[i, k]
            record.spins[n, 1, k] = law.spins[j, k] if j >= 0 else np.nan


@inner_helper
def record_event(flights, i, j, time, model, record):
    """Record an event; j is the partner, or -1 - face for a wall."""
    if record is not None:
        n = record.filled[0]
        record.time[n] = time
        record.particles[n, 0] = i
        record.particles[n, 1] = j
        for k in range(len(model.space.lengths)):
            record.positions[n, 0, k] = flights[i].position[k]
            record.velocities[n, 0, k] = flights[i].velocity[k]
            record.positions[n, 1, k] = flights[j].position[k] if j >= 0 else np.nan
            record.velocities[n, 1, k] = flights[j].velocity[k] if j >= 0 else np.nan
        record_spins(record, n, i, j, model.law)
        record.filled[0] = n + 1


@inner_kernel
def has_collapsed(collapse, i, time):
    """Count a contact of a particle; return True for too many contacts within the interval."""
    if time - collapse.since[i] > collapse.interval:
        collapse.since[i] = time
        collapse.contacts[i] = 0
    collapse.contacts[i] += 1
    return collapse.contacts[i] > collapse.most


@inner_helper
def collapse_detected(i, j, time, faces, collapse):
    """Return True if an event exceeds the allowed number of contacts of its particles. The event is a contact
    of i and j, or of i with an interior wall. Hits of the container's `faces` do not count.
    """
    if collapse is None:
        return False
    if j >= 0 or j < -faces:
        return has_collapsed(collapse, i, time) or (j >= 0 and has_collapsed(collapse, j, time))
    return False
