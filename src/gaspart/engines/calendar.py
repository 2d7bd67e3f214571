"""The event queue: one next event per body, in a calendar of short unsorted buckets.

A bucket spans about the mean time between events, so finding the soonest event means looking at one or
two bodies, whatever their number. Events beyond the calendar's horizon wait in an overflow list. The
order is strict and does not depend on the buckets: by time, then by the tie key that the caller gives.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernel import kernel

BUCKET, FILLED = 0, 1


class Calendar(NamedTuple):
    """time (N,), tie (N,) of each body's next event; the linked lists of the buckets, the last of which is
    the overflow; slot (N,) the bucket that a body is in, or -1; rate (1,) buckets per unit of time;
    cursor (2,): the current bucket, and how many bodies are in buckets that are not the overflow."""

    time: np.ndarray
    tie: np.ndarray
    head: np.ndarray
    following: np.ndarray
    preceding: np.ndarray
    slot: np.ndarray
    rate: np.ndarray
    cursor: np.ndarray


def empty_calendar(count: int) -> Calendar:
    """A calendar for `count` bodies with nothing in it."""
    buckets = 1 << max(4, (4 * count - 1).bit_length())
    return Calendar(
        time=np.full(count, np.inf),
        tie=np.zeros(count, dtype=np.int64),
        head=np.full(buckets + 1, -1, dtype=np.int32),
        following=np.full(count, -1, dtype=np.int32),
        preceding=np.full(count, -1, dtype=np.int32),
        slot=np.full(count, -1, dtype=np.int32),
        rate=np.ones(1),
        cursor=np.zeros(2, dtype=np.int64),
    )


@kernel
def _link(calendar, body):
    """Put a body into the bucket of its time."""
    buckets = len(calendar.head) - 1
    current = calendar.cursor[BUCKET]
    x = calendar.time[body] * calendar.rate[0]
    slot = buckets
    if x < current + buckets:
        slot = max(int(x), current) & (buckets - 1)
        calendar.cursor[FILLED] += 1
    first = calendar.head[slot]
    calendar.following[body] = first
    calendar.preceding[body] = -1
    if first >= 0:
        calendar.preceding[first] = body
    calendar.head[slot] = body
    calendar.slot[body] = slot


@kernel
def _unlink(calendar, body):
    """Take a body out of its bucket."""
    slot = calendar.slot[body]
    after = calendar.following[body]
    before = calendar.preceding[body]
    if before >= 0:
        calendar.following[before] = after
    else:
        calendar.head[slot] = after
    if after >= 0:
        calendar.preceding[after] = before
    if slot < len(calendar.head) - 1:
        calendar.cursor[FILLED] -= 1


@kernel
def schedule(calendar, body, time, tie):
    """Set a body's next event, in place of the one it had."""
    if calendar.slot[body] >= 0:
        _unlink(calendar, body)
    calendar.time[body] = time
    calendar.tie[body] = tie
    _link(calendar, body)


@kernel
def restart(calendar, now):
    """Sort all bodies in anew by their `time`, with buckets of the mean time between their events."""
    calendar.head[:] = -1
    count = len(calendar.time)
    total = 0.0
    finite = 0
    for body in range(count):
        if calendar.time[body] < np.inf:
            total += max(calendar.time[body] - now, 0.0)
            finite += 1
    calendar.rate[0] = finite * (finite / total) if total > 0.0 else 1.0
    if not calendar.rate[0] * abs(now) < 2.0**52:  # times too short to number: one bucket for all
        calendar.rate[0] = 0.0
    calendar.cursor[BUCKET] = int(max(now, 0.0) * calendar.rate[0])
    calendar.cursor[FILLED] = 0
    for body in range(count):
        _link(calendar, body)


@kernel
def _recall_overflow(calendar):
    """Move the bodies of the overflow whose time has come within the horizon into their buckets."""
    buckets = len(calendar.head) - 1
    body = calendar.head[buckets]
    while body >= 0:
        after = calendar.following[body]
        if calendar.time[body] * calendar.rate[0] < calendar.cursor[BUCKET] + buckets:
            _unlink(calendar, body)
            _link(calendar, body)
        body = after


@kernel
def soonest(calendar):
    """The body whose event comes first, or -1 if nothing will ever happen again."""
    buckets = len(calendar.head) - 1
    while True:
        if calendar.cursor[FILLED] == 0:  # leap to the first event beyond the horizon
            first = np.inf
            body = calendar.head[buckets]
            while body >= 0:
                first = min(first, calendar.time[body])
                body = calendar.following[body]
            if not first * calendar.rate[0] < 2.0**62:
                return -1
            calendar.cursor[BUCKET] = max(calendar.cursor[BUCKET], int(first * calendar.rate[0]))
            _recall_overflow(calendar)
        best = calendar.head[calendar.cursor[BUCKET] & (buckets - 1)]
        if best >= 0:
            body = calendar.following[best]
            while body >= 0:
                if calendar.time[body] < calendar.time[best] or (
                    calendar.time[body] == calendar.time[best] and calendar.tie[body] < calendar.tie[best]
                ):
                    best = body
                body = calendar.following[body]
            return best
        calendar.cursor[BUCKET] += 1
        if calendar.cursor[BUCKET] & (buckets - 1) == 0:
            _recall_overflow(calendar)
