"""Data structures of the DSMC engine's kernels: particles, grid, kinds, workspace, tally.

A *slot* is a particle's present position in memory; the slots are in the order of the cells, and `numbers`
gives the particle's number. Sums of several threads are exact (`physics.exact_sum`), so that they do not
depend on the order of addition. The structures hold only arrays and plain numbers, because numba passes no
other types to threads.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.model import Ramp, Space
from gaspart.kernels.physics.logarithm import LN2, LOG_SERIES
from gaspart.kernels.physics.rng import normal_pair
from gaspart.kernels.physics.running_sum import add

COLLISIONS, TRIALS, EXCEEDED, UNFINISHED, FAR, CROWDED = range(6)
PADDED = 8  # number of counts of a thread, a cache line


class Particles(NamedTuple):
    """Particles by slot, and their periodic images by particle number.

    Attributes
    ----------
    data : (2d + 1, N), rows of positions, of velocities, and one spare row, by slot
    rows : (2d + 2,), row of `data` of each position, each velocity and the spare row, then the row of
        `numbers` in use
    numbers : (2, N), numbers of the particles by slot, in one of the two rows
    images : (d, N), periodic images by particle
    """

    data: np.ndarray
    rows: np.ndarray
    numbers: np.ndarray
    images: np.ndarray


class Grid(NamedTuple):
    """Grid of cells, and the sort of particles into them.

    Attributes
    ----------
    per_side : (d,), number of cells along each axis
    origin : (d,), lower end of the first cell
    inverse : (d,), inverse widths of the cells
    strides : (d,), strides of the index of a cell
    volume : volume of a cell
    cell : (N,), cell of the particle in each slot
    order : (N,), workspace of the sort
    counts : (threads, cells), number of each thread's slots in each cell; between open faces
        (threads, cells + 1), with the slots without a particle, which come last
    starts : (cells + 1,), first slot of each cell, and end of the last one
    """

    per_side: np.ndarray
    origin: np.ndarray
    inverse: np.ndarray
    strides: np.ndarray
    volume: float
    cell: np.ndarray
    order: np.ndarray
    counts: np.ndarray
    starts: np.ndarray


class Workspace(NamedTuple):
    """Constants, working arrays and tally of a step.

    Attributes
    ----------
    margin : 1 if walls stop surfaces, 0 if they stop centres
    dt : length of a step
    clock : (1,), number of the step, counted from 0
    kind : (N,), kind of each particle, or (0,) if all are alike
    radius, mass, inertia : (K,), by kind; `inertia` is the moment of inertia
    largest : largest radius
    key : (2,), words of 32 bits for the random numbers of collisions
    wall_key : (2,), words of 64 bits for the random numbers of thermal faces
    flights : (threads, 2), two particles in the form of the event-driven engine's physics, see
        `kernels.model.flight_dtype`
    inverse_mass, inverse_inertia : (threads, 2), inverses for these particles
    pair_spins : (threads, 2, 3), spins of these particles
    sums : (threads, 2, 2), sums of the collision law
    counts : (threads, 8), see the names at the top of the module
    virial, loss : (threads, WIDTH), exact sums, see `physics.exact_sum`
    wall_hits : (threads, 2d), number of hits of each face
    wall_impulse, wall_heat : (threads, 2d, WIDTH), exact sums of momentum and energy given to each face
    inverse_area : (K, 2d), inverse of the area of a face that centres of particles of a kind can reach;
        without entries unless these areas differ
    per_area : (threads, 2d, d + 1, WIDTH), momentum along each axis and energy given to each face, divided by
        that area; without entries unless these areas differ
    """

    margin: float
    dt: float
    clock: np.ndarray
    kind: np.ndarray
    radius: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    largest: float
    key: np.ndarray
    wall_key: np.ndarray
    flights: np.ndarray
    inverse_mass: np.ndarray
    inverse_inertia: np.ndarray
    pair_spins: np.ndarray
    sums: np.ndarray
    counts: np.ndarray
    virial: np.ndarray
    loss: np.ndarray
    wall_hits: np.ndarray
    wall_impulse: np.ndarray
    wall_heat: np.ndarray
    inverse_area: np.ndarray
    per_area: np.ndarray


class Faces(NamedTuple):
    """Thermal, sliding and open faces of the container.

    Attributes
    ----------
    kind, level : (2d,), kind of the faces and temperature of the thermal ones, see `kernels.model`
    velocity : (2d, d), velocities of the faces, or None if no face slides
    shear : (threads, 2d, d, WIDTH), momentum given to each face along each axis, or None if no face slides
    accommodation, ramp : see `kernels.model`
    present : (N,), 1 for particles inside; 0 for the others, which are at rest in the middle of the container
        and in no cell; None if no face is open
    """

    kind: np.ndarray
    level: np.ndarray
    velocity: np.ndarray | None
    shear: np.ndarray | None
    accommodation: np.ndarray | None
    ramp: Ramp | None
    present: np.ndarray | None


class Law(NamedTuple):
    """Collision law of particles with restitution and spins.

    Attributes
    ----------
    normal, tangential : coefficients of restitution
    spins : (N, 3), by particle
    viscous : see `kernels.model.ContactLaw`
    """

    normal: float
    tangential: float
    spins: np.ndarray
    viscous: float | None


class ThreadContext(NamedTuple):
    """Arguments of one thread of a step; `part` is its number."""

    space: Space
    workspace: Workspace
    part: int


@inner_helper
def position_row(particles, axis):
    """Return the row of `data` that holds the coordinates along an axis."""
    return particles.rows[axis]


@inner_helper
def velocity_row(particles, axis):
    """Return the row of `data` that holds the velocities along an axis."""
    return particles.rows[len(particles.images) + axis]


@inner_helper
def number_row(particles):
    """Return the row of `numbers` that is in use."""
    return particles.rows[len(particles.rows) - 1]


@inner_helper
def number_at(particles, slot):
    """Return the number of the particle in a slot."""
    return np.int64(particles.numbers[number_row(particles), slot])


@inner_helper
def kind_in(particles, slot, workspace):
    """Return the kind of the particle in a slot."""
    if len(workspace.kind) == 0:
        return np.int64(0)
    return np.int64(workspace.kind[number_at(particles, slot)])


@inner_kernel
def count_inside(present):
    """Return the number of particles inside."""
    number = 0
    for n in range(len(present)):
        number += present[n]
    return number


@inner_helper
def open_space(lengths):
    """Return a space without faces."""
    if len(lengths) == 3:
        return Space(lengths, (False, False, False), 0.0)
    return Space(lengths, (False, False), 0.0)


# Random numbers of the collisions: a function of a key, the step, the cell and the trial alone.


_M0, _M1 = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
_W0, _W1 = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)
_LOW, _HALF, _ROUNDS = np.uint64(0xFFFFFFFF), np.uint64(32), 10
_BLOCK_BITS = np.uint64(8)  # bits of the block in the counter's last word; the higher bits count steps
_TABLE_BITS = 7
_WORD = 2.0**-32


def _natural_log(x: float) -> float:
    """Compute ln x of a number near 1 with +, -, x and / alone."""
    s = (x - 1.0) / (x + 1.0)
    total = 0.0
    for coefficient in reversed(LOG_SERIES):
        total = total * s * s + coefficient
    return 2.0 * s * total


_CENTRES = [1.0 + (n + 0.5) / 2**_TABLE_BITS for n in range(2**_TABLE_BITS)]
_INVERSES = np.array([1.0 / x for x in _CENTRES])
_LOGS = np.array([_natural_log(x / 1.5) + _natural_log(1.2) + _natural_log(1.25) for x in _CENTRES])
"""Logarithms of numbers from 1 to 2, and inverses, at the centres of 128 equal parts."""


@inner_helper
def words_of(key, step, cell, trial, block):
    """Return four random words of 32 bits, each in a word of 64 bits.

    The generator is Philox4x32-10 (Salmon, Moraes, Dror & Shaw, SC11 (2011)).

    key : (2,), words of 32 bits
    step, cell, trial, block : counter; step below 2^53, cell and trial below 2^32, block below 2^8
    """
    number = np.uint64(step)
    c0, c1, c2 = np.uint64(trial), np.uint64(cell), number & _LOW
    c3 = ((number >> _HALF) << _BLOCK_BITS) | np.uint64(block)
    k0, k1 = np.uint64(key[0]), np.uint64(key[1])
    for _ in range(_ROUNDS):
        first, second = _M0 * c0, _M1 * c2
        c0, c1 = (second >> _HALF) ^ c1 ^ k0, second & _LOW
        c2, c3 = (first >> _HALF) ^ c3 ^ k1, first & _LOW
        k0 = (k0 + _W0) & _LOW
        k1 = (k1 + _W1) & _LOW
    return c0, c1, c2, c3


@inner_helper
def fraction(random_bits):
    """Convert a word of 32 bits to a number above 0 and below 1."""
    return (np.float64(random_bits) + 0.5) * _WORD


@inner_helper
def below(random_bits, count):
    """Convert a word of 32 bits to a whole number from 0 to count - 1.

    The probabilities of these numbers differ by count / 2^32.
    """
    return np.int64((random_bits * np.uint64(count)) >> _HALF)


@inner_helper
def waiting_time(random_bits):
    """Convert a word of 32 bits to an exponential random number of mean 1.

    The result is -ln of `fraction`, to 1e-12. The leading bits of the word choose an entry of a table; a
    series gives the rest.
    """
    bits = np.float64(np.float64(random_bits) + 0.5).view(np.int64)
    exponent = (bits >> 52) - 1023
    entry = (bits >> (52 - _TABLE_BITS)) & ((1 << _TABLE_BITS) - 1)
    mantissa = np.int64((bits & ((1 << 52) - 1)) | (1023 << 52)).view(np.float64)
    r = mantissa * _INVERSES[entry] - 1.0
    series = r * (1.0 - r * (0.5 - r * (1.0 / 3.0 - r * (0.25 - r * 0.2))))
    return (32 - exponent) * LN2 - (_LOGS[entry] + series)


# Mean speed of the particles, and the length of a step that fits it.
#
# A step can be divided into 2^level parts. A level fits if the mean speed is within its limits: below the
# upper limit particles do not fly too far in a part, and above the lower limit the kicks of a part do not
# change the speeds too much.


class Pace(NamedTuple):
    """Lengths of a step and the speeds that they fit.

    Attributes
    ----------
    low, high : (levels,), limits of the mean speed of each level
    level : present level
    drifts : (d,), whether only the motion relative to the mean counts along an axis
    fastest : (1,), highest mean speed found
    present : see `Faces`
    """

    low: np.ndarray
    high: np.ndarray
    level: int
    drifts: tuple[bool, ...]
    fastest: np.ndarray
    present: np.ndarray | None


@inner_helper
def drift_along(particles, axis, drifts):
    """Return the mean velocity along an axis if it does not count as motion, otherwise 0."""
    total = 0.0
    if drifts[axis]:
        v = particles.data[velocity_row(particles, axis)]
        for n in range(len(v)):
            total += v[n]
        total /= len(v)
    return total


@inner_helper
def number_moving(particles, present):
    """Return the number of particles inside."""
    if present is not None:
        return count_inside(present)
    return particles.data.shape[1]


@inner_helper
def mean_speed(particles, drifts, present):
    """Return the mean speed of all particles; 0 if there are no particles."""
    d, count = len(particles.images), particles.data.shape[1]
    u = particles.data[velocity_row(particles, 0)]
    v = particles.data[velocity_row(particles, 1)]
    w = particles.data[velocity_row(particles, d - 1)]
    flat = 0.0 if d == 2 else 1.0
    mean_u, mean_v = drift_along(particles, 0, drifts), drift_along(particles, 1, drifts)
    mean_w = drift_along(particles, d - 1, drifts)
    total = 0.0
    for n in range(count):
        x, y, z = u[n] - mean_u, v[n] - mean_v, flat * (w[n] - mean_w)
        total += sqrt(x * x + y * y + z * z)
    return total / max(number_moving(particles, present), 1)


@kernel
def fitting_level(particles, pace):
    """Return the first level that fits the particles, or the number of levels."""
    speed = mean_speed(particles, pace.drifts, pace.present)
    pace.fastest[0] = max(pace.fastest[0], speed)
    for level in range(len(pace.low)):
        if pace.low[level] <= speed <= pace.high[level]:
            return level
    return len(pace.low)


@inner_helper
def still_fits(particles, pace):
    """Return True if the present level fits the particles."""
    if pace is None:
        return True
    return fitting_level(particles, pace) == pace.level


# Random kicks of all particles at once: the stochastic thermostat of a driven granular gas.


@inner_helper
def _energy(particles, slot, mass):
    square = 0.0
    for k in range(len(particles.images)):
        v = particles.data[velocity_row(particles, k), slot]
        square += v * v
    return 0.5 * mass * square


@inner_helper
def _kick(particles, slot, width, counter, mass, momentum):
    """Kick one particle, and add its change of momentum to `momentum` (3,).

    counter : key and number of the kick
    """
    key, number = counter
    i = number_at(particles, slot)
    first, second, block = normal_pair(key, i, number, 1)
    changes = first, second, 0.0
    if len(particles.images) == 3:
        third, _, _ = normal_pair(key, i, number, block)
        changes = first, second, third
    for k in range(len(particles.images)):
        particles.data[velocity_row(particles, k), slot] += width * changes[k]
    scale = mass * width
    x, y, z = momentum
    return x + scale * changes[0], y + scale * changes[1], z + scale * changes[2]


@kernel
def kick_all(particles, workspace, width, counter, injected_energy):
    """Kick all particles without a change of the total momentum.

    width : width of the distribution of kicks for mass 1
    counter : see `_kick`
    injected_energy : (1, 2), energy given to the particles, see `physics.running_sum.add`
    """
    momentum, total = (0.0, 0.0, 0.0), 0.0
    for slot in range(particles.data.shape[1]):
        mass = workspace.mass[kind_in(particles, slot, workspace)]
        add(injected_energy, 0, -_energy(particles, slot, mass))
        momentum = _kick(particles, slot, width / sqrt(mass), counter, mass, momentum)
        total += mass
    for slot in range(particles.data.shape[1]):
        mass = workspace.mass[kind_in(particles, slot, workspace)]
        for k in range(len(particles.images)):
            particles.data[velocity_row(particles, k), slot] -= momentum[k] / total
        add(injected_energy, 0, _energy(particles, slot, mass))
