"""Particles of reservoirs outside of open faces, which try to enter.

All attempts at all faces are one Poisson process, the n-th of which has the random words of the counter n:
when it happens, where and how fast depend on nothing else, and whether it succeeds on what is inside.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.event.box_lists import insert
from gaspart.kernels.event.prediction import NOT_CROSSED, predict_after
from gaspart.kernels.event.queue import count_event
from gaspart.kernels.model import NONE
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.rng import flux_speed, log_of, normal_pair, random_words, uniform
from gaspart.kernels.physics.running_sum import add

_WHERE, _HOW_FAST = 0, 1  # which random words of an attempt
REFUSED, ENTERED, NO_ROOM = range(3)


class Reservoirs(NamedTuple):
    """What is outside of the open faces. key (2,), of the random numbers; rate: attempts per time, at all
    faces; up_to (2d,): the share of them at a face and those before it; width (2d,): (k_B T / m)^(1/2) of
    each reservoir."""

    key: np.ndarray
    rate: float
    up_to: np.ndarray
    width: np.ndarray


@kernel
def waiting_time(reservoirs, number):
    """The time before attempt `number`, after that before it: of an exponential distribution."""
    word, _, _, _ = random_words(reservoirs.key, _WHERE, number, 0)
    return -log_of(uniform(word)) / reservoirs.rate


@inner_kernel
def lowest_free(present):
    """The lowest number that no particle inside has, or NONE."""
    for i in range(len(present)):
        if not present[i]:
            return i
    return NONE


@inner_kernel
def is_free(flights, i, time, space, present):
    """Whether particle i, where it stands, overlaps none that is inside at a `time`; none is moved."""
    for j in range(len(flights)):
        if present[j]:
            late, square = time - flights[j].clock, 0.0
            sigma = flights[i].radius + flights[j].radius
            for k in range(len(space.lengths)):
                x = flights[j].position[k] + flights[j].velocity[k] * late
                gap = abs(x - flights[i].position[k])
                if space.periodic[k]:
                    gap = min(gap, space.lengths[k] - gap)
                square += gap * gap
            if square < sigma * sigma:
                return False
    return True


@inner_kernel
def place_on(flights, i, face, words, lengths):
    """Place a particle on a face, at the two random `words`."""
    axis, d, n = face // 2, len(lengths), 0
    for k in range(d):
        if k == axis:
            flights[i].position[k] = lengths[k] if face % 2 else 0.0
        else:
            flights[i].position[k] = uniform(words[n]) * lengths[k]
            n += 1


@inner_kernel
def send_in(flights, i, face, number, reservoirs, model, tally):
    """Give a particle the velocity of one that enters through a face, and count what it brings."""
    axis, d, width = face // 2, len(model.space.lengths), reservoirs.width[face]
    mass, inwards = mass_of(i, model.masses, model.law), -1.0 if face % 2 else 1.0
    speed = width * flux_speed(reservoirs.key, _HOW_FAST, number)
    one, other, _ = normal_pair(reservoirs.key, _HOW_FAST, number, 1)
    flights[i].velocity[axis] = inwards * speed
    flights[i].velocity[(axis + 1) % d] = width * one
    if d == 3:
        flights[i].velocity[(axis + 2) % d] = width * other
    square = 0.0
    for k in range(d):
        square += flights[i].velocity[k] * flights[i].velocity[k]
    add(tally.wall_impulse, face, mass * speed)
    add(tally.wall_energy, face, -0.5 * mass * square)


@inner_helper
def find_next(particles, i, time, queue, boxes, model, tally):
    """Put a particle into its box, and predict its next events, where there is a queue."""
    if queue is not None:
        for k in range(len(model.space.lengths)):
            box = np.int64(particles.flights[i].position[k] / boxes.widths[k])
            particles.predictions[i].box[k] = min(box, boxes.per_side[k] - 1)
        insert(particles.predictions, boxes, i)
        event = time, count_event(queue), True
        predict_after(particles, (i, NONE), queue, boxes, model, tally, event, NOT_CROSSED)


@kernel
def attempt(particles, event, queue, boxes, model, tally, reservoirs):
    """Let a particle try to enter. event: the time, and the number of the attempt. Returns REFUSED, ENTERED,
    or NO_ROOM where there is no number for it."""
    time, number = event
    flights, opened = particles.flights, model.faces.open
    _, word, first, second = random_words(reservoirs.key, _WHERE, number, 0)
    face, share = 0, uniform(word)
    while share >= reservoirs.up_to[face]:
        face += 1
    i = lowest_free(opened.present)
    if i == NONE:
        return NO_ROOM
    place_on(flights, i, face, (first, second), model.space.lengths)
    if not is_free(flights, i, time, model.space, opened.present):
        for k in range(len(model.space.lengths)):
            flights[i].position[k] = np.nan
        return REFUSED
    send_in(flights, i, face, number, reservoirs, model, tally)
    flights[i].clock = time
    particles.images[i] = 0
    opened.present[i] = 1
    opened.entries[face] += 1
    find_next(particles, i, time, queue, boxes, model, tally)
    return ENTERED
