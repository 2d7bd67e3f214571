"""Which particles are in which box: the first few in places of its own, any others in a linked list.

Nearly all boxes hold a few particles only, and a search then reads each in one go, whatever their number.
"""

from typing import Any, NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.event.simd import PLACES
from gaspart.kernels.memory import aligned
from gaspart.kernels.simd import WIDTH

CANDIDATES = 64  # gathered by a search before they are tested: a bit of a word for each
_EMPTY = np.uint32(0xFFFFFFFF)


class BoxLists(NamedTuple):
    """The grid of boxes (see `state.boxes.Boxes`): per_side, widths, strides (3,), neighbour, shift. How many
    particles each box holds, filled (boxes,), the first of them, places (boxes, PLACES), and of the others
    the first, head (boxes,), and the next after each particle, following (N,). candidates (M,), room for
    those of a search; resting (N,), which particles gravity may not pull, see `flight.mark_resting`. lists:
    `NeighbourLists`, which are searched instead, or None."""

    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray
    shift: np.ndarray
    filled: np.ndarray
    places: np.ndarray
    head: np.ndarray
    following: np.ndarray
    candidates: np.ndarray
    resting: np.ndarray
    lists: Any


def empty_lists(boxes, count, lists=None):
    """The lists of these `state.boxes.Boxes` for `count` particles, with none in them."""
    return BoxLists(
        boxes.per_side, boxes.widths, boxes.strides, boxes.neighbour, boxes.shift,
        filled=np.zeros(boxes.count, dtype=np.uint32),
        places=aligned((boxes.count, PLACES), np.uint32),
        head=np.zeros(boxes.count, dtype=np.uint32),
        following=np.zeros(count, dtype=np.uint32),
        candidates=np.zeros(CANDIDATES + WIDTH, dtype=np.uint32),
        resting=np.zeros(count, dtype=np.uint8),
        lists=lists,
    )  # fmt: skip


@inner_helper
def box_of(predictions, boxes, i):
    """The linear index of a particle's box."""
    at = predictions[i].box
    return at[0] * boxes.strides[0] + at[1] * boxes.strides[1] + at[2] * boxes.strides[2]


@inner_helper
def member(boxes, box, n, other):
    """The n-th particle of a box that holds more; `other` is the one before it."""
    if n < PLACES:
        return boxes.places[box, n]
    return boxes.head[box] if n == PLACES else boxes.following[other]


@inner_helper
def insert(predictions, boxes, i):
    """Put a particle into its box."""
    box = np.uint64(box_of(predictions, boxes, i))
    filled = boxes.filled[box]
    if filled < PLACES:
        boxes.places[box, filled] = i
    else:
        boxes.following[np.uint64(i)] = boxes.head[box]
        boxes.head[box] = i
    boxes.filled[box] = filled + np.uint32(1)


@inner_helper
def remove(predictions, boxes, i):
    """Take a particle out of its box; another of the same box fills its place."""
    box = np.uint64(box_of(predictions, boxes, i))
    places, head, following = boxes.places, boxes.head, boxes.following
    last = np.uint64(boxes.filled[box]) - np.uint64(1)
    boxes.filled[box] = last
    place = np.uint64(0)
    for n in range(np.uint64(1), np.uint64(PLACES)):
        place += n * np.uint64(places[box, n] == i)
    if places[box, place] == i:
        if last < PLACES:
            places[box, place] = places[box, last]
            places[box, last] = _EMPTY
        else:
            places[box, place] = head[box]
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
    """Take a particle that is no longer in the container, where faces are open, out of its box."""
    if opened is not None:
        if not opened.present[i]:
            remove(predictions, boxes, i)


@inner_helper
def move(predictions, boxes, i, axis, to):
    """Take a particle to another box along an axis."""
    remove(predictions, boxes, i)
    predictions[i].box[axis] = to
    insert(predictions, boxes, i)


@inner_kernel
def sort_in(predictions, boxes):
    """Put all particles into their boxes."""
    boxes.filled[:] = 0
    boxes.places[:] = _EMPTY
    for i in range(len(predictions)):
        insert(predictions, boxes, i)
