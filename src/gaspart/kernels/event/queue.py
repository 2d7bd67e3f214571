"""The event queue: one next event per body, in a calendar of short unsorted buckets.

A bucket spans about the mean time between events, so finding the soonest event means looking at one or
two bodies, whatever their number. Events beyond the calendar's horizon wait in an overflow list. The
order is strict and does not depend on the buckets: by time, then by the tie key that the caller gives.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compilation import inner_helper, inner_kernel

BUCKET, FILLED, TURN = range(3)


PLAN = np.dtype(
    [
        ("contact", "f8"),  # time of the next contact foreseen, with
        ("face_time", "f8"),  # time of the next face of a box or of the container, and
        ("foreseen", "i8"),  # at which turn (event) the contact was foreseen,
        ("changed", "i8"),  # and at which this body's flight last changed
        ("partner", "i4"),  # whom,
        ("face", "i4"),  # which
        ("at", "i4", 3),  # coordinates of its box
        ("before", "i4"),  # its neighbours in its bucket of the calendar,
        ("after", "i4"),
        ("slot", "i4"),  # which is this one, or -1
    ],
    align=True,
)
"""One body's plans, one cache line of 64 bytes: what an event reads and writes beside the body's flight."""


class Calendar(NamedTuple):
    """head: first body of each bucket, the last of which is the overflow; rate (1,): buckets per unit of
    time; cursor (3,): the current bucket, how many bodies are in buckets that are not the overflow, and the
    turn, which counts events."""

    head: np.ndarray
    rate: np.ndarray
    cursor: np.ndarray


def empty_calendar(count: int) -> Calendar:
    """A calendar for `count` bodies with nothing in it."""
    buckets = 1 << max(4, (4 * count - 1).bit_length())
    return Calendar(np.full(buckets + 1, -1, dtype=np.int32), np.ones(1), np.zeros(3, dtype=np.int64))


@inner_helper
def time_of(plans, body):
    """The time of a body's next event."""
    return min(plans[body].contact, plans[body].face_time)


@inner_helper
def next_turn(calendar):
    """Count an event."""
    calendar.cursor[TURN] += 1
    return calendar.cursor[TURN]


@inner_helper
def is_stale(plans, body):
    """Whether the partner's flight has changed since the body's contact with it was foreseen."""
    return plans[plans[body].partner].changed > plans[body].foreseen


@inner_helper
def tie(plans, body):
    """What orders simultaneous events: faces first, by body, then pairs by lower and higher index.

    No two plans have the same key, though both bodies of a pair may plan their contact: if one of the plans
    is out of date, which comes first decides how much is searched, and a bucket's order must not decide that.
    """
    if plans[body].face_time <= plans[body].contact:
        return body - len(plans)
    partner = plans[body].partner
    return 2 * (min(body, partner) * len(plans) + max(body, partner)) + (1 if body > partner else 0)


@inner_helper
def slot_of(calendar, plans, body):
    """The bucket of a body's time: the current one at the earliest, the overflow beyond the horizon."""
    buckets = len(calendar.head) - 1
    current = calendar.cursor[BUCKET]
    x = time_of(plans, body) * calendar.rate[0]
    slot = buckets
    if x < current + buckets:
        slot = max(int(x), current) & (buckets - 1)
    return slot


@inner_helper
def _link(calendar, plans, body):
    """Put a body into the bucket of its time."""
    slot = slot_of(calendar, plans, body)
    if slot < len(calendar.head) - 1:
        calendar.cursor[FILLED] += 1
    first = calendar.head[slot]
    plans[body].after = first
    plans[body].before = -1
    if first >= 0:
        plans[first].before = body
    calendar.head[slot] = body
    plans[body].slot = slot


@inner_helper
def _unlink(calendar, plans, body):
    """Take a body out of its bucket."""
    slot = plans[body].slot
    after = plans[body].after
    before = plans[body].before
    if before >= 0:
        plans[before].after = after
    else:
        calendar.head[slot] = after
    if after >= 0:
        plans[after].before = before
    if slot < len(calendar.head) - 1:
        calendar.cursor[FILLED] -= 1


@inner_helper
def reschedule(calendar, plans, body):
    """Put a body whose plans have changed where it now belongs."""
    _unlink(calendar, plans, body)
    _link(calendar, plans, body)


@inner_kernel
def fill(calendar, plans, now):
    """Sort all bodies in anew, with buckets of the mean time between their events."""
    calendar.head[:] = -1
    total = 0.0
    finite = 0
    for body in range(len(plans)):
        if time_of(plans, body) < np.inf:
            total += max(time_of(plans, body) - now, 0.0)
            finite += 1
    calendar.rate[0] = finite * (finite / total) if total > 0.0 else 1.0
    if not calendar.rate[0] * abs(now) < 2.0**52:  # times too short to number: one bucket for all
        calendar.rate[0] = 0.0
    calendar.cursor[BUCKET] = int(max(now, 0.0) * calendar.rate[0])
    calendar.cursor[FILLED] = 0
    for body in range(len(plans)):
        _link(calendar, plans, body)


@inner_kernel
def _recall_overflow(calendar, plans):
    """Move the bodies of the overflow whose time has come within the horizon into their buckets."""
    buckets = len(calendar.head) - 1
    body = calendar.head[buckets]
    while body >= 0:
        after = plans[body].after
        if time_of(plans, body) * calendar.rate[0] < calendar.cursor[BUCKET] + buckets:
            reschedule(calendar, plans, body)
        body = after


@inner_kernel
def _leap(calendar, plans):
    """With all buckets empty, go straight to the first event of the overflow. False if there is none."""
    first = np.inf
    body = calendar.head[len(calendar.head) - 1]
    while body >= 0:
        first = min(first, time_of(plans, body))
        body = plans[body].after
    if not first * calendar.rate[0] < 2.0**62:
        return False
    calendar.cursor[BUCKET] = max(calendar.cursor[BUCKET], int(first * calendar.rate[0]))
    _recall_overflow(calendar, plans)
    return True


@inner_helper
def soonest(calendar, plans):
    """The body whose event comes first, or -1 if nothing will ever happen again."""
    buckets = len(calendar.head) - 1
    while True:
        if calendar.cursor[FILLED] == 0 and not _leap(calendar, plans):
            return -1
        best = calendar.head[calendar.cursor[BUCKET] & (buckets - 1)]
        if best >= 0:
            soon = time_of(plans, best)
            body = plans[best].after
            while body >= 0:
                time = time_of(plans, body)
                if time < soon or (time == soon and tie(plans, body) < tie(plans, best)):
                    best, soon = body, time
                body = plans[body].after
            return best
        calendar.cursor[BUCKET] += 1
        if calendar.cursor[BUCKET] & (buckets - 1) == 0:
            _recall_overflow(calendar, plans)
