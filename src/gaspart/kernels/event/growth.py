"""Kernels of a compression (`state.compression`): particles that grow while they fly and collide.

The particles are smooth, have mass 1, and all grow by the same factor, in a container of hard or periodic
faces. The radius of a flight is the radius at clock time 0; at time t it is multiplied by 1 + rate t. Queue,
boxes and flights are the structures of `loop`. Here the predictions of the particles are repeated at every
event.
"""

from math import inf, sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.event.boxes import member, move, sort_in
from gaspart.kernels.event.queue import (
    EVENT_COUNT,
    count_event,
    fill,
    is_outdated,
    reschedule,
    soonest,
    time_of,
)
from gaspart.kernels.model import COLLISIONS, NONE, VIRIAL
from gaspart.kernels.physics.collision import gap_along
from gaspart.kernels.physics.contact import time_to_growing_contact, time_to_plane
from gaspart.kernels.physics.flight import advance, encounter
from gaspart.kernels.physics.running_sum import add

_PART = 2.0**-30  # minimum separation speed, as a fraction of the growth rate


@inner_helper
def time_of_contact(flights, i, j, offset, space, rate):
    """Return the time at which two growing particles touch; inf if they do not. `offset`: (d,), displacement
    of the second particle.
    """
    start, rr, rv, vv, _, _, _ = encounter(flights, i, j, offset, space, None)
    sigma = flights[i].radius + flights[j].radius
    return start + time_to_growing_contact(rr, rv, vv, sigma * (1.0 + rate * start), sigma * rate)


@inner_kernel
def next_face(particles, i, boxes, space, rate):
    """Return the next face of its box or of the container that a particle reaches: (time, 2 axis + side)."""
    flight, at = particles.flights[i], particles.predictions[i].box
    growth = space.margin * flight.radius * rate
    radius = space.margin * flight.radius * (1.0 + rate * flight.clock)
    soon = inf
    face = NONE
    for k in range(len(space.lengths)):
        x, v = flight.position[k], flight.velocity[k]
        for upper in range(2):
            time = inf
            if at[k] == (boxes.per_side[k] - 1 if upper else 0) and not space.periodic[k]:
                speed = (v if upper else -v) + growth
                if speed > 0.0:
                    time = max(0.0, (space.lengths[k] - x if upper else x) - radius) / speed
            elif (v > 0.0) if upper else (v < 0.0):
                plane = (at[k] + upper) * boxes.widths[k]
                if at[k] + upper == boxes.per_side[k]:
                    plane = space.lengths[k]  # exact for any rounding of the boxes
                time = max(0.0, time_to_plane(x, v, plane))
            if flight.clock + time < soon:
                soon = flight.clock + time
                face = 2 * k + upper
    return soon, face


@inner_helper
def box_near(boxes, at, n, space):
    """Return one of the 27 boxes around a box, and the displacement (3,) of its image. The box is -1 if it
    does not exist. `at`: (3,), coordinates of the central box. `n`: number of the neighbour.
    """
    a, b, c = n % 3, n // 3 % 3, n // 9
    x, y, z = boxes.neighbour[0, at[0], a], boxes.neighbour[1, at[1], b], boxes.neighbour[2, at[2], c]
    offset = (
        boxes.shift[0, at[0], a] * space.lengths[0],
        boxes.shift[1, at[1], b] * space.lengths[1],
        boxes.shift[2, at[2], c] * space.lengths[len(space.lengths) - 1],
    )
    return (-1 if x < 0 or y < 0 or z < 0 else x + y + z), offset


@inner_kernel
def predict(particles, i, boxes, space, rate, number):
    """Predict the next events of a particle. `number`: number of the present event."""
    predictions = particles.predictions
    best = inf
    partner = NONE
    for n in range(27):
        box, offset = box_near(boxes, predictions[i].box, n, space)
        if box < 0:
            continue
        other = NONE
        for m in range(boxes.filled[box]):
            other = int(member(boxes, box, m, other))
            if other != i:
                time = time_of_contact(particles.flights, i, other, offset, space, rate)
                if time < best or (time == best and time < inf and other < partner):
                    best = time
                    partner = other
    predictions[i].contact_time = best
    predictions[i].partner = partner
    predictions[i].predicted = number
    predictions[i].face_time, predictions[i].face = next_face(particles, i, boxes, space, rate)


@kernel
def start(particles, queue, boxes, space, rate):
    """Rescale the temperature to 1, stop the centre of mass, and predict all events."""
    flights = particles.flights
    d, count = len(space.lengths), len(flights)
    square = 0.0
    for k in range(d):
        total = 0.0
        for i in range(count):
            total += flights[i].velocity[k]
        for i in range(count):
            flights[i].velocity[k] -= total / count if count > 1 else 0.0
            square += flights[i].velocity[k] * flights[i].velocity[k]
    factor = sqrt(d * count / square)
    sort_in(particles.predictions, boxes)
    for i in range(count):
        for k in range(d):
            flights[i].velocity[k] *= factor
    for i in range(count):
        predict(particles, i, boxes, space, rate, queue.cursor[EVENT_COUNT])
    fill(queue, particles.predictions, 0.0)


@inner_kernel
def meet_face(particles, i, face, time, boxes, space, rate):
    """Move a particle into the next box, or reflect it at a wall; return True if its flight has changed."""
    flights, predictions = particles.flights, particles.predictions
    axis, upper = face // 2, face % 2
    outermost = predictions[i].box[axis] == (boxes.per_side[axis] - 1 if upper else 0)
    if outermost:
        advance(flights, i, time, space, None)
    if outermost and not space.periodic[axis]:
        growth = space.margin * flights[i].radius * rate
        speed = (flights[i].velocity[axis] if upper else -flights[i].velocity[axis]) + growth
        speed = max(speed, _PART * growth) + growth
        flights[i].velocity[axis] = -speed if upper else speed
        return True
    to = predictions[i].box[axis] + 2 * upper - 1
    if outermost:
        flights[i].position[axis] = 0.0 if upper else space.lengths[axis]
        to = 0 if upper else boxes.per_side[axis] - 1
    move(predictions, boxes, i, axis, to)
    return outermost


@inner_kernel
def collide(flights, i, j, time, space, rate, tally):
    """Advance two particles to their contact, where their growing surfaces push them apart."""
    advance(flights, i, time, space, None)
    advance(flights, j, time, space, None)
    rr = rv = 0.0
    for k in range(len(space.lengths)):
        gap = gap_along(flights, i, j, k, space)
        rr += gap * gap
        rv += gap * (flights[j].velocity[k] - flights[i].velocity[k])
    growth = (flights[i].radius + flights[j].radius) * rate
    length = sqrt(rr)
    approach = max(growth - rv / length, _PART * growth)
    for k in range(len(space.lengths)):
        impulse = approach * gap_along(flights, i, j, k, space) / length
        flights[i].velocity[k] -= impulse
        flights[j].velocity[k] += impulse
    tally.counts[COLLISIONS] += 1
    add(tally.sums, VIRIAL, approach * length)


@kernel
def run(particles, queue, boxes, space, tally, rate, stop, most):
    """Process all events up to time `stop`, or `most` collisions; return the time reached."""
    predictions = particles.predictions
    last = 0.0
    while tally.counts[COLLISIONS] < most:
        i = soonest(queue, predictions)
        if i < 0 or not time_of(predictions, i) <= stop:
            return stop
        time = time_of(predictions, i)
        last = max(last, time)
        number = count_event(queue)
        if predictions[i].face_time <= predictions[i].contact_time:
            if meet_face(particles, i, predictions[i].face, time, boxes, space, rate):
                predictions[i].changed = number
        elif not is_outdated(predictions, i):
            partner = predictions[i].partner
            collide(particles.flights, min(i, partner), max(i, partner), time, space, rate, tally)
            predictions[i].changed = predictions[partner].changed = number
            predict(particles, partner, boxes, space, rate, number)
            reschedule(queue, predictions, partner)
        predict(particles, i, boxes, space, rate, number)
        reschedule(queue, predictions, i)
    return last


@kernel
def closest(particles, boxes, space):
    """Return the minimum of r^2/sigma^2 over pairs in neighbouring boxes, at equal times; inf
    without pairs.
    """
    flights = particles.flights
    least = inf
    for i in range(len(flights)):
        for n in range(27):
            box, _ = box_near(boxes, particles.predictions[i].box, n, space)
            if box < 0:
                continue
            other = NONE
            for m in range(boxes.filled[box]):
                other = int(member(boxes, box, m, other))
                if other != i:
                    rr = 0.0
                    for k in range(len(space.lengths)):
                        gap = gap_along(flights, i, other, k, space)
                        rr += gap * gap
                    sigma = flights[i].radius + flights[other].radius
                    least = min(least, rr / (sigma * sigma))
    return least
