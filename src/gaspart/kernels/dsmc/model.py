"""Data structures of the kernels of the DSMC engine: particles, grid, kinds, workspace, counters.

A *slot* is the present position of a particle in memory. Slots are in the order of cells, and `numbers`
contains the number of the particle in each slot. Sums over threads are exact (`physics.exact_sum`), so they
do not depend on the order of addition. The structures contain only arrays and plain numbers, because numba
passes no other types to threads.
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
PADDED = 8  # number of counters per thread, a cache line


class Particles(NamedTuple):
    """Particles by slot, and their periodic images by particle number."""

    data: np.ndarray
    rows: np.ndarray
    numbers: np.ndarray
    images: np.ndarray


class Grid(NamedTuple):
    """Grid of cells, and arrays for sorting particles into them."""

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
    """Constants, working arrays and counters of a step."""

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
    """Thermal, sliding and open faces of the container."""

    kind: np.ndarray
    level: np.ndarray
    velocity: np.ndarray | None
    shear: np.ndarray | None
    accommodation: np.ndarray | None
    ramp: Ramp | None
    present: np.ndarray | None


class Law(NamedTuple):
    """Collision law of particles with restitution and spins."""

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
    """Return the row of `data` that contains the coordinates along an axis."""
    return particles.rows[axis]


@inner_helper
def velocity_row(particles, axis):
    """Return the row of `data` that contains the velocities along an axis."""
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
    """Return the number of particles in the container."""
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


# Random numbers of the collisions, which depend only on a key, the step, the cell and the trial.


_M0, _M1 = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
_W0, _W1 = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)
_LOW, _HALF, _ROUNDS = np.uint64(0xFFFFFFFF), np.uint64(32), 10
_BLOCK_BITS = np.uint64(8)  # block bits in the last word of the counter; the higher bits count steps
_TABLE_BITS = 7
_WORD = 2.0**-32


def _natural_log(x: float) -> float:
    """Compute ln x of a number near 1 with only +, -, x and /."""
    s = (x - 1.0) / (x + 1.0)
    total = 0.0
    for coefficient in reversed(LOG_SERIES):
        total = total * s * s + coefficient
    return 2.0 * s * total


_CENTRES = [1.0 + (n + 0.5) / 2**_TABLE_BITS for n in range(2**_TABLE_BITS)]
_INVERSES = np.array([1.0 / x for x in _CENTRES])
_LOGS = np.array([_natural_log(x / 1.5) + _natural_log(1.2) + _natural_log(1.25) for x in _CENTRES])
"""Logarithms and inverses of numbers from 1 to 2, at the centres of 128 equal intervals."""


@inner_helper
def words_of(key, step, cell, trial, block):
    """Return four random words of 32 bits, each in a word of 64 bits. The generator is Philox4x32-10 (Salmon,
    Moraes, Dror & Shaw, SC11 (2011)). `key`: (2,), words of 32 bits. `step` and `cell` and `trial` and
    `block`: counter; step below 2^53, cell and trial below 2^32, block below 2^8.
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
    """Convert a 32-bit word to a number between 0 and 1, excluding both."""
    return (np.float64(random_bits) + 0.5) * _WORD


@inner_helper
def below(random_bits, count):
    """Convert a 32-bit word to an integer from 0 to count - 1. The relative differences between the
    probabilities of these integers are at most count / 2^32.
    """
    return np.int64((random_bits * np.uint64(count)) >> _HALF)


@inner_helper
def waiting_time(random_bits):
    """Convert a 32-bit word to an exponentially distributed random number with mean 1. The result is -ln of
    `fraction`, with an error of 1e-12. The leading bits of the word select an entry of a table, and a series
    gives the remainder.
    """
    bits = np.float64(np.float64(random_bits) + 0.5).view(np.int64)
    exponent = (bits >> 52) - 1023
    entry = (bits >> (52 - _TABLE_BITS)) & ((1 << _TABLE_BITS) - 1)
    mantissa = np.int64((bits & ((1 << 52) - 1)) | (1023 << 52)).view(np.float64)
    r = mantissa * _INVERSES[entry] - 1.0
    series = r * (1.0 - r * (0.5 - r * (1.0 / 3.0 - r * (0.25 - r * 0.2))))
    return (32 - exponent) * LN2 - (_LOGS[entry] + series)


# Mean speed of the particles, and the step length that suits it.
#
# A step can be divided into 2^level parts. A level suits the gas if the mean speed is between two limits.
# Below the upper limit, particles do not fly too far in a part. Above the lower limit, the kicks in a part do
# not change the speeds too much.


class Pace(NamedTuple):
    """Step lengths, and the speeds for which they are suitable."""

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
    """Return the number of particles in the container."""
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
    """Return the first level that suits the particles, or the number of levels."""
    speed = mean_speed(particles, pace.drifts, pace.present)
    pace.fastest[0] = max(pace.fastest[0], speed)
    for level in range(len(pace.low)):
        if pace.low[level] <= speed <= pace.high[level]:
            return level
    return len(pace.low)


@inner_helper
def still_fits(particles, pace):
    """Return True if the present level suits the particles."""
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
    """Kick one particle, and add its change of momentum to `momentum` (3,). `counter`: key and number of the
    kick.
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
    """Kick all particles without changing the total momentum. `width`: width of the distribution of kicks for
    mass 1. `counter`: see `_kick`. `injected_energy`: (1, 2), energy given to the particles, see
    `physics.running_sum.add`.
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
