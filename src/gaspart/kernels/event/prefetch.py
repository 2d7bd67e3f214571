"""Fetching what the next events will read, while this one is worked on.

Bodies that meet lie anywhere in memory. If they are too many for the processor's own cache, an event waits
some ten times for what it reads, longer than it works. But the calendar knows what comes next: some buckets
ahead, a body's plans are fetched; some fewer ahead, who is in the boxes about it, then their rows, and the
same for its partner. Nothing is changed, and what was fetched for an event that does not come is merely not
used.
"""

from __future__ import annotations

from numpy import uint32, uint64

from gaspart.kernels.compilation import inner_helper
from gaspart.kernels.event.model import EDGES, INNER
from gaspart.kernels.event.queue import BUCKET
from gaspart.kernels.prefetch import fetch

CACHED = 1 << 15  # bodies up to which the nearer caches do well enough without
_STRIDE = 3  # buckets from one stage to the next: about as many events
_MISSED = 15  # buckets that are caught up with if the calendar has leapt over them
_FETCHED = 2  # places of a box whose bodies are fetched: few boxes hold more


@inner_helper
def steps(side):
    """First step and end (0..3) of the boxes to look into along an axis: all, or those on one side."""
    return (uint64(1 + side), uint64(2 + side)) if side else (uint64(0), uint64(3))


@inner_helper
def fetch_about(rows, partition, at, side, whom):
    """Fetch who is in the boxes about that at coordinates (3,), of an axis with a side (-1 or 1) in those on
    that side only; or, once that is near, fetch `whom`."""
    neighbour = partition.neighbour
    nobody = uint32(len(rows) - 1)
    ax, ay, az = uint64(at[0]), uint64(at[1]), uint64(at[2])
    low_x, end_x = steps(side[0])
    low_y, end_y = steps(side[1])
    low_z, end_z = steps(side[2])
    for dz in range(low_z, end_z):
        z = neighbour[2, az, dz]
        for dy in range(low_y, end_y):
            y = neighbour[1, ay, dy]
            if z < 0 or y < 0:
                continue
            first = uint64(max(y + z + neighbour[0, ax, low_x], 0))
            if whom:
                for dx in range(low_x, end_x):
                    box = uint64(max(y + z + neighbour[0, ax, dx], 0))
                    for n in range(uint64(_FETCHED)):
                        fetch(rows, min(partition.places[box, n], nobody))
            else:
                fetch(partition.places, first)
                fetch(partition.filled, first)
                last = uint64(max(y + z + neighbour[0, ax, end_x - uint64(1)], 0))
                fetch(partition.places, last)
                fetch(partition.filled, last)


@inner_helper
def searched(plans, body):
    """The box (3,) about which a body will look at its next event, and on which side only (3,), if any: what
    lies in its way if it crosses into the next box."""
    at, face = plans[body].at, plans[body].face
    x = y = z = 0
    if plans[body].face_time <= plans[body].contact and INNER <= face < EDGES:
        axis, step = (face - INNER) // 2, 1 if face % 2 else -1
        x, y, z = step if axis == 0 else 0, step if axis == 1 else 0, step if axis == 2 else 0
    return (at[0] + x, at[1] + y, at[2] + z), (x, y, z)


@inner_helper
def fetch_plans(plans, calendar, bucket):
    """Fetch the plans of the first body in a bucket, and of the second in an earlier one."""
    head, mask = calendar.head, len(calendar.head) - 2
    body = head[(bucket + _STRIDE) & mask]
    if body >= 0:
        fetch(plans, body)
    body = head[bucket & mask]
    if body >= 0 and plans[body].after >= 0:
        fetch(plans, plans[body].after)


@inner_helper
def look_ahead(rows, plans, calendar, partition, seen):
    """Fetch what the events some buckets after the current one will read, if bucket `seen` was the next to do
    so for. Returns which now is."""
    head, mask = calendar.head, len(calendar.head) - 2
    now = calendar.cursor[BUCKET]
    for bucket in range(max(seen, now - _MISSED), now + 1):
        fetch_plans(plans, calendar, bucket + 4 * _STRIDE)
        for stage in range(4):  # the body's boxes, who is in them, and the same for its partner
            body = head[(bucket + (3 - (stage + 1) // 2) * _STRIDE) & mask]
            while body >= 0:
                partner = plans[body].partner
                if stage == 0:
                    fetch(rows, body)
                    if partner >= 0:
                        fetch(plans, partner)
                        fetch(rows, partner)
                if stage < 2:
                    at, side = searched(plans, body)
                    fetch_about(rows, partition, at, side, stage == 1)
                elif plans[body].contact < plans[body].face_time:
                    at = plans[partner].at
                    fetch_about(rows, partition, (at[0], at[1], at[2]), (0, 0, 0), stage == 3)
                body = plans[body].after
    return now + 1
