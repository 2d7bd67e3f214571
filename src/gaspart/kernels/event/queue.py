"""Event queue: one next event per particle, in a calendar of short unsorted buckets.

A bucket spans about the mean time between events. So finding the earliest event requires a look at one or two
particles, for any total number. Events beyond the horizon of the calendar wait in an overflow list. The order
of events is strict and does not depend on the buckets: by time, then by the tie key (`tie`).

Many events may be simultaneous, or very close together, for example for a lattice whose planes are faces of
boxes. If the current bucket is long, it is sorted. Its list begins with at most MOST_UNSORTED particles in
any order, followed by sorted runs. Each run is more than twice as long as the preceding one. So k events of a
bucket need at most of the order of k log(k)^2 comparisons, and k log(k) if no new events are added.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel

BUCKET, FILLED, RUNS, EVENT_COUNT = range(4)  # indices of Queue.cursor
MOST_UNSORTED = 32
"""Maximum number of unsorted particles in a bucket."""
MOST_RUNS = 32
FIRST, LENGTH = range(2)  # rows of Queue.runs


class Queue(NamedTuple):
    """Calendar of the next events of all particles."""

    head: np.ndarray
    rate: np.ndarray
    cursor: np.ndarray
    runs: np.ndarray


def empty_queue(count: int) -> Queue:
    """Return an empty queue for `count` particles."""
    buckets = 1 << max(4, (4 * count - 1).bit_length())
    head, runs = np.full(buckets + 1, -1, dtype=np.int32), np.zeros((2, MOST_RUNS), dtype=np.int64)
    return Queue(head, np.ones(1), np.zeros(4, dtype=np.int64), runs)


@inner_helper
def time_of(predictions, i):
    """Return the time of a particle's next event."""
    return min(predictions[i].contact_time, predictions[i].face_time)


@inner_helper
def count_event(queue):
    """Count an event; return its number."""
    queue.cursor[EVENT_COUNT] += 1
    return queue.cursor[EVENT_COUNT]


@inner_helper
def is_outdated(predictions, i):
    """Return True if the partner's flight has changed since the contact was predicted."""
    return predictions[predictions[i].partner].changed > predictions[i].predicted


@inner_helper
def tie(predictions, i):
    """Return the key that orders simultaneous events. Faces come first, in the order of particles, then pairs
    in the order of the lower and the higher index. No two predictions have the same key, although both
    particles of a pair may predict their contact. If one of the two is outdated, their order determines how
    much is searched. It must not depend on the order in a bucket.
    """
    if predictions[i].face_time <= predictions[i].contact_time:
        return i - len(predictions)
    partner = predictions[i].partner
    return 2 * (min(i, partner) * len(predictions) + max(i, partner)) + (1 if i > partner else 0)


@inner_helper
def bucket_of(queue, predictions, i):
    """Return the bucket for the time of a particle's next event. It is at least the current bucket. Beyond
    the horizon it is the overflow bucket.
    """
    buckets = len(queue.head) - 1
    current = queue.cursor[BUCKET]
    x = time_of(predictions, i) * queue.rate[0]
    bucket = buckets
    if x < current + buckets:
        bucket = max(int(x), current) & (buckets - 1)
    return bucket


@inner_helper
def _link(queue, predictions, i):
    """Insert a particle into the bucket for its time."""
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
    """Remove a particle from its bucket. If the particle has no neighbour, its own unused entry is written
    instead, so that there is no branch for the processor to predict.
    """
    bucket = np.int64(predictions[i].bucket)
    after, before = np.int64(predictions[i].after), np.int64(predictions[i].before)
    first = np.int64(queue.head[bucket])
    queue.head[bucket] = first if before >= 0 else after
    predictions[before if before >= 0 else i].after = after
    predictions[after if after >= 0 else i].before = before
    queue.cursor[FILLED] -= bucket < len(queue.head) - 1
    if queue.cursor[RUNS] > 0:
        _take_from_runs(queue, i, after)


@inner_kernel
def _take_from_runs(queue, i, after):
    """Remove the first particle of a run from the run; an empty run is removed."""
    next_run = np.int64(-1)
    for r in range(queue.cursor[RUNS]):
        first = queue.runs[FIRST, r]
        if first == i:
            queue.runs[FIRST, r] = after
            if after == next_run:
                queue.cursor[RUNS] -= 1
                for s in range(r, queue.cursor[RUNS]):
                    queue.runs[FIRST, s] = queue.runs[FIRST, s + 1]
                    queue.runs[LENGTH, s] = queue.runs[LENGTH, s + 1]
            return
        next_run = first


@inner_helper
def reschedule(queue, predictions, i):
    """Move a particle whose predictions have changed into its new bucket."""
    _unlink(queue, predictions, i)
    _link(queue, predictions, i)


@inner_kernel
def fill(queue, predictions, now):
    """Sort all particles into buckets that span the mean time between events."""
    queue.head[:] = -1
    total = 0.0
    finite = 0
    for i in range(len(predictions)):
        if time_of(predictions, i) < np.inf:
            total += max(time_of(predictions, i) - now, 0.0)
            finite += 1
    queue.rate[0] = finite * (finite / total) if total > 0.0 else 1.0
    if not queue.rate[0] * abs(now) < 2.0**52:  # times too short to number: a single bucket for all
        queue.rate[0] = 0.0
    queue.cursor[BUCKET] = int(max(now, 0.0) * queue.rate[0])
    queue.cursor[FILLED] = queue.cursor[RUNS] = 0
    for i in range(len(predictions)):
        _link(queue, predictions, i)


@inner_kernel
def _recall_overflow(queue, predictions):
    """Move particles of the overflow whose time is now within the horizon into their buckets."""
    buckets = len(queue.head) - 1
    i = np.int64(queue.head[buckets])
    while i >= 0:
        after = np.int64(predictions[i].after)
        if time_of(predictions, i) * queue.rate[0] < queue.cursor[BUCKET] + buckets:
            reschedule(queue, predictions, i)
        i = after


@inner_kernel
def _leap(queue, predictions):
    """Advance to the first event of the overflow, all other buckets being empty; False without events."""
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
def _is_before(predictions, i, j):
    """Return True if the event of particle i precedes the event of particle j."""
    time, other = time_of(predictions, i), time_of(predictions, j)
    return time < other or (time == other and tie(predictions, i) < tie(predictions, j))


@inner_kernel
def _merge(predictions, head, other_head):
    """Merge two sorted lists of particles, linked by `after` up to -1; return the first particle."""
    first = last = np.int64(-1)
    while head >= 0 or other_head >= 0:
        if other_head < 0 or (head >= 0 and _is_before(predictions, head, other_head)):
            particle, head = head, np.int64(predictions[head].after)
        else:
            particle, other_head = other_head, np.int64(predictions[other_head].after)
        if last >= 0:
            predictions[last].after = particle
        else:
            first = particle
        last = particle
    return first


@inner_kernel
def _cut(predictions, first, count):
    """End a list after `count` particles; return the first particle of the rest, or -1."""
    last = first
    for _ in range(count - 1):
        if last >= 0:
            last = np.int64(predictions[last].after)
    if last < 0:
        return last
    rest = np.int64(predictions[last].after)
    predictions[last].after = -1
    return rest


@inner_kernel
def _sort(predictions, first, count):
    """Sort a list of `count` particles, linked by `after` up to -1; return the first particle."""
    length = 1
    while length < count:
        rest, last, first = first, np.int64(-1), np.int64(-1)
        while rest >= 0:
            head = rest
            other_head = _cut(predictions, head, length)
            rest = _cut(predictions, other_head, length) if other_head >= 0 else np.int64(-1)
            merged = _merge(predictions, head, other_head)
            if last >= 0:
                predictions[last].after = merged
            else:
                first = merged
            last = merged
            while predictions[last].after >= 0:
                last = np.int64(predictions[last].after)
        length *= 2
    return first


@inner_kernel
def _add_run(queue, predictions, count):
    """Sort the first `count` particles of the current bucket into a run. Following runs that are at most
    twice as long are merged into it.
    """
    bucket = queue.cursor[BUCKET] & (len(queue.head) - 2)
    runs, run, end = queue.cursor[RUNS], np.int64(-1), np.int64(-1)
    first = np.int64(queue.head[bucket])
    rest = _cut(predictions, first, count)
    run = _sort(predictions, first, count)
    while runs > 0 and queue.runs[LENGTH, runs - 1] <= 2 * count:
        runs -= 1
        end = queue.runs[FIRST, runs - 1] if runs > 0 else np.int64(-1)
        if end >= 0:
            predictions[predictions[end].before].after = -1
        run = _merge(predictions, run, rest)
        count += queue.runs[LENGTH, runs]
        rest = end
    queue.head[bucket] = run
    before, i = np.int64(-1), run
    while i >= 0:
        predictions[i].before = before
        before, i = i, np.int64(predictions[i].after)
    predictions[before].after = rest
    if rest >= 0:
        predictions[rest].before = before
    queue.runs[FIRST, runs], queue.runs[LENGTH, runs] = run, count
    queue.cursor[RUNS] = runs + 1


@inner_kernel
def _soonest_of_many(queue, predictions):
    """Return the particle with the earliest event in a long current bucket."""
    runs, count = queue.cursor[RUNS], 0
    i = np.int64(queue.head[queue.cursor[BUCKET] & (len(queue.head) - 2)])
    end = queue.runs[FIRST, runs - 1] if runs > 0 else np.int64(-1)
    while i != end:
        i = np.int64(predictions[i].after)
        count += 1
    if count > MOST_UNSORTED:
        _add_run(queue, predictions, count)
    runs = queue.cursor[RUNS]
    best, i = queue.runs[FIRST, 0], np.int64(queue.head[queue.cursor[BUCKET] & (len(queue.head) - 2)])
    while i != queue.runs[FIRST, runs - 1]:
        if _is_before(predictions, i, best):
            best = i
        i = np.int64(predictions[i].after)
    for r in range(1, runs):
        if _is_before(predictions, queue.runs[FIRST, r], best):
            best = queue.runs[FIRST, r]
    return best


@inner_helper
def soonest(queue, predictions):
    """Return the particle with the earliest event, or -1 if there are no more events."""
    buckets = len(queue.head) - 1
    while True:
        if queue.cursor[FILLED] == 0 and not _leap(queue, predictions):
            return -1
        best = np.int64(queue.head[queue.cursor[BUCKET] & (buckets - 1)])
        if best >= 0:
            soon, count = time_of(predictions, best), 1
            i = np.int64(predictions[best].after)
            while i >= 0:
                if count == MOST_UNSORTED:
                    return _soonest_of_many(queue, predictions)
                time = time_of(predictions, i)
                if time < soon or (time == soon and tie(predictions, i) < tie(predictions, best)):
                    best, soon = i, time
                i = np.int64(predictions[i].after)
                count += 1
            return best
        queue.cursor[BUCKET] += 1
        if queue.cursor[BUCKET] & (buckets - 1) == 0:
            _recall_overflow(queue, predictions)
