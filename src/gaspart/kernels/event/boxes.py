"""Search of the earliest contact of a particle in the boxes around it.

First all particles in these boxes are listed, then the times of all their contacts are computed, eight at
once (`simd`). There are hardly any branches for the processor to predict. Indices are unsigned, because for
signed indices numba checks at every access if they count from the end.
"""

from __future__ import annotations

from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy import int64, uint64

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.event.simd import PLACES, earliest, list_box
from gaspart.kernels.memory import aligned_zeros
from gaspart.kernels.model import BOX_VISITS, IMAGE_BITS, NUMBER_BITS, PAIR_TESTS
from gaspart.kernels.physics.flight import time_of_contact
from gaspart.kernels.simd import WIDTH, lowest

# Particles of each box: the first few are in a fixed array per box, the others in a linked list.
#
# Nearly all boxes contain few particles, and the array is read at once for any number of particles.


CANDIDATES = 64  # maximum number of candidates collected before a test, one bit of a word each
_EMPTY = np.uint32(0xFFFFFFFF)


class BoxLists(NamedTuple):
    """Grid of boxes (see `state.boxes.Boxes`) and the particles in each box."""

    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray
    shift: np.ndarray
    filled: np.ndarray
    members: np.ndarray
    head: np.ndarray
    following: np.ndarray
    candidates: np.ndarray
    resting: np.ndarray
    lists: Any


def empty_lists(boxes, count, lists=None):
    """Return empty lists for `state.boxes.Boxes` and `count` particles."""
    return BoxLists(
        boxes.per_side, boxes.widths, boxes.strides, boxes.neighbour, boxes.shift,
        filled=np.zeros(boxes.count, dtype=np.uint32),
        members=aligned_zeros((boxes.count, PLACES), np.uint32),
        head=np.zeros(boxes.count, dtype=np.uint32),
        following=np.zeros(count, dtype=np.uint32),
        candidates=np.zeros(CANDIDATES + WIDTH, dtype=np.uint32),
        resting=np.zeros(count, dtype=np.uint8),
        lists=lists,
    )  # fmt: skip


@inner_helper
def box_of(predictions, boxes, i):
    """Return the linear index of a particle's box."""
    at = predictions[i].box
    return at[0] * boxes.strides[0] + at[1] * boxes.strides[1] + at[2] * boxes.strides[2]


@inner_helper
def member(boxes, box, n, other):
    """Return the n-th particle of a box with more than n; `other` is the preceding particle."""
    if n < PLACES:
        return boxes.members[box, n]
    return boxes.head[box] if n == PLACES else boxes.following[other]


@inner_helper
def insert(predictions, boxes, i):
    """Insert a particle into its box."""
    box = np.uint64(box_of(predictions, boxes, i))
    filled = boxes.filled[box]
    if filled < PLACES:
        boxes.members[box, filled] = i
    else:
        boxes.following[np.uint64(i)] = boxes.head[box]
        boxes.head[box] = i
    boxes.filled[box] = filled + np.uint32(1)


@inner_helper
def remove(predictions, boxes, i):
    """Remove a particle from its box; another particle of the box moves to its entry."""
    box = np.uint64(box_of(predictions, boxes, i))
    members, head, following = boxes.members, boxes.head, boxes.following
    last = np.uint64(boxes.filled[box]) - np.uint64(1)
    boxes.filled[box] = last
    slot = np.uint64(0)
    for n in range(np.uint64(1), np.uint64(PLACES)):
        slot += n * np.uint64(members[box, n] == i)
    if members[box, slot] == i:
        if last < PLACES:
            members[box, slot] = members[box, last]
            members[box, last] = _EMPTY
        else:
            members[box, slot] = head[box]
            head[box] = following[head[box]]
    elif head[box] == i:
        head[box] = following[head[box]]
    else:
        other = head[box]
        while following[other] != i:
            other = following[other]
        following[other] = following[np.uint64(i)]


@inner_helper
def withdraw(predictions, boxes, i, opened):
    """Remove a particle from its box if it has left the container through an open face."""
    if opened is not None:
        if not opened.present[i]:
            remove(predictions, boxes, i)


@inner_helper
def move(predictions, boxes, i, axis, to):
    """Move a particle to another box along an axis."""
    remove(predictions, boxes, i)
    predictions[i].box[axis] = to
    insert(predictions, boxes, i)


@inner_kernel
def sort_in(predictions, boxes):
    """Insert all particles into their boxes."""
    boxes.filled[:] = 0
    boxes.members[:] = _EMPTY
    for i in range(len(predictions)):
        insert(predictions, boxes, i)


# A candidate of a search is a word with the number of the particle and, in higher bits, its image along each
# axis.
#
# Words are unsigned, because numba would convert a mixture of signed and unsigned words to floating point.


NUMBER = uint64((1 << NUMBER_BITS) - 1)  # number of bits for the particle number in a candidate
X, Y, Z = (uint64(NUMBER_BITS + IMAGE_BITS * k) for k in range(3))  # first bit of the image along an axis
_IMAGE, _ONE = uint64((1 << IMAGE_BITS) - 1), uint64(1)
_LOW = (_ONE << X) | (_ONE << Y) | (_ONE << Z)


@inner_helper
def number_of(candidate):
    """Return the number of the particle."""
    return int64(candidate & NUMBER)


@inner_helper
def image_bits(image, first):
    """Return the bits that represent an image, -1, 0 or 1, along an axis. `first`: position of the first of
    these bits.
    """
    return (uint64(image) & _IMAGE) << first


@inner_helper
def image_of(candidate, first):
    """Return the image that the bits of a candidate represent, starting at bit `first`."""
    return (int64((candidate >> first) & _IMAGE) ^ 2) - 2


@inner_helper
def offset_of(candidate, space):
    """Return the displacement (3,) of the image of a candidate."""
    lengths = space.lengths
    return (
        image_of(candidate, X) * lengths[0],
        image_of(candidate, Y) * lengths[1],
        image_of(candidate, Z) * lengths[len(lengths) - 1],
    )


@inner_helper
def opposite(image):
    """Return the image bits of the first particle as seen from the second. `image`: image bits of the second
    particle as seen from the first.
    """
    return image ^ (image & _LOW) << _ONE


_WIDTH, _PLACES, _FULL = uint64(WIDTH), uint64(PLACES), uint64(CANDIDATES - 3 * PLACES - 1)


@inner_helper
def test_candidates(particles, i, count, boxes, space, tally, gravity):
    """Predict the contact with one of the first `count` candidates if it is the earliest."""
    flights, predictions, candidates = particles.flights, particles.predictions, boxes.candidates
    tally.counts[PAIR_TESTS] += int64(count)
    for n in range(_WIDTH):
        candidates[count + n] = i  # a particle has no contact with itself
    before, partner = predictions[i].contact_time, int64(predictions[i].partner)
    best, best_partner, unknown = earliest(
        flights, i, (uint64(0), count), (before, partner), boxes, space, gravity
    )
    if gravity is not None:
        while unknown:
            candidate = candidates[lowest(unknown)]
            unknown &= unknown - uint64(1)
            other = candidate & NUMBER
            time = time_of_contact(flights, i, other, offset_of(candidate, space), space, gravity)
            if time < best or (time == best and time < inf and int64(other) < best_partner):
                best = time
                best_partner = int64(other)
    if best < before or best_partner != partner:
        predictions[i].contact_time = best
        predictions[i].partner = best_partner


@inner_kernel
def list_others(particles, i, count, row, boxes, space, tally, gravity):
    """List the particles in the linked lists of a row of boxes. Returns the new number of candidates. If the
    particles of another row might not fit, the candidates are tested, and the list is emptied. `row`: first
    box of the row, its image, first step and end along the row.
    """
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
    """Return the boxes to be searched along an axis around a box. The result consists of the first step, the
    end (0..3), the number of these boxes, and the number of them that are the box itself. In two dimensions
    there is one box along the third axis.
    """
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
    """List the particles in the array of a box; return the new number of candidates. `count`: number of
    candidates before. `most`: largest number of particles in a box so far; its updated value is also
    returned.
    """
    list_box(boxes.candidates, count, boxes.members, box, image)
    filled = uint64(boxes.filled[box])
    return count + min(filled, _PLACES), max(most, filled)


@inner_helper
def find_contact(particles, number, boxes, space, tally, crossed, gravity):
    """Search for an earlier contact of a particle in the boxes around its box. If the particle has just
    crossed into this box, only boxes that were not neighbours before are searched. All entries of the array
    of a box are listed, even unused ones, which costs less than a test. `crossed`: (3,), direction of the
    crossing along each axis.
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
    within = crossed[0] == 0 and 0 < at[0] < boxes.per_side[0] - 1  # the boxes of a row are contiguous
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
