"""What a particle does next: its contact, the face it comes to, the renewal of its neighbour list; predicted
anew after each event of the particle, and kept in the queue."""

from math import inf

from numpy import int64

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.event.box_lists import sort_in, withdraw
from gaspart.kernels.event.box_search import find_contact
from gaspart.kernels.event.neighbour_lists import is_renewed_first, next_renewal, search_list
from gaspart.kernels.event.oversized import search_oversized
from gaspart.kernels.event.queue import EVENT_COUNT, bucket_of, fill, reschedule
from gaspart.kernels.event.sheared_search import search_sheared
from gaspart.kernels.model import NONE, WALLS, Model
from gaspart.kernels.obstacles.face import next_face
from gaspart.kernels.obstacles.interior_wall import find_wall
from gaspart.kernels.obstacles.moving_wall import next_moving
from gaspart.kernels.obstacles.piston import next_piston
from gaspart.kernels.physics.flight import mark_resting
from gaspart.kernels.prefetch import fetch

# No box was crossed: all is predicted anew. As int64, since numba compiles a function again for each type of
# integer, and for a constant as well.
NOT_CROSSED = (int64(0), int64(0), int64(0))


@inner_helper
def without_contacts(model):
    """Return the model without what matters at contacts only: what predictions depend on."""
    obstacles = model.faces, model.walls, model.oversized
    return Model(model.space, None, model.gravity, None, *obstacles, model.shear, None)


@inner_helper
def predict_contact(particles, i, boxes, model, tally, crossed, lists):
    """Predict the next contact of a particle, if it is earlier than that predicted."""
    if lists is not None:
        search_list(particles, i, lists, model.space, tally)
    else:
        find_contact(particles, i, boxes, model.space, tally, crossed, model.gravity)
        search_sheared(particles, i, boxes, model.space, tally, crossed, model.shear)
        search_oversized(particles, i, boxes, model.space, tally, crossed, model.gravity, model.oversized)


@inner_helper
def predict_face(particles, i, boxes, model, now):
    """Predict when a particle comes to a face or an interior wall, or its neighbour list must be renewed."""
    predictions, space, gravity = particles.predictions, model.space, model.gravity
    time, face = next_renewal(particles.flights, i, boxes.lists)
    if not is_renewed_first(i, time, boxes.lists, space, model.faces):
        soon, code = next_face(particles, i, boxes, space, now, gravity, model.faces, model.oversized)
        soon, code = find_wall(particles, i, boxes, space, gravity, model.walls, soon, code)
        if soon <= time:
            time, face = soon, code
    predictions[i].face_time = time
    predictions[i].face = face


@inner_helper
def predict_meeting(particles, i, boxes, model, tally, number, crossed):
    """Predict the next contact of a particle anew; or, if it has just `crossed` (3,) into the next box,
    search the boxes that have become neighbours. number: of the present event."""
    predictions = particles.predictions
    if crossed[0] == 0 and crossed[1] == 0 and crossed[2] == 0:
        predictions[i].contact_time = inf
        predictions[i].partner = NONE
    time, partner = predictions[i].contact_time, predictions[i].partner
    predict_contact(particles, i, boxes, model, tally, crossed, boxes.lists)
    if predictions[i].contact_time != time or predictions[i].partner != partner:
        predictions[i].predicted = number


@inner_helper
def predict(particles, i, boxes, model, tally, now, number, crossed):
    """Predict the next events of a particle; see `predict_meeting`."""
    predict_meeting(particles, i, boxes, model, tally, number, crossed)
    predict_face(particles, i, boxes, model, now)


@inner_helper
def sort_all(predictions, boxes, faces, lists):
    """Sort all particles into their boxes, unless there are neighbour lists."""
    if lists is None:
        sort_in(predictions, boxes)
        if faces is not None:
            for i in range(len(predictions)):
                withdraw(predictions, boxes, i, faces.open)


@kernel
def begin(particles, queue, boxes, model, tally, now, anew):
    """Make the boxes' lists and the queue of all predictions, which are those of a checkpoint or made `anew`.
    Neighbour lists must have been made."""
    sort_all(particles.predictions, boxes, model.faces, boxes.lists)
    for i in range(len(particles.flights)):
        mark_resting(particles.flights, i, model.space, model.gravity, boxes.resting)
    if anew:
        number = queue.cursor[EVENT_COUNT]
        for i in range(len(particles.flights)):
            predict(particles, i, boxes, model, tally, now, number, NOT_CROSSED)
    fill(queue, particles.predictions, now)


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
        predict_meeting(particles, i, boxes, model, tally, number, crossed)
        i = second if i == first else NONE
    i = first
    while i >= 0:
        predict_face(particles, i, boxes, model, time)
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


@inner_kernel
def predict_walls(particles, time, queue, boxes, model, moving):
    """The same of the interior wall that moves."""
    predictions = particles.predictions
    for i in range(len(predictions)):
        was = predictions[i].face == WALLS
        if was or next_moving(particles.flights, i, moving) <= predictions[i].face_time:
            predict_face(particles, i, boxes, model, time)
            reschedule(queue, predictions, i)


@inner_helper
def predict_after_piston(particles, partner, time, queue, boxes, model, faces, walls):
    """After a contact with a piston or a wall that moves, whose motion it has changed, predict that of all
    others with it anew. partner: -1 - the number of the face or wall met."""
    if faces is not None:
        _predict_after_piston(particles, partner, time, queue, boxes, model, faces.piston)
    if walls is not None:
        _predict_after_wall(particles, partner, time, queue, boxes, model, walls.moving)


@inner_helper
def _predict_after_piston(particles, partner, time, queue, boxes, model, piston):
    if piston is not None:
        if -1 - partner == piston.face:
            predict_faces(particles, time, queue, boxes, model, piston)


@inner_helper
def _predict_after_wall(particles, partner, time, queue, boxes, model, moving):
    if moving is not None:
        if -1 - partner == 2 * len(model.space.lengths):
            predict_walls(particles, time, queue, boxes, model, moving)


@inner_kernel
def predict_island(particles, number, queue, boxes, model, tally, event, island):
    """Predict the next events of the particles of an island, which belong to none any more."""
    time, count = event
    for i in range(len(island)):
        if island[i] == number:
            island[i] = NONE
            if queue is not None:
                particles.predictions[i].changed = count
                predict(particles, i, boxes, model, tally, time, count, NOT_CROSSED)
                reschedule(queue, particles.predictions, i)
