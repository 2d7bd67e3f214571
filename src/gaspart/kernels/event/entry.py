"""Entry of particles from reservoirs behind open faces, if there is space in the container."""

from math import inf

from numpy import int64, uint64

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.event.boxes import insert, member
from gaspart.kernels.event.prediction import NOT_CROSSED, predict_after, without_contacts
from gaspart.kernels.event.queue import count_event
from gaspart.kernels.model import NONE
from gaspart.kernels.obstacles.opening import (
    draw_entering_velocity,
    face_of,
    lowest_vacant,
    occupy,
    place_on,
    schedule_next,
    words_of_attempt,
)
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add


@inner_helper
def next_attempt(reservoirs):
    """Return the time of the next attempt; infinite without reservoirs."""
    if reservoirs is not None:
        return reservoirs.time[0]
    return inf


@inner_helper
def overlaps(flights, position, j, time, space):
    """Return True if particle j, advanced or not, overlaps a new particle at a position and `time`."""
    late, sigma, square = time - flights[j].clock, 2.0 * flights[j].radius, 0.0
    for k in range(len(space.lengths)):
        x = flights[j].position[k] + flights[j].velocity[k] * late
        gap = abs(x - position[k])
        if space.periodic[k]:
            gap = min(gap, space.lengths[k] - gap)
        square += gap * gap
    return square < sigma * sigma


@inner_kernel
def is_free_of_all(flights, position, time, space, present):
    """Return True if a new particle overlaps no particle in the container."""
    for j in range(len(flights)):
        if present[j]:
            if overlaps(flights, position, j, time, space):
                return False
    return True


@inner_helper
def coordinate(boxes, axis, x):
    """Return the coordinate of the box that contains `x` along an axis."""
    return min(int64(x / boxes.widths[axis]), boxes.per_side[axis] - 1)


@inner_kernel
def is_free_of_neighbours(flights, position, time, space, boxes):
    """Return True if a new particle overlaps no particle in the boxes around it."""
    x, y, z = (
        coordinate(boxes, 0, position[0]),
        coordinate(boxes, 1, position[1]),
        coordinate(boxes, 2, position[2]),
    )
    for dz in range(3):
        beside_z = boxes.neighbour[2, z, dz]
        if beside_z < 0:
            continue
        for dy in range(3):
            beside_y = boxes.neighbour[1, y, dy]
            if beside_y < 0:
                continue
            for dx in range(3):
                beside_x = boxes.neighbour[0, x, dx]
                if beside_x < 0:
                    continue
                box, j = uint64(beside_x + beside_y + beside_z), uint64(0)
                for n in range(uint64(boxes.filled[box])):
                    j = uint64(member(boxes, box, n, j))
                    if overlaps(flights, position, j, time, space):
                        return False
    return True


@inner_helper
def is_free(particles, time, queue, boxes, space, reservoirs):
    """Return True if the particle of the present attempt overlaps no other particle. Without a queue the
    boxes are empty, and all particles are tested.
    """
    if queue is not None:
        return is_free_of_neighbours(particles.flights, reservoirs.position, time, space, boxes)
    return is_free_of_all(particles.flights, reservoirs.position, time, space, reservoirs.opened.present)


@inner_kernel
def send_in(flights, i, face, reservoirs, model, tally):
    """Set position and velocity of an entering particle, and count its momentum and energy."""
    mass = mass_of(i, model.masses, model.law)
    speed, square = draw_entering_velocity(flights[i].velocity, face, reservoirs)
    for k in range(len(model.space.lengths)):
        flights[i].position[k] = reservoirs.position[k]
    add(tally.wall_impulse, face, mass * speed)
    add(tally.wall_energy, face, -0.5 * mass * square)


@inner_helper
def predict_entered(particles, i, time, queue, boxes, model, tally):
    """Insert a particle into its box, and predict its next events, if there is a queue."""
    if queue is not None:
        for k in range(len(model.space.lengths)):
            particles.predictions[i].box[k] = coordinate(boxes, k, particles.flights[i].position[k])
        insert(particles.predictions, boxes, i)
        event = time, count_event(queue), True
        predict_after(particles, (i, NONE), queue, boxes, without_contacts(model), tally, event, NOT_CROSSED)


@inner_kernel
def admit(particles, queue, boxes, model, tally, limits, reservoirs):
    """Process attempts to enter, up to the first successful one. Returns (number of attempts, time of the
    last attempt, True if all particle numbers are in use). `limits`: (3,), time of the next event of the
    particles inside, time at which to stop, and maximum number of attempts.
    """
    soonest, stop, most = limits
    attempts, last, time, entered = 0, -inf, reservoirs.time[0], False
    while attempts < most and time < soonest and time <= stop and not entered:
        wait, where, first, second = words_of_attempt(reservoirs)
        face = face_of(where, reservoirs)
        place_on(reservoirs.position, face, (first, second), model.space.lengths)
        entered = is_free(particles, time, queue, boxes, model.space, reservoirs)
        if entered:
            i = lowest_vacant(reservoirs.opened)
            if i == NONE:
                return attempts, last, True
            send_in(particles.flights, i, face, reservoirs, model, tally)
            particles.flights[i].clock = time
            particles.images[i] = 0
            occupy(reservoirs.opened, i, face)
            predict_entered(particles, i, time, queue, boxes, model, tally)
        attempts += 1
        last = time
        schedule_next(time, wait, reservoirs)
        time = reservoirs.time[0]
    return attempts, last, False


@inner_helper
def admit_before(particles, queue, boxes, model, tally, limits, reservoirs):
    """Process attempts to enter by `admit`, if there are reservoirs."""
    if reservoirs is not None:
        return admit(particles, queue, boxes, model, tally, limits, reservoirs)
    return 0, -inf, False
