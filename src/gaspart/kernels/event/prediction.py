"""Prediction of the next events of a particle: contact, face, and renewal of its neighbour list.

After each event of a particle its events are predicted again and stored in the queue.
"""

from __future__ import annotations

from math import inf, sqrt

from numpy import int64

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.event.boxes import find_contact, member, sort_in, withdraw
from gaspart.kernels.event.neighbour_lists import is_renewed_first, next_renewal, search_list
from gaspart.kernels.event.queue import EVENT_COUNT, bucket_of, fill, reschedule
from gaspart.kernels.event.sheared import search_sheared
from gaspart.kernels.model import BOX_VISITS, NONE, PAIR_TESTS, WALLS, Model
from gaspart.kernels.obstacles.face import next_face
from gaspart.kernels.obstacles.interior_wall import find_wall
from gaspart.kernels.obstacles.moving import next_moving, next_piston
from gaspart.kernels.physics.flight import mark_resting, time_of_contact
from gaspart.kernels.prefetch import fetch

# Search for particles that are too large for the boxes (oversized particles).
#
# A small particle tests the oversized particles near its box. An oversized particle tests the particles in
# all boxes near its own box, and all other oversized particles. Two boxes are near if their numbers satisfy a
# symmetric criterion, so both particles of a pair find the same result. Particles whose boxes are not near
# cannot touch. A particle that passes into another box searches the boxes that have become near.


_SLACK = 1e-9  # relative extension of neighbourhoods, so that rounding does not hide a contact


@inner_helper
def reach_square(flights, i, oversized):
    """Return the squared contact distance of an oversized particle and the largest small particle."""
    reach = (flights[i].radius + oversized.largest_radius) * (1.0 + _SLACK)
    return reach * reach


@inner_helper
def gap_square(steps, width):
    """Return the squared gap along an axis between boxes that are a number of steps apart."""
    gap = max(abs(steps) - 1, 0) * width
    return gap * gap


@inner_helper
def near(x, y, z, widths, square):
    """Return True if boxes separated by these steps contain points closer than the root of `square`."""
    return gap_square(x, widths[0]) + gap_square(y, widths[1]) + gap_square(z, widths[2]) < square


@inner_helper
def newly_near(x, y, z, crossed, widths, square):
    """Return True if boxes are near now but were not before a step `crossed` (3,). Without a step, all near
    boxes count. The step leads into another box.
    """
    all_new = crossed[0] == 0 and crossed[1] == 0 and crossed[2] == 0
    return near(x, y, z, widths, square) and (
        all_new or not near(x + crossed[0], y + crossed[1], z + crossed[2], widths, square)
    )


@inner_kernel
def images_along(axis, space):
    """Return the number of images of the container to search on either side along an axis."""
    return 1 if axis < len(space.lengths) and space.periodic[axis] else 0


@inner_kernel
def test_pair(particles, i, other, image, space, tally, gravity):
    """Predict the contact with an image of another particle, if it is the earliest so far. `image`: (3,),
    image of the container.
    """
    d = len(space.lengths)
    predictions = particles.predictions
    offset = image[0] * space.lengths[0], image[1] * space.lengths[1], image[2] * space.lengths[d - 1]
    tally.counts[PAIR_TESTS] += 1
    time = time_of_contact(particles.flights, i, other, offset, space, gravity)
    before = predictions[i].contact_time
    if time < before or (time == before and time < inf and other < predictions[i].partner):
        predictions[i].contact_time = time
        predictions[i].partner = other


@inner_kernel
def find_oversized(particles, i, boxes, space, tally, crossed, gravity, oversized):
    """Search for an earlier contact of a small particle with oversized particles near its box. `crossed`:
    (3,), step into that box, or 0; after a step only particles are searched that were not near before.
    """
    here, n, widths = particles.predictions[i].box, boxes.per_side, boxes.widths
    images_x, images_y, images_z = images_along(0, space), images_along(1, space), images_along(2, space)
    for m in range(len(oversized.particles)):
        other = oversized.particles[m]
        there = particles.predictions[other].box
        square = reach_square(particles.flights, other, oversized)
        for c in range(-images_z, images_z + 1):
            z = there[2] + c * n[2] - here[2]
            for b in range(-images_y, images_y + 1):
                y = there[1] + b * n[1] - here[1]
                for a in range(-images_x, images_x + 1):
                    x = there[0] + a * n[0] - here[0]
                    if newly_near(x, y, z, crossed, widths, square):
                        test_pair(particles, i, other, (a, b, c), space, tally, gravity)


@inner_helper
def span(here, n, width, square, periodic):
    """Return first and last coordinate of boxes along an axis that may be near, beyond periodic faces too."""
    steps = int(sqrt(square) / width) + 2
    if periodic:
        return here - min(steps, n), here + min(steps, n)
    return max(here - steps, 0), min(here + steps, n - 1)


@inner_helper
def image_of(coordinate, n):
    """Return the image of the container that contains a box coordinate."""
    return 1 if coordinate >= n else (-1 if coordinate < 0 else 0)


@inner_kernel
def find_around(particles, i, boxes, space, tally, crossed, gravity, oversized):
    """Search for an earlier contact of an oversized particle with particles in near boxes. `crossed`: (3,),
    step into the present box, or 0; after a step only boxes that were not near before are searched.
    """
    here, n, widths = particles.predictions[i].box, boxes.per_side, boxes.widths
    square = reach_square(particles.flights, i, oversized)
    first_x, last_x = span(here[0], n[0], widths[0], square, images_along(0, space) > 0)
    first_y, last_y = span(here[1], n[1], widths[1], square, images_along(1, space) > 0)
    first_z, last_z = span(here[2], n[2], widths[2], square, images_along(2, space) > 0)
    for z in range(first_z, last_z + 1):
        c = image_of(z, n[2])
        plane = (z - c * n[2]) * boxes.strides[2]
        for y in range(first_y, last_y + 1):
            b = image_of(y, n[1])
            line = plane + (y - b * n[1]) * boxes.strides[1]
            for x in range(first_x, last_x + 1):
                if not newly_near(x - here[0], y - here[1], z - here[2], crossed, widths, square):
                    continue
                a = image_of(x, n[0])
                tally.counts[BOX_VISITS] += 1
                box = line + (x - a * n[0]) * boxes.strides[0]
                other = NONE
                for m in range(boxes.filled[box]):
                    other = int(member(boxes, box, m, other))
                    if other != i:
                        test_pair(particles, i, other, (a, b, c), space, tally, gravity)


@inner_kernel
def find_other_oversized(particles, i, space, tally, gravity, oversized):
    """Search for an earlier contact of an oversized particle with other oversized particles."""
    images_x, images_y, images_z = images_along(0, space), images_along(1, space), images_along(2, space)
    for m in range(len(oversized.particles)):
        other = oversized.particles[m]
        if other == i:
            continue
        for c in range(-images_z, images_z + 1):
            for b in range(-images_y, images_y + 1):
                for a in range(-images_x, images_x + 1):
                    test_pair(particles, i, other, (a, b, c), space, tally, gravity)


@inner_helper
def search_oversized(particles, i, boxes, space, tally, crossed, gravity, oversized):
    """Search for contacts with oversized particles, which `find_contact` does not find. `crossed`: (3,), step
    into the present box, or 0.
    """
    if oversized is not None:
        if particles.flights[i].radius <= oversized.largest_radius:
            find_oversized(particles, i, boxes, space, tally, crossed, gravity, oversized)
        else:
            find_around(particles, i, boxes, space, tally, crossed, gravity, oversized)
            find_other_oversized(particles, i, space, tally, gravity, oversized)


# No box was crossed, so all events are predicted. int64, because numba compiles a function again for each
# type of integer, and also for a constant.
NOT_CROSSED = (int64(0), int64(0), int64(0))


@inner_helper
def without_contacts(model):
    """Return the model without the parts for contacts, on which predictions do not depend."""
    obstacles = model.faces, model.walls, model.oversized
    return Model(model.space, None, model.gravity, None, *obstacles, model.shear, None)


@inner_helper
def predict_contact(particles, i, boxes, model, tally, crossed, lists):
    """Predict the next contact of a particle, if it is earlier than the present prediction."""
    if lists is not None:
        search_list(particles, i, lists, model.space, tally)
    else:
        find_contact(particles, i, boxes, model.space, tally, crossed, model.gravity)
        search_sheared(particles, i, boxes, model.space, tally, crossed, model.shear)
        search_oversized(particles, i, boxes, model.space, tally, crossed, model.gravity, model.oversized)


@inner_helper
def predict_face(particles, i, boxes, model, now):
    """Predict the next hit of a face or interior wall, or the renewal of the list."""
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
    """Predict the next contact of a particle. If the particle has just crossed into the next box, only new
    neighbours of this box are searched. `number`: number of the present event. `crossed`: (3,), step into the
    present box, or 0.
    """
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
    """Make the lists of the boxes, and the queue of all predictions. Neighbour lists must already exist. If
    `anew` is False, the predictions come from a checkpoint.
    """
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
    """Predict the next events of the particles of an event. `pair`: (2,), the particles; the second may be
    NONE. `event`: time, number, and True if the event changed flights.
    """
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
    """Predict face hits again for particles whose next face was or may be the piston."""
    predictions = particles.predictions
    for i in range(len(predictions)):
        was = predictions[i].face == piston.face
        if was or next_piston(particles, i, model.space, piston) <= predictions[i].face_time:
            predict_face(particles, i, boxes, model, time)
            reschedule(queue, predictions, i)


@inner_kernel
def predict_walls(particles, time, queue, boxes, model, moving):
    """Predict wall hits again for particles whose next wall was or may be the moving wall."""
    predictions = particles.predictions
    for i in range(len(predictions)):
        was = predictions[i].face == WALLS
        if was or next_moving(particles.flights, i, moving) <= predictions[i].face_time:
            predict_face(particles, i, boxes, model, time)
            reschedule(queue, predictions, i)


@inner_helper
def predict_after_piston(particles, partner, time, queue, boxes, model, faces, walls):
    """Predict hits of other particles again after a hit that changed a piston or moving wall. `partner`: -1
    minus the number of the face or wall that was hit.
    """
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
    """Predict the next events of the particles of an island, and dissolve the island."""
    time, count = event
    for i in range(len(island)):
        if island[i] == number:
            island[i] = NONE
            if queue is not None:
                particles.predictions[i].changed = count
                predict(particles, i, boxes, model, tally, time, count, NOT_CROSSED)
                reschedule(queue, particles.predictions, i)
