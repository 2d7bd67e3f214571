"""Open faces: particles that leave through them, and particles that enter from reservoirs.

All attempts to enter, at all faces, form one Poisson process. Attempt n uses the random words that the
generator returns for the counter n. These words determine its position, its velocity, and the time to the
next attempt. An engine decides whether an attempt succeeds.

If a particle leaves, its number becomes free. In the event-driven engine, an entering particle receives the
lowest free number. Free numbers are counted in blocks, so that the search is short. Its result depends only
on which particles are in the container.
"""

from math import nan

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.model import NONE
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.rng import flux_speed, log_of, normal_pair, random_words, uniform
from gaspart.kernels.physics.running_sum import add

NUMBERS = 256
"""Number of particle numbers in a block of `Open.vacant`."""
_PLACE, _VELOCITY = 0, 1  # number of random words of an attempt


@inner_kernel
def leave(flights, i, face, model, tally, law, opened):
    """Remove a particle, and count the energy and momentum that it carries through the face."""
    axis, square = face // 2, 0.0
    mass = mass_of(i, model.masses, law)
    add(tally.wall_impulse, face, mass * abs(flights[i].velocity[axis]))
    for k in range(len(model.space.lengths)):
        square += flights[i].velocity[k] * flights[i].velocity[k]
        flights[i].position[k] = nan
        flights[i].velocity[k] = 0.0
    add(tally.wall_energy, face, 0.5 * mass * square)
    opened.present[i] = 0
    opened.vacant[i // NUMBERS] += 1


@inner_helper
def collide_open(flights, i, face, model, tally, law, opened):
    """Remove a particle at a face if faces may be open."""
    if opened is not None:
        leave(flights, i, face, model, tally, law, opened)


@inner_kernel
def lowest_vacant(opened):
    """Return the lowest free number, or NONE."""
    for block in range(len(opened.vacant)):
        if opened.vacant[block] > 0:
            for i in range(block * NUMBERS, min((block + 1) * NUMBERS, len(opened.present))):
                if not opened.present[i]:
                    return i
    return NONE


@inner_kernel
def occupy(opened, i, face):
    """Count a particle that has entered through a face as present."""
    opened.present[i] = 1
    opened.vacant[i // NUMBERS] -= 1
    opened.entries[face] += 1


@inner_helper
def waiting_time(random_bits, rate):
    """Draw a time from the exponential distribution with a given rate."""
    return -log_of(uniform(random_bits)) / rate


@kernel
def schedule_first(reservoirs, clock):
    """Schedule the first attempt after the time `clock`, with the random words of the counter 0."""
    random_bits, _, _, _ = random_words(reservoirs.key, _PLACE, 0, 0)
    reservoirs.number[0] = 1
    reservoirs.time[0] = clock + waiting_time(random_bits, reservoirs.rate)


@inner_helper
def schedule_next(time, random_bits, reservoirs):
    """Schedule the attempt that follows the attempt at `time`."""
    reservoirs.number[0] += 1
    reservoirs.time[0] = time + waiting_time(random_bits, reservoirs.rate)


@inner_helper
def words_of_attempt(reservoirs):
    """Return four random words of the next attempt. They determine the time to the attempt after it, the
    face, and the position on the face.
    """
    return random_words(reservoirs.key, _PLACE, reservoirs.number[0], 0)


@inner_helper
def face_of(random_bits, reservoirs):
    """Return the face of an attempt."""
    face, fraction = 0, uniform(random_bits)
    while fraction >= reservoirs.up_to[face]:
        face += 1
    return face


@inner_helper
def place_on(position, face, words, lengths):
    """Set a random position on a face from two random `words`."""
    axis, n = face // 2, 0
    for k in range(len(lengths)):
        if k == axis:
            position[k] = lengths[k] if face % 2 else 0.0
        else:
            position[k] = uniform(words[n]) * lengths[k]
            n += 1


@inner_kernel
def draw_entering_velocity(velocity, face, reservoirs):
    """Draw the velocity of an entering particle; return its normal speed, and the squared speed."""
    axis, d, width = face // 2, len(reservoirs.up_to) // 2, reservoirs.width[face]
    number, key = reservoirs.number[0], reservoirs.key
    speed = width * flux_speed(key, _VELOCITY, number)
    first, second, _ = normal_pair(key, _VELOCITY, number, 1)
    velocity[axis] = -speed if face % 2 else speed
    velocity[(axis + 1) % d] = width * first
    if d == 3:
        velocity[(axis + 2) % d] = width * second
    square = 0.0
    for k in range(d):
        square += velocity[k] * velocity[k]
    return speed, square
