"""The event queue: one next event per particle, in a calendar of short unsorted buckets.

A bucket spans about the mean time between events, so finding the soonest event means looking at one or
two particles, whatever their number. Events beyond the calendar's horizon wait in an overflow list. The
order is strict and does not depend on the buckets: by time, then by the tie key that the caller gives.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel

BUCKET, FILLED, EVENT_COUNT = range(3)  # of Queue.cursor


class Queue(NamedTuple):
    """head: first particle of each bucket, the last of which is the overflow; rate (1,): buckets per unit of
    time; cursor (3,): the current bucket, how many particles are in buckets that are not the overflow, and
    the number of events processed."""

    head: np.ndarray
    rate: np.ndarray
    cursor: np.ndarray


def empty_queue(count: int) -> Queue:
    """A queue for `count` particles with nothing in it."""
    buckets = 1 << max(4, (4 * count - 1).bit_length())
    return Queue(np.full(buckets + 1, -1, dtype=np.int32), np.ones(1), np.zeros(3, dtype=np.int64))


@inner_helper
def time_of(predictions, i):
    """The time of a particle's next event."""
    return min(predictions[i].contact_time, predictions[i].face_time)


@inner_helper
def count_event(queue):
    """The number of this event."""
    queue.cursor[EVENT_COUNT] += 1
    return queue.cursor[EVENT_COUNT]


@inner_helper
def is_outdated(predictions, i):
    """Whether the partner's flight has changed since the particle's contact with it was predicted."""
    return predictions[predictions[i].partner].changed > predictions[i].predicted


@inner_helper
def tie(predictions, i):
    """What orders simultaneous events: faces first, by particle, then pairs by lower and higher index.

    No two predictions have the same key, though both particles of a pair may predict their contact: if one of
    these is outdated, which comes first decides how much is searched, and a bucket's order must not decide
    that.
    """
    if predictions[i].face_time <= predictions[i].contact_time:
        return i - len(predictions)
    partner = predictions[i].partner
    return 2 * (min(i, partner) * len(predictions) + max(i, partner)) + (1 if i > partner else 0)


@inner_helper
def bucket_of(queue, predictions, i):
    """The bucket of a particle's time: the current one at the earliest, the overflow beyond the horizon."""
    buckets = len(queue.head) - 1
    current = queue.cursor[BUCKET]
    x = time_of(predictions, i) * queue.rate[0]
    bucket = buckets
    if x < current + buckets:
        bucket = max(int(x), current) & (buckets - 1)
    return bucket


@inner_helper
def _link(queue, predictions, i):
    """Put a particle into the bucket of its time."""
    bucket = bucket_of(queue, predictions, i)
    queue.cursor[FILLED] += bucket < len(queue.head) - 1
    first = np.int64(queue.head[bucket])
    predictions[first if first >= 0 else i].before = i
    predictions[i].after = first
    predictions[i].before = -1
    queue.head[bucket] = i
    predictions[i].bucket = bucket


@inner_helper
def _unlink(queue, predictions, i):
    """Take a particle out of its bucket. Where it has no neighbour its own entry is written instead, which
    means nothing any more: no processor predicts a branch."""
    bucket = np.int64(predictions[i].bucket)
    after, before = np.int64(predictions[i].after), np.int64(predictions[i].before)
    first = np.int64(queue.head[bucket])
    queue.head[bucket] = first if before >= 0 else after
    predictions[before if before >= 0 else i].after = after
    predictions[after if after >= 0 else i].before = before
    queue.cursor[FILLED] -= bucket < len(queue.head) - 1


@inner_helper
def reschedule(queue, predictions, i):
    """Put a particle whose predictions have changed into the bucket where it now belongs."""
    _unlink(queue, predictions, i)
    _link(queue, predictions, i)


@inner_kernel
def fill(queue, predictions, now):
    """Sort all particles in, with buckets of the mean time between their events."""
    queue.head[:] = -1
    total = 0.0
    finite = 0
    for i in range(len(predictions)):
        if time_of(predictions, i) < np.inf:
            total += max(time_of(predictions, i) - now, 0.0)
            finite += 1
    queue.rate[0] = finite * (finite / total) if total > 0.0 else 1.0
    if not queue.rate[0] * abs(now) < 2.0**52:  # times too short to number: one bucket for all
        queue.rate[0] = 0.0
    queue.cursor[BUCKET] = int(max(now, 0.0) * queue.rate[0])
    queue.cursor[FILLED] = 0
    for i in range(len(predictions)):
        _link(queue, predictions, i)


@inner_kernel
def _recall_overflow(queue, predictions):
    """Move the particles of the overflow whose time has come within the horizon into their buckets."""
    buckets = len(queue.head) - 1
    i = np.int64(queue.head[buckets])
    while i >= 0:
        after = np.int64(predictions[i].after)
        if time_of(predictions, i) * queue.rate[0] < queue.cursor[BUCKET] + buckets:
            reschedule(queue, predictions, i)
        i = after


@inner_kernel
def _leap(queue, predictions):
    """With all buckets empty, go straight to the first event of the overflow. False if there is none."""
    first = np.inf
    i = np.int64(queue.head[len(queue.head) - 1])
    while i >= 0:
        first = min(first, time_of(predictions, i))
        i = np.int64(predictions[i].after)
    if not first * queue.rate[0] < 2.0**62:
        return False
    queue.cursor[BUCKET] = max(queue.cursor[BUCKET], int(first * queue.rate[0]))
    _recall_overflow(queue, predictions)
    return True


@inner_helper
def soonest(queue, predictions):
    """The particle whose event comes first, or -1 if there are no more events."""
    buckets = len(queue.head) - 1
    while True:
        if queue.cursor[FILLED] == 0 and not _leap(queue, predictions):
            return -1
        best = np.int64(queue.head[queue.cursor[BUCKET] & (buckets - 1)])
        if best >= 0:
            soon = time_of(predictions, best)
            i = np.int64(predictions[best].after)
            while i >= 0:
                time = time_of(predictions, i)
                if time < soon or (time == soon and tie(predictions, i) < tie(predictions, best)):
                    best, soon = i, time
                i = np.int64(predictions[i].after)
            return best
        queue.cursor[BUCKET] += 1
        if queue.cursor[BUCKET] & (buckets - 1) == 0:
            _recall_overflow(queue, predictions)
