"""Empty queues of events in difficult orders, as plain Python, and count the times that are read.

    NUMBA_DISABLE_JIT=1 python tests/kernels/event/drained_queue.py 512

prints a line for each order: its name, True if events came in order, their number, and that of times read.
"""

import sys
from types import SimpleNamespace

import numpy as np

from gaspart.kernels.event import queue as module
from gaspart.kernels.event.queue import empty_queue, fill, reschedule, soonest, tie

read = 0


def counted(predictions, i, its=module.time_of):
    """Return the time of the next event of a particle, and count the reading."""
    global read
    read += 1
    return its(predictions, i)


def particles(times, pairs):
    """Return predictions of a face, or of contacts of neighbours, at these times."""
    both = ((time, np.inf) if pairs else (np.inf, time) for time in map(float, times))
    return [
        SimpleNamespace(contact_time=contact, face_time=face, partner=i ^ 1, before=-1, after=-1, bucket=-1)
        for i, (contact, face) in enumerate(both)
    ]


def drain(predictions, next_time, others=0):
    """Process all events. next_time: function of a time and the number of the event; others: number of
    particles whose events also change. Returns True if they came in order, and their number."""
    queue, rng = empty_queue(len(predictions)), np.random.default_rng(1)
    times = np.array([min(one.contact_time, one.face_time) for one in predictions])
    fill(queue, predictions, 0.0)
    ordered, number = True, 0
    while (i := soonest(queue, predictions)) >= 0:
        first = min(np.flatnonzero(times == times.min()), key=lambda j: tie(predictions, j))
        ordered &= bool(first == i)
        time, number = times[i], number + 1
        for j in {int(i), *map(int, rng.integers(len(predictions), size=others))}:
            if times[j] < np.inf:
                times[j] = predictions[j].contact_time = next_time(max(times[j], time), number)
                predictions[j].face_time = np.inf
                reschedule(queue, predictions, j)
    return ordered, number


def main():
    n = int(sys.argv[1])
    module.time_of = counted
    rng = np.random.default_rng(2)
    never, zeros = (lambda time, number: np.inf), np.zeros(n)

    def again(time, number):
        return time if number <= n else np.inf

    def soon(last):
        """Return the time a little later, up to this number of events."""
        return lambda time, number: time + 1e-13 * rng.random() if number <= last else np.inf

    close = np.append(rng.random(n - 1) * 1e-12, 1e9)
    orders = {
        "simultaneous faces": (particles(zeros, pairs=False), never),
        "simultaneous contacts": (particles(zeros, pairs=True), never),
        "close beside the mean time": (particles(close, pairs=True), never),
        "later events at the same time": (particles(zeros, pairs=False), again),
        "later events in the same bucket": (particles(close, pairs=True), soon(2 * n)),
        "events of others that change": (particles(close, pairs=True), soon(n), 3),
        "evenly spread": (particles(rng.random(n), pairs=True), never),
    }
    for name, order in orders.items():
        before = read
        ordered, number = drain(*order)
        print(name, ordered, number, read - before, sep="|")


if __name__ == "__main__":
    main()
