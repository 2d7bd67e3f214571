"""Loop of the event-driven engine: process the next event, and predict events of its particles.

No bit of the result depends on the search for events:

- The contact time of a pair is always computed from the later of the two clocks, never from the present time.
- Crossing into another box changes the boxes to be searched, but not the flight.
- Crossing a periodic face is an event: the particle is advanced to the face and moved to the opposite face.

Events are ordered by time. Among simultaneous events, faces come first, in the order of particles, then pairs
in the order of the lower and the higher index.
"""

from math import inf

from numpy import int64

from gaspart.kernels.compile.policy import inner_helper, kernel
from gaspart.kernels.event.all_pairs import first_of_all
from gaspart.kernels.event.boxes import move, withdraw
from gaspart.kernels.event.entry import admit_before, next_attempt
from gaspart.kernels.event.impulses import note_velocity, speed_on_arrival, tally_impulse, tally_pairs
from gaspart.kernels.event.jams import wake_island
from gaspart.kernels.event.neighbour_lists import is_room_lacking, renew
from gaspart.kernels.event.pair_contact import collapse_detected, collide, is_full, record_event
from gaspart.kernels.event.prediction import (
    NOT_CROSSED,
    predict_after,
    predict_after_piston,
    predict_island,
    without_contacts,
)
from gaspart.kernels.event.prefetch import CACHED, CACHED_LISTS, crossing_of, prefetch, prefetch_lists
from gaspart.kernels.event.queue import count_event, is_outdated, soonest, time_of
from gaspart.kernels.event.sheared import follow
from gaspart.kernels.event.stress import end_flight
from gaspart.kernels.model import BOX_FACES, CROSSINGS, NONE, OUTDATED, WALLS, WELL_EDGES, Model
from gaspart.kernels.obstacles.face import meet_face
from gaspart.kernels.obstacles.interior_wall import meet_wall
from gaspart.kernels.obstacles.thermal import meet_edge, part_if_held

# Reasons why a run ended: the time, the number of events, a full record, a collapse, a full neighbour list,
# the number of crossings, or more particles than numbers.
STOP, EVENTS, FULL, COLLAPSE, NO_ROOM, CROSSED, CROWDED = range(7)


@inner_helper
def without_obstacles(model):
    """Return the model without obstacles, so that functions of contacts are compiled once."""
    return Model(model.space, model.masses, model.gravity, model.law, None, None, None, model.shear, None)


@inner_helper
def meet_obstacle(particles, i, face, time, model, tally):
    """Process the hit of a particle at a face, a well's edge, or an interior wall. Returns -1 minus the
    number of the face or wall, and True if this is an event of the model. It is not an event of the model at
    a periodic face, or if the particle leaves a wall along which it has slid.
    """
    bare = without_obstacles(model)
    before = speed_on_arrival(particles.flights, i, time, bare, model.gravity, tally.impulses)
    met, happens = _meet(particles, i, face, time, bare, model, tally)
    tally_impulse(particles.flights, i, before, bare, tally.impulses)
    return met, happens


@inner_helper
def _meet(particles, i, face, time, bare, model, tally):
    """Process a hit as in `meet_obstacle`, without the tally of the impulse."""
    if face >= WALLS:
        wall = meet_wall(particles.flights, i, face, time, bare, tally, model.walls)
        return -1 - wall, wall != NONE
    if face >= WELL_EDGES:
        return -1 - meet_edge(particles.flights, i, face, time, bare, tally, model.faces), True
    end_flight(particles.flights, i, time, bare, tally.stress, model.shear)
    return -1 - face, meet_face(particles, i, face, time, bare, tally, model.faces)


@inner_helper
def meet_particle(particles, i, j, time, queue, boxes, model, tally):
    """Process the collision of two particles."""
    bare = without_obstacles(model)
    note_velocity(particles.flights, i, tally.pair_impulses)
    collide(particles.flights, i, j, time, bare, tally)
    tally_pairs(particles, i, j, queue, boxes, bare, tally, tally.pair_impulses)


@inner_helper
def wake(particles, pair, queue, boxes, model, tally, event, law):
    """Free the islands of two particles (2,) that have collided, unless a jam fixes them. `event`: time and
    number of the event.
    """
    if law is not None:
        _wake(particles, pair, queue, boxes, model, tally, event, law.duration)


@inner_helper
def _wake(particles, pair, queue, boxes, model, tally, event, duration):
    if duration is not None:
        for particle in pair:
            number = duration.island[particle]
            if number != NONE and model.law.inverse_mass[particle] > 0.0:
                wake_island(particles.flights, number, event[0], boxes, model, model.gravity, model.law)
                free = without_contacts(model)
                predict_island(particles, number, queue, boxes, free, tally, event, duration.island)


@inner_helper
def leave_box(particles, i, face, time, boxes, space, tally, lists):
    """Move a particle into the next box, or renew its list; return the step (3,), 0 without one."""
    if lists is not None:
        renew(particles.flights, i, time, lists, space, tally)
        return NOT_CROSSED
    axis, step = face % BOX_FACES // 2, 1 if face % 2 else -1
    move(particles.predictions, boxes, i, axis, particles.predictions[i].box[axis] + step)
    tally.counts[CROSSINGS] += 1
    return crossing_of(face)


@inner_helper
def enter_opposite_box(particles, i, face, time, boxes, model, tally, lists):
    """Update the box or neighbour list of a particle that has crossed a periodic face."""
    if lists is not None:
        renew(particles.flights, i, time, lists, model.space, tally)
    else:
        axis, upper = face // 2, face % 2
        move(particles.predictions, boxes, i, axis, 0 if upper else boxes.per_side[axis] - 1)
        follow(particles, i, axis, boxes, model.shear)


@inner_helper
def empty_place(particles, i, boxes, faces):
    """Remove a particle that has left through an open face from its box."""
    if faces is not None:
        withdraw(particles.predictions, boxes, i, faces.open)


@inner_helper
def process(particles, i, time, queue, boxes, model, tally):
    """Process the next event of a particle. Returns two values. The first are its two particles, or a
    particle and -1 minus the number of a face. The second is True for an event of the model, and False for
    crossings of boxes or periodic faces and for outdated contacts.
    """
    predictions = particles.predictions
    face = int64(predictions[i].face)
    partner = int64(predictions[i].partner)
    number = count_event(queue)
    happens = changes = True
    first, second, crossed = i, NONE, NOT_CROSSED
    if predictions[i].face_time <= predictions[i].contact_time:
        if BOX_FACES <= face < WELL_EDGES:
            happens = changes = False
            crossed = leave_box(particles, i, face, time, boxes, model.space, tally, boxes.lists)
        else:
            partner, happens = meet_obstacle(particles, i, face, time, model, tally)
            empty_place(particles, i, boxes, model.faces)
            if not happens and face < BOX_FACES:
                enter_opposite_box(particles, i, face, time, boxes, model, tally, boxes.lists)
    elif is_outdated(predictions, i):
        happens = changes = False
        tally.counts[OUTDATED] += 1
    else:
        i, partner = min(i, partner), max(i, partner)
        first, second = i, partner
        meet_particle(particles, i, partner, time, queue, boxes, model, tally)
        part_if_held(particles.flights, i, partner, without_obstacles(model), model.faces)
        wake(particles, (i, partner), queue, boxes, model, tally, (time, number), model.law)
    event, free = (time, number, changes), without_contacts(model)
    predict_after(particles, (first, second), queue, boxes, free, tally, event, crossed)
    predict_after_piston(particles, partner, time, queue, boxes, free, model.faces, model.walls)
    return i, partner, happens


@inner_helper
def process_first(particles, event, boxes, model, tally):
    """Process the earliest of all events, found by the search of all pairs. `event`: time, particle, partner
    and face. The result has the form of the result of `process`.
    """
    time, i, partner, face = event
    if partner < 0:
        partner, happens = meet_obstacle(particles, i, face, time, model, tally)
        return i, partner, happens
    meet_particle(particles, i, partner, time, None, boxes, model, tally)
    part_if_held(particles.flights, i, partner, without_obstacles(model), model.faces)
    wake(particles, (i, partner), None, boxes, model, tally, (time, NOT_CROSSED[0]), model.law)
    return i, partner, True


@inner_helper
def fetch_ahead(particles, queue, boxes, next_bucket, lists):
    """Prefetch data beyond the processor's inner caches; return the next bucket to prefetch for."""
    if lists is not None:
        if len(particles.flights) > CACHED_LISTS:
            return prefetch_lists(particles, queue, lists, next_bucket)
    elif len(particles.flights) > CACHED:
        return prefetch(particles, queue, boxes, next_bucket)
    return next_bucket


@kernel
def run(particles, queue, boxes, model, tally, monitors, limits, all_pairs):
    """Process events up to a time or a number of events. Returns (reason, number of events, number of
    crossings and outdated contacts, time of the last event or crossing). `limits`: (3,), time, maximum number
    of events (collisions, wall hits, attempts to enter), and maximum number of crossings and outdated
    contacts. `all_pairs`: () for the search of all pairs before every event, without a queue; otherwise None.
    numba omits only code that depends on an argument of type None, so both arguments are needed.
    """
    stop, most, most_crossed = limits
    done = crossed = 0
    last = -inf
    next_bucket = int64(-1)
    time, i, partner, face, happens = inf, int64(NONE), int64(NONE), int64(NONE), True
    while done < most:
        if is_full(monitors.record):
            return FULL, done, crossed, last
        if all_pairs is not None:
            time, i, partner, face = first_of_all(particles, boxes, model, tally)
        if queue is not None:
            i = soonest(queue, particles.predictions)
            if i >= 0:
                next_bucket = fetch_ahead(particles, queue, boxes, next_bucket, boxes.lists)
            time = time_of(particles.predictions, i) if i >= 0 else inf
        if next_attempt(model.reservoirs) < time:
            ends = time, stop, most - done
            tried, when, crowded = admit_before(particles, queue, boxes, model, tally, ends, model.reservoirs)
            if crowded:
                return CROWDED, done + tried, crossed, max(last, when)
            if tried > 0:
                done, last = done + tried, when
                continue
        if i < 0 or not time <= stop:
            return STOP, done, crossed, last
        if queue is not None:
            i, partner, happens = process(particles, i, time, queue, boxes, model, tally)
        if all_pairs is not None:
            i, partner, happens = process_first(particles, (time, i, partner, face), boxes, model, tally)
        last = time
        if not happens:
            crossed += 1
            if is_room_lacking(boxes.lists):
                return NO_ROOM, done, crossed, last
            if crossed >= most_crossed:
                return CROSSED, done, crossed, last
            continue
        done += 1
        record_event(particles.flights, i, partner, time, without_obstacles(model), monitors.record)
        if collapse_detected(i, partner, time, 2 * len(model.space.lengths), monitors.collapse):
            return COLLAPSE, done, crossed, last
    return EVENTS, done, crossed, last
