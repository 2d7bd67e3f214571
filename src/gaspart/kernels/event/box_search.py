"""The earliest contact of a particle: the search of the boxes about it.

First all particles there are listed, then the times of all their contacts are computed, eight at once
(`simd`): with hardly a branch, so that the processor has little to predict. Indices are unsigned, since for
signed ones numba checks at every access whether it counts from the end.
"""

from math import inf

from numpy import int64, uint64

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.event.box_lists import CANDIDATES
from gaspart.kernels.event.candidates import NUMBER, X, Y, Z, image_bits, offset_of
from gaspart.kernels.event.simd import PLACES, earliest, list_box
from gaspart.kernels.model import BOX_VISITS, PAIR_TESTS
from gaspart.kernels.physics.flight import time_of_contact
from gaspart.kernels.simd import WIDTH, lowest

_WIDTH, _PLACES, _FULL = uint64(WIDTH), uint64(PLACES), uint64(CANDIDATES - 3 * PLACES - 1)


@inner_helper
def test_candidates(particles, i, count, boxes, space, tally, gravity):
    """Predict the contact with one of the first `count` candidates, if it is earlier than that predicted."""
    flights, predictions, candidates = particles.flights, particles.predictions, boxes.candidates
    tally.counts[PAIR_TESTS] += int64(count)
    for n in range(_WIDTH):
        candidates[count + n] = i  # no particle meets itself
    before, partner = predictions[i].contact_time, int64(predictions[i].partner)
    best, found, unknown = earliest(flights, i, (uint64(0), count), (before, partner), boxes, space, gravity)
    if gravity is not None:
        while unknown:
            candidate = candidates[lowest(unknown)]
            unknown &= unknown - uint64(1)
            other = candidate & NUMBER
            time = time_of_contact(flights, i, other, offset_of(candidate, space), space, gravity)
            if time < best or (time == best and time < inf and int64(other) < found):
                best = time
                found = int64(other)
    if best < before or found != partner:
        predictions[i].contact_time = best
        predictions[i].partner = found


@inner_kernel
def list_others(particles, i, count, row, boxes, space, tally, gravity):
    """List the particles of a row of boxes that have no place, and test the candidates whenever there may be
    no room for another row's. row: its first box, its image, the first step and end along it. Returns how
    many candidates are left."""
    first, image_yz, low, end = row
    x = uint64(particles.predictions[i].box[0])
    for step in range(low, end):
        beside = boxes.neighbour[0, x, step]
        if beside < 0:
            continue
        box = uint64(first + beside)
        image = image_yz | image_bits(boxes.shift[0, x, step], X)
        other = uint64(boxes.head[box])
        for _ in range(_PLACES, uint64(boxes.filled[box])):
            boxes.candidates[count] = other | image
            count += uint64(1)
            if count > _FULL:
                test_candidates(particles, i, count, boxes, space, tally, gravity)
                count = uint64(0)
            other = uint64(boxes.following[other])
    if count > _FULL:
        test_candidates(particles, i, count, boxes, space, tally, gravity)
        count = uint64(0)
    return count


@inner_helper
def span(boxes, axis, at, crossed, dimension):
    """Which boxes to search along an axis, about that at a coordinate: first step and end (0..3), how many
    there are, and how many of them are that box itself. Discs have one box along the third axis."""
    if axis >= dimension:
        return uint64(1), uint64(2), 1, 1
    low, end = uint64(0), uint64(3)
    if crossed:
        low = uint64(1 + crossed)
        end = low + uint64(1)
    visits = itself = 0
    own = boxes.neighbour[axis, at, 1]
    for step in range(low, end):
        beside = boxes.neighbour[axis, at, step]
        visits += int64(beside >= 0)
        itself += int64(beside == own)
    return low, end, visits, itself


@inner_helper
def list_places(boxes, count, box, image, most):
    """List the particles that have a place in a box, after `count` others: how many there are then, and how
    many particles the fullest box so far holds, `most`."""
    list_box(boxes.candidates, count, boxes.places, box, image)
    filled = uint64(boxes.filled[box])
    return count + min(filled, _PLACES), max(most, filled)


@inner_helper
def find_contact(particles, number, boxes, space, tally, crossed, gravity):
    """Search for an earlier contact of a particle in the boxes about its own; if it has just `crossed` (3,)
    into this one, in those only that were not neighbours before.

    All places of a box are listed whether they are filled or not, which costs less than to test it.
    """
    i = uint64(number)
    at = particles.predictions[i].box
    ax, ay, az = uint64(at[0]), uint64(at[1]), uint64(at[2])
    neighbour, shift = boxes.neighbour, boxes.shift
    low_x, end_x, visits_x, itself_x = span(boxes, 0, ax, crossed[0], len(space.lengths))
    low_y, end_y, visits_y, itself_y = span(boxes, 1, ay, crossed[1], len(space.lengths))
    low_z, end_z, visits_z, itself_z = span(boxes, 2, az, crossed[2], len(space.lengths))
    tally.counts[BOX_VISITS] += visits_x * visits_y * visits_z
    tally.counts[PAIR_TESTS] -= itself_x * itself_y * itself_z
    within = crossed[0] == 0 and 0 < at[0] < boxes.per_side[0] - 1  # a row's three lie side by side
    count = uint64(0)
    for dz in range(low_z, end_z):
        beside_z = neighbour[2, az, dz]
        if beside_z < 0:
            continue
        image_z = image_bits(shift[2, az, dz], Z)
        for dy in range(low_y, end_y):
            beside_y = neighbour[1, ay, dy]
            if beside_y < 0:
                continue
            row = beside_y + beside_z
            image = image_z | image_bits(shift[1, ay, dy], Y)
            most = uint64(0)
            if within:
                first = uint64(row + at[0] - 1)
                for box in range(first, first + uint64(3)):
                    count, most = list_places(boxes, count, box, image, most)
            else:
                for dx in range(low_x, end_x):
                    beside_x = neighbour[0, ax, dx]
                    if beside_x >= 0:
                        box, image_x = uint64(row + beside_x), image | image_bits(shift[0, ax, dx], X)
                        count, most = list_places(boxes, count, box, image_x, most)
            if most > _PLACES or count > _FULL:
                line = row, image, low_x, end_x
                count = list_others(particles, i, count, line, boxes, space, tally, gravity)
    test_candidates(particles, i, count, boxes, space, tally, gravity)
