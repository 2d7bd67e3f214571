"""Which bodies are in which box: a linked list a box.

Bodies have unsigned numbers, and N, which is nobody, ends every list and follows itself, so that lists can be
read beyond their ends.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from gaspart.boxes import Boxes
from gaspart.engines.layout import Partition
from gaspart.engines.search import ROOM
from gaspart.kernel import helper, kernel


def empty_partition(boxes: Boxes, lengths: tuple[float, ...], count: int) -> Partition:
    """The boxes of a container (d,) for `count` bodies, with nobody in them."""
    laps = np.array(list(product((-1, 0, 1), repeat=3)))[:, ::-1]
    return Partition(
        boxes.per_side, boxes.widths, boxes.strides, boxes.neighbour, boxes.shift,
        head=np.full(boxes.count, count, dtype=np.uint32),
        following=np.full(count + 1, count, dtype=np.uint32),
        offset=laps[:, : len(lengths)] * np.array(lengths),
        near=np.zeros(ROOM, dtype=np.uint64),
    )  # fmt: skip


@helper
def box_of(plans, partition, body):
    """The linear index of the body's box."""
    at = plans[body].at
    return at[0] * partition.strides[0] + at[1] * partition.strides[1] + at[2] * partition.strides[2]


@helper
def put(plans, partition, body):
    """Put a body at the head of its box's list."""
    box = np.uint64(box_of(plans, partition, body))
    plans[body].box = box
    partition.following[np.uint64(body)] = partition.head[box]
    partition.head[box] = body


@kernel
def take(plans, partition, body):
    """Take a body out of its box's list."""
    box = np.uint64(plans[body].box)
    after = partition.following[np.uint64(body)]
    other = partition.head[box]
    if other == body:
        partition.head[box] = after
        return
    while partition.following[other] != body:
        other = partition.following[other]
    partition.following[other] = after


@kernel
def sort_in(plans, partition):
    """Put all bodies into the lists of their boxes."""
    partition.head[:] = len(plans)
    for body in range(len(plans)):
        put(plans, partition, body)
