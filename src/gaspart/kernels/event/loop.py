"""The loop of the event-driven engine: take the next event, process it, predict the new events of its
particles.

So that no bit depends on how events are searched for:

- the time of a pair's contact is always computed from the later of the two clocks, never from "now";
- crossing into another box changes what is searched, never the flight;
- crossing a periodic face is an event: the particle is advanced to the face and moved to the opposite one.

Events come in the order of their time; simultaneous ones faces first, by particle, then pairs by the lower
and the higher index.
"""

from math import inf

from numpy import int64

from gaspart.kernels.compilation import inner_helper, inner_kernel, kernel
from gaspart.kernels.event.all_pairs import first_of_all
from gaspart.kernels.event.box_lists import move, sort_in
from gaspart.kernels.event.box_search import find_contact
from gaspart.kernels.event.islands import wake_island
from gaspart.kernels.event.monitors import collapse_detected, is_full, record_event
from gaspart.kernels.event.neighbour_lists import is_room_lacking, next_renewal, renew, search_list
from gaspart.kernels.event.oversized import search_oversized
from gaspart.kernels.event.pair_contact import collide
from gaspart.kernels.event.prefetch import CACHED, CACHED_LISTS, crossing_of, prefetch, prefetch_lists
from gaspart.kernels.event.queue import (
    EVENT_COUNT,
    bucket_of,
    count_event,
    fill,
    is_outdated,
    reschedule,
    soonest,
    time_of,
)
from gaspart.kernels.flight import mark_resting
from gaspart.kernels.model import BOX_FACES, CROSSINGS, NONE, OUTDATED, WALLS, WELL_EDGES
from gaspart.kernels.obstacles.face import meet_face, next_face
from gaspart.kernels.obstacles.interior_wall import find_wall, meet_wall
from gaspart.kernels.obstacles.piston import next_piston
from gaspart.kernels.obstacles.well import meet_edge
from gaspart.kernels.prefetch import fetch

# Why a run ended: the time, the number of events, the record, a collapse, a full neighbour list, the number
# of crossings.
STOP, EVENTS, FULL, COLLAPSE, NO_ROOM, CROSSED = range(6)
# No box was crossed: all is predicted anew. As int64, since numba compiles a function again for each type of
# integer, and for a constant as well.
_NEW = (int64(0), int64(0), int64(0))


@inner_helper
def predict_contact(particles, i, boxes, model, tally, crossed, lists):
    """Predict the next contact of a particle, if it is earlier than that predicted."""
    if lists is not None:
        search_list(particles, i, lists, model.space, tally)
    else:
        find_contact(particles, i, boxes, model.space, tally, crossed, model.gravity)
        search_oversized(particles, i, boxes, model.space, tally, crossed, model.gravity, model.oversized)


@inner_helper
def predict_face(particles, i, boxes, model, now):
    """Predict when a particle comes to a face or an interior wall, or its neighbour list must be renewed."""
    predictions, space, gravity = particles.predictions, model.space, model.gravity
    time, face = next_face(particles, i, boxes, space, now, gravity, model.faces, model.oversized)
    time, face = find_wall(particles, i, boxes, space, gravity, model.walls, time, face)
    time, face = next_renewal(particles.flights, i, boxes.lists, time, face)
    predictions[i].face_time = time
    predictions[i].face = face


@inner_helper
def predict(particles, i, boxes, model, tally, now, number, crossed):
    """Predict the next events of a particle anew; or, if it has just `crossed` (3,) into the next box, search
    the boxes that have become neighbours. number: of the present event."""
    predictions = particles.predictions
    if crossed[0] == 0 and crossed[1] == 0 and crossed[2] == 0:
        predictions[i].contact_time = inf
        predictions[i].partner = NONE
    time, partner = predictions[i].contact_time, predictions[i].partner
    predict_contact(particles, i, boxes, model, tally, crossed, boxes.lists)
    if predictions[i].contact_time != time or predictions[i].partner != partner:
        predictions[i].predicted = number
    predict_face(particles, i, boxes, model, now)


@inner_helper
def prepare(particles, boxes, model, lists):
    """Sort all particles into their boxes, unless there are neighbour lists, and mark which may rest."""
    if lists is None:
        sort_in(particles.predictions, boxes)
    for i in range(len(particles.flights)):
        mark_resting(particles.flights, i, model.space, model.gravity, boxes.resting)


@kernel
def predict_all(particles, queue, boxes, model, tally, now):
    """Sort all particles into their boxes, predict all events and fill the queue. Neighbour lists must have
    been made."""
    prepare(particles, boxes, model, boxes.lists)
    number = queue.cursor[EVENT_COUNT]
    for i in range(len(particles.flights)):
        predict(particles, i, boxes, model, tally, now, number, _NEW)
    fill(queue, particles.predictions, now)


@kernel
def restore(particles, queue, boxes, model, now):
    """Make the lists and the queue from the predictions of a checkpoint."""
    prepare(particles, boxes, model, boxes.lists)
    fill(queue, particles.predictions, now)


@inner_helper
def meet_obstacle(particles, i, face, time, model, tally):
    """Let a particle meet a face of the container, the edge of a well, or an interior wall. Returns -1 - the
    number of the face or wall, and False if that is no event of the model: at a periodic face, or where the
    particle leaves a wall along which it has slid."""
    if face >= WALLS:
        wall = meet_wall(particles.flights, i, face, time, model, tally, model.walls)
        return -1 - wall, wall != NONE
    if face >= WELL_EDGES:
        return -1 - meet_edge(particles.flights, i, face, time, model, tally, model.faces), True
    return -1 - face, meet_face(particles, i, face, time, model, tally)


@inner_helper
def predict_after(particles, pair, queue, boxes, model, tally, event, crossed):
    """Predict the next events of the particles of an event, `pair` (2,), the second of which may be none.
    event: its time, its number, and whether it changed flights."""
    predictions = particles.predictions
    time, number, changes = event
    first, second = pair
    mark_resting(particles.flights, first, model.space, model.gravity, boxes.resting)
    if second >= 0:
        mark_resting(particles.flights, second, model.space, model.gravity, boxes.resting)
    i = first
    while i >= 0:
        if changes:
            predictions[i].changed = number
        predict(particles, i, boxes, model, tally, time, number, crossed)
        fetch(queue.head, bucket_of(queue, predictions, i))
        i = second if i == first else NONE
    reschedule(queue, predictions, first)
    if second >= 0:
        reschedule(queue, predictions, second)


@inner_kernel
def predict_faces(particles, time, queue, boxes, model, piston):
    """Predict anew when particles come to a face, if that was the piston or may be now."""
    predictions = particles.predictions
    for i in range(len(predictions)):
        was = predictions[i].face == piston.face
        if was or next_piston(particles, i, model.space, piston) <= predictions[i].face_time:
            predict_face(particles, i, boxes, model, time)
            reschedule(queue, predictions, i)


@inner_helper
def predict_after_piston(particles, partner, time, queue, boxes, model, faces):
    """After a contact with a piston, whose motion it has changed, predict that of all others with it anew.
    partner: -1 - the number of the face met."""
    if faces is not None:
        _predict_after_piston(particles, partner, time, queue, boxes, model, faces.piston)


@inner_helper
def _predict_after_piston(particles, partner, time, queue, boxes, model, piston):
    if piston is not None:
        if -1 - partner == piston.face:
            predict_faces(particles, time, queue, boxes, model, piston)


@inner_kernel
def predict_island(particles, number, queue, boxes, model, tally, event, island):
    """Predict the next events of the particles of an island, which belong to none any more."""
    time, count = event
    for i in range(len(island)):
        if island[i] == number:
            island[i] = NONE
            if queue is not None:
                particles.predictions[i].changed = count
                predict(particles, i, boxes, model, tally, time, count, _NEW)
                reschedule(queue, particles.predictions, i)


@inner_helper
def wake(particles, pair, queue, boxes, model, tally, event, law):
    """Let gravity act again on the islands of two particles (2,) that have met. event: time and number."""
    if law is not None:
        _wake(particles, pair, queue, boxes, model, tally, event, law.duration)


@inner_helper
def _wake(particles, pair, queue, boxes, model, tally, event, duration):
    if duration is not None:
        for particle in pair:
            number = duration.island[particle]
            if number != NONE:
                wake_island(particles.flights, number, event[0], boxes, model, model.gravity, duration.island)
                predict_island(particles, number, queue, boxes, model, tally, event, duration.island)


@inner_helper
def leave_box(particles, i, face, time, boxes, model, tally, lists):
    """Let a particle cross into the next box, or renew its neighbour list. Returns the step (3,) into the
    box, if any."""
    if lists is not None:
        renew(particles.flights, i, time, lists, model.space, tally)
        return _NEW
    axis, step = face % BOX_FACES // 2, 1 if face % 2 else -1
    move(particles.predictions, boxes, i, axis, particles.predictions[i].box[axis] + step)
    tally.counts[CROSSINGS] += 1
    return crossing_of(face)


@inner_helper
def enter_opposite_box(particles, i, face, time, boxes, model, tally, lists):
    """Let a particle that has crossed a periodic face be found where it now is."""
    if lists is not None:
        renew(particles.flights, i, time, lists, model.space, tally)
    else:
        axis, upper = face // 2, face % 2
        move(particles.predictions, boxes, i, axis, 0 if upper else boxes.per_side[axis] - 1)


@inner_helper
def process(particles, i, time, queue, boxes, model, tally):
    """Process the next event of a particle. Returns the two particles it happens to, or one and -1 - a face,
    and whether it is an event of the model: not the crossing of a box or a periodic face, nor an outdated
    contact."""
    predictions = particles.predictions
    face = int64(predictions[i].face)
    partner = int64(predictions[i].partner)
    number = count_event(queue)
    happens = changes = True
    first, second, crossed = i, NONE, _NEW
    if predictions[i].face_time <= predictions[i].contact_time:
        if BOX_FACES <= face < WELL_EDGES:
            happens = changes = False
            crossed = leave_box(particles, i, face, time, boxes, model, tally, boxes.lists)
        else:
            partner, happens = meet_obstacle(particles, i, face, time, model, tally)
            if not happens and face < BOX_FACES:
                enter_opposite_box(particles, i, face, time, boxes, model, tally, boxes.lists)
    elif is_outdated(predictions, i):
        happens = changes = False
        tally.counts[OUTDATED] += 1
    else:
        i, partner = min(i, partner), max(i, partner)
        first, second = i, partner
        collide(particles.flights, i, partner, time, model, tally)
        wake(particles, (i, partner), queue, boxes, model, tally, (time, number), model.law)
    event = time, number, changes
    predict_after(particles, (first, second), queue, boxes, model, tally, event, crossed)
    predict_after_piston(particles, partner, time, queue, boxes, model, model.faces)
    return i, partner, happens


@inner_helper
def process_first(particles, event, boxes, model, tally):
    """Process the earliest of all events: its time, a particle, and a partner or a face. Returns as `process`
    does."""
    time, i, partner, face = event
    if partner < 0:
        partner, happens = meet_obstacle(particles, i, face, time, model, tally)
        return i, partner, happens
    collide(particles.flights, i, partner, time, model, tally)
    wake(particles, (i, partner), None, boxes, model, tally, (time, _NEW[0]), model.law)
    return i, partner, True


@inner_helper
def fetch_ahead(particles, queue, boxes, next_bucket, lists):
    """Prefetch what the next events will read, if the particles are too many for the nearer caches. Returns
    the next bucket to do so for."""
    if lists is not None:
        if len(particles.flights) > CACHED_LISTS:
            return prefetch_lists(particles, queue, lists, next_bucket)
    elif len(particles.flights) > CACHED:
        return prefetch(particles, queue, boxes, next_bucket)
    return next_bucket


@kernel
def run(particles, queue, boxes, model, tally, monitors, limits, all_pairs):
    """Process all events up to a time, at most so many of them (collisions and wall hits), and at most so
    many crossings and outdated contacts between them: `limits` (3,).

    all_pairs: () for the search of all pairs before every event, without a queue; otherwise None. numba
    leaves out only what depends on an argument that is None, so both arguments are needed. Returns (reason,
    number of events, number of crossings and outdated contacts, time of the last of all).
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
        record_event(particles.flights, i, partner, time, model, monitors.record)
        if collapse_detected(i, partner, time, 2 * len(model.space.lengths), monitors.collapse):
            return COLLAPSE, done, crossed, last
    return EVENTS, done, crossed, last
