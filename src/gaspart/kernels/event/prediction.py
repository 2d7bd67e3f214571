"""What a particle does next: its contact, the face it comes to, the renewal of its neighbour list; predicted
anew after each event of the particle, and kept in the queue.
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

# Particles too large for the boxes: how they are searched for, and search.
#
# A small particle tests the oversized ones that are near its box; an oversized one tests the particles in
# all boxes that are near its own, and all other oversized ones. Whether two boxes are near, for an
# oversized particle, follows from their numbers alone, so it is the same seen from either; and no contact
# can occur between particles whose boxes are not. A particle that passes into another box searches what
# has become near.


_SLACK = 1e-9  # by which neighbourhoods are drawn wider, so that rounding hides no contact


@inner_helper
def reach_square(flights, i, oversized):
    """Square of the greatest distance between the centre of an oversized particle and of a small one that
    touches it."""
    reach = (flights[i].radius + oversized.largest_radius) * (1.0 + _SLACK)
    return reach * reach


@inner_helper
def gap_square(steps, width):
    """Square of the gap along an axis between boxes that are so many steps apart."""
    gap = max(abs(steps) - 1, 0) * width
    return gap * gap


@inner_helper
def near(x, y, z, widths, square):
    """Whether boxes these steps apart hold points nearer than the root of `square`."""
    return gap_square(x, widths[0]) + gap_square(y, widths[1]) + gap_square(z, widths[2]) < square


@inner_helper
def newly_near(x, y, z, crossed, widths, square):
    """The same, but for boxes that were near before a step `crossed` (3,) into another box, if there was
    one."""
    all_new = crossed[0] == 0 and crossed[1] == 0 and crossed[2] == 0
    return near(x, y, z, widths, square) and (
        all_new or not near(x + crossed[0], y + crossed[1], z + crossed[2], widths, square)
    )


@inner_kernel
def images_along(axis, space):
    """How many images of the container to search on either side along an axis."""
    return 1 if axis < len(space.lengths) and space.periodic[axis] else 0


@inner_kernel
def test_pair(particles, i, other, image, space, tally, gravity):
    """Predict the contact with another particle in an image (3,) of the container, if it is the earliest so
    far."""
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
    """Search for an earlier contact of a small particle with the oversized ones near its box; if it has
    crossed into that box by `crossed` (3,), with those only that were not near before."""
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
    """The first and last coordinate of boxes along an axis that may be near; on a periodic axis they go on
    beyond the container."""
    steps = int(sqrt(square) / width) + 2
    if periodic:
        return here - min(steps, n), here + min(steps, n)
    return max(here - steps, 0), min(here + steps, n - 1)


@inner_helper
def image_of(coordinate, n):
    """In which image of the container a box coordinate lies."""
    return 1 if coordinate >= n else (-1 if coordinate < 0 else 0)


@inner_kernel
def find_around(particles, i, boxes, space, tally, crossed, gravity, oversized):
    """Search for an earlier contact of an oversized particle with all the particles in boxes near its own; if
    it has crossed into that box by `crossed` (3,), in those only that were not near before."""
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
    """Search for an earlier contact of an oversized particle with the other oversized ones."""
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
    """What `find_contact` leaves to be searched where there are oversized particles; `crossed` (3,): the step
    into the next box that the particle has just made, or none."""
    if oversized is not None:
        if particles.flights[i].radius <= oversized.largest_radius:
            find_oversized(particles, i, boxes, space, tally, crossed, gravity, oversized)
        else:
            find_around(particles, i, boxes, space, tally, crossed, gravity, oversized)
            find_other_oversized(particles, i, space, tally, gravity, oversized)


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
