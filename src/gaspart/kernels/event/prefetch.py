"""Prefetch of the data of the next events, while the present event is processed.

Colliding particles are at arbitrary positions in memory. If all particles together exceed the processor's
private cache, an event waits for data about ten times. The waiting takes longer than the computation. But the
queue contains the next events. Some buckets ahead, the predictions of a particle are fetched. Fewer buckets
ahead, the lists of the boxes around it are fetched, then the particles in these boxes, and the same for its
partner. The prefetch changes no data. Data fetched for an event that does not occur are not used.
"""

from numpy import int64, uint32, uint64

from gaspart.kernels.compile.policy import inner_helper
from gaspart.kernels.event.boxes import NUMBER, number_of
from gaspart.kernels.event.neighbour_lists import cell_along
from gaspart.kernels.event.queue import BUCKET
from gaspart.kernels.model import BOX_FACES, WELL_EDGES
from gaspart.kernels.prefetch import TOGETHER, fetch, fetch_numbered, fetch_two

CACHED = 1 << 15  # maximum number of particles for which the private caches suffice, without neighbour lists
CACHED_LISTS = 3 << 12  # the same number with neighbour lists
_STRIDE = 3  # number of buckets between stages, about one event each
_MISSED = 15  # number of buckets that are fetched later if the queue has skipped them
_BOTH = (int64(0), int64(0), int64(0))  # side value of an axis on which both sides are fetched
_FETCHED = 2  # number of entries of a box whose particles are fetched; few boxes have more particles


@inner_helper
def steps(side, is_one):
    """Return first step and end (0..3) of the boxes to search along an axis: all, one side, or the
    only one.
    """
    return (uint64(1 + side), uint64(2 + side)) if side or is_one else (uint64(0), uint64(3))


@inner_helper
def fetch_about(flights, boxes, at, side, members):
    """Fetch the lists of the boxes around a box, or with `members` their particles. The particles are fetched
    after the lists have arrived. `at`: (3,), coordinates of the box. `side`: (3,), -1 or 1 for an axis along
    which only boxes on this side are fetched, otherwise 0.
    """
    neighbour = boxes.neighbour
    last_particle = uint32(len(flights) - 1)
    ax, ay, az = uint64(at[0]), uint64(at[1]), uint64(at[2])
    low_x, end_x = steps(side[0], False)
    low_y, end_y = steps(side[1], False)
    low_z, end_z = steps(side[2], len(flights[0].position) == 2)
    for dz in range(low_z, end_z):
        z = neighbour[2, az, dz]
        for dy in range(low_y, end_y):
            y = neighbour[1, ay, dy]
            if z < 0 or y < 0:
                continue
            first = uint64(max(y + z + neighbour[0, ax, low_x], 0))
            if members:
                for dx in range(low_x, end_x):
                    box = uint64(max(y + z + neighbour[0, ax, dx], 0))
                    for n in range(uint64(_FETCHED)):
                        fetch(flights, min(boxes.members[box, n], last_particle))
            else:
                fetch(boxes.members, first)
                fetch(boxes.filled, first)
                last = uint64(max(y + z + neighbour[0, ax, end_x - uint64(1)], 0))
                fetch(boxes.members, last)
                fetch(boxes.filled, last)


@inner_helper
def crossing_of(face):
    """Return the step (3,) into the next box for the face code of a box."""
    axis, step = (face - BOX_FACES) // 2, 1 if face % 2 else -1
    return step if axis == 0 else 0, step if axis == 1 else 0, step if axis == 2 else 0


@inner_helper
def next_search(predictions, i):
    """Return the box (3,) and the side (3,) of the next search of a particle. The search is around this box.
    The side is nonzero for the axis along which the particle crosses into the next box; only boxes on that
    side are searched.
    """
    at, face = predictions[i].box, int64(predictions[i].face)
    side = _BOTH
    if predictions[i].face_time <= predictions[i].contact_time and BOX_FACES <= face < WELL_EDGES:
        side = crossing_of(face)
    return (at[0] + side[0], at[1] + side[1], at[2] + side[2]), side


@inner_helper
def fetch_predictions(predictions, queue, bucket):
    """Fetch the predictions of particles in three buckets. They are the third particle of a bucket, the
    second of a later bucket, and the first of a still later one. Each is found from the predictions of the
    preceding particle.
    """
    head, mask = queue.head, len(queue.head) - 2
    first = head[(bucket + 2 * _STRIDE) & mask]
    if first >= 0:
        fetch(predictions, first)
    first = head[(bucket + _STRIDE) & mask]
    if first >= 0 and predictions[first].after >= 0:
        fetch(predictions, predictions[first].after)
    first = head[bucket & mask]
    if first >= 0:
        second = predictions[first].after
        if second >= 0 and predictions[second].after >= 0:
            fetch(predictions, predictions[second].after)


@inner_helper
def fetch_listed(flights, lists, i):
    """Fetch the flights of the particles in a neighbour list."""
    row = uint64(i) * uint64(lists.room)
    first = row + uint64(1)
    while first <= row + uint64(lists.candidates[row]):
        fetch_numbered(flights, lists.candidates, first, NUMBER)
        first += uint64(TOGETHER)


@inner_helper
def fetch_list(flights, lists, i):
    """Fetch the flight of a particle and its neighbour list."""
    fetch(flights, i)
    fetch(lists.listed, i)
    fetch_two(lists.candidates, i * lists.room)


@inner_helper
def fetch_renewal(flights, lists, i, time):
    """Fetch the data for the renewal of a particle's list at a time. These are the lists of the particles in
    the list, and the cells around the position of the particle at that time.
    """
    row = i * lists.room
    for n in range(row + 1, row + 1 + int64(lists.candidates[row])):
        fetch_two(lists.candidates, number_of(lists.candidates[n]) * lists.room)
    flight, neighbour = flights[i], lists.neighbour
    late, d = time - flight.clock, len(flight.position)
    ax = cell_along(lists, 0, flight.position[0] + flight.velocity[0] * late)
    ay = cell_along(lists, 1, flight.position[1] + flight.velocity[1] * late)
    az = cell_along(lists, 2, flight.position[2] + flight.velocity[2] * late) if d == 3 else int64(0)
    for dz in range(3):
        for dy in range(3):
            y, z = neighbour[1, ay, dy], neighbour[2, az, dz]
            if y < 0 or z < 0:
                continue
            for dx in range(3):
                fetch_two(lists.pages, (y + z + max(neighbour[0, ax, dx], 0)) * lists.per_cell)


@inner_helper
def prefetch_lists(particles, queue, lists, next_bucket):
    """Fetch the data of the next events like `prefetch`, with neighbour lists."""
    flights, predictions = particles.flights, particles.predictions
    head, mask = queue.head, len(queue.head) - 2
    now = queue.cursor[BUCKET]
    for bucket in range(max(next_bucket, now - _MISSED), now + 1):
        fetch_predictions(predictions, queue, bucket + 3 * _STRIDE)
        for stage in range(2):  # the lists of a particle and of its partner, and the particles in them
            i = int64(head[(bucket + (2 - stage) * _STRIDE) & mask])
            while i >= 0:
                partner = int64(predictions[i].partner)
                meets = predictions[i].contact_time < predictions[i].face_time
                if stage == 0:
                    fetch_list(flights, lists, i)
                    if meets:
                        fetch(predictions, partner)
                        fetch_list(flights, lists, partner)
                else:
                    fetch_listed(flights, lists, i)
                    if meets:
                        fetch_listed(flights, lists, partner)
                    elif predictions[i].face == BOX_FACES:
                        fetch_renewal(flights, lists, i, predictions[i].face_time)
                i = int64(predictions[i].after)
    return now + 1


@inner_helper
def prefetch(particles, queue, boxes, next_bucket):
    """Fetch the data of events some buckets ahead; return the next bucket. `next_bucket`: first bucket whose
    data have not been fetched yet.
    """
    flights, predictions = particles.flights, particles.predictions
    head, mask = queue.head, len(queue.head) - 2
    now = queue.cursor[BUCKET]
    for bucket in range(max(next_bucket, now - _MISSED), now + 1):
        fetch_predictions(predictions, queue, bucket + 4 * _STRIDE)
        for stage in range(4):  # boxes around it, the particles in them, the same for its partner
            i = int64(head[(bucket + (3 - (stage + 1) // 2) * _STRIDE) & mask])
            while i >= 0:
                partner = predictions[i].partner
                if stage == 0:
                    fetch(flights, i)
                    if partner >= 0:
                        fetch(predictions, partner)
                        fetch(flights, partner)
                if stage < 2:
                    at, side = next_search(predictions, i)
                    fetch_about(flights, boxes, at, side, stage == 1)
                elif predictions[i].contact_time < predictions[i].face_time:
                    at = predictions[partner].box
                    about = int64(at[0]), int64(at[1]), int64(at[2])
                    fetch_about(flights, boxes, about, _BOTH, stage == 3)
                i = int64(predictions[i].after)
    return now + 1
