"""Which bodies are in which box: the first few in places of its own, any others in a linked list.

Nearly all boxes hold a few bodies only, and a search then reads each in one go, whatever their number.
"""

import numpy as np

from gaspart.kernels.compilation import inner_helper, inner_kernel
from gaspart.kernels.event.box_search import MOST
from gaspart.kernels.event.model import PLACES, Partition
from gaspart.kernels.memory import aligned
from gaspart.kernels.simd import WIDTH

_NOBODY = np.uint32(0xFFFFFFFF)


def empty_partition(boxes, count):
    """The `Partition` of these `Boxes` for `count` bodies, with none in them."""
    return Partition(
        boxes.per_side, boxes.widths, boxes.strides, boxes.neighbour, boxes.shift,
        filled=np.zeros(boxes.count, dtype=np.uint32),
        places=aligned((boxes.count, PLACES), np.uint32),
        head=np.zeros(boxes.count, dtype=np.uint32),
        following=np.zeros(count, dtype=np.uint32),
        near=np.zeros(MOST + WIDTH, dtype=np.uint64),
        still=np.zeros(count, dtype=np.uint8),
    )  # fmt: skip


@inner_helper
def box_of(plans, partition, body):
    """The linear index of the body's box."""
    at = plans[body].at
    return at[0] * partition.strides[0] + at[1] * partition.strides[1] + at[2] * partition.strides[2]


@inner_helper
def member(partition, box, n, other):
    """The n-th body of a box that holds more; `other` is the one before it."""
    if n < PLACES:
        return partition.places[box, n]
    return partition.head[box] if n == PLACES else partition.following[other]


@inner_helper
def put(plans, partition, body):
    """Put a body into its box."""
    box = np.uint64(box_of(plans, partition, body))
    filled = partition.filled[box]
    if filled < PLACES:
        partition.places[box, filled] = body
    else:
        partition.following[np.uint64(body)] = partition.head[box]
        partition.head[box] = body
    partition.filled[box] = filled + np.uint32(1)


@inner_helper
def take(plans, partition, body):
    """Take a body out of its box; another of the same box fills its place."""
    box = np.uint64(box_of(plans, partition, body))
    places, head, following = partition.places, partition.head, partition.following
    last = np.uint64(partition.filled[box]) - np.uint64(1)
    partition.filled[box] = last
    place = np.uint64(0)
    for n in range(np.uint64(1), np.uint64(PLACES)):
        place += n * np.uint64(places[box, n] == body)
    if places[box, place] == body:
        if last < PLACES:
            places[box, place] = places[box, last]
            places[box, last] = _NOBODY
        else:
            places[box, place] = head[box]
            head[box] = following[head[box]]
    elif head[box] == body:
        head[box] = following[head[box]]
    else:
        other = head[box]
        while following[other] != body:
            other = following[other]
        following[other] = following[np.uint64(body)]


@inner_helper
def move(plans, partition, body, axis, to):
    """Take a body to another box along an axis."""
    take(plans, partition, body)
    plans[body].at[axis] = to
    put(plans, partition, body)


@inner_kernel
def sort_in(plans, partition):
    """Put all bodies into their boxes."""
    partition.filled[:] = 0
    partition.places[:] = _NOBODY
    for body in range(len(plans)):
        put(plans, partition, body)
