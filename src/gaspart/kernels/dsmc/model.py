"""What the DSMC engine's kernels pass to one another: particles, grid, kinds, room, tally.

A *slot* is a particle's present place in memory, the slots being in the order of the cells; `numbers` gives
the particle's number. What several threads add up is exact (`physics.exact_sum`), so that the sums
do not depend on the order of adding. The structures hold arrays and plain numbers only, because numba
passes nothing else to threads.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper
from gaspart.kernels.model import Ramp, Space

COLLISIONS, TRIALS, EXCEEDED, UNFINISHED, FAR = range(5)
PADDED = 8  # counts of a thread, a cache line


class Particles(NamedTuple):
    """By slot: data (2d + 1, N), rows of positions, velocities and one that is spare; numbers (2, N), of the
    particles, in one row of them. rows (2d + 2,): in which rows of `data` the positions, the velocities and
    the spare one are, and in which row the numbers. By particle: images (d, N)."""

    data: np.ndarray
    rows: np.ndarray
    numbers: np.ndarray
    images: np.ndarray


class Grid(NamedTuple):
    """The cells: per_side (d,) along each axis; origin (d,), where the first begins; inverse (d,) of their
    widths; strides (d,) of their index; volume of one. cell (N,), that of the particle in each slot; order
    (N,): room for the sort; counts (threads, cells): of each thread's slots; starts (cells + 1,): the first
    slot of each."""

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
    """Constants and working arrays of a step. margin: 1 if walls stop surfaces, 0 if they stop centres; dt:
    the length of a step; clock (1,): its number, counted from 0.

    By particle: kind (N,), or (0,) if all are alike; by kind (K,): radius, mass, inertia (moment of);
    largest: the largest radius. key (2,): words of 32 bits for the random numbers of collisions; wall_key
    (2,): of 64 bits, for those of thermal faces.

    Of each thread, room for two particles as the event-driven engine's physics takes them: flights
    (threads, 2), see `kernels.model.flight_dtype`; inverse_mass, inverse_inertia (threads, 2); pair_spins
    (threads, 2, 3); sums (threads, 2, 2).

    The tally, by thread: counts (threads, 8), see the names at the module's top; virial and loss (threads,
    WIDTH); wall_hits (threads, 2d); wall_impulse and wall_heat (threads, 2d, WIDTH), see `exact_sum`;
    per_area (threads, 2d, d + 1, WIDTH), the momentum that each face is given along each axis and the energy,
    each per area that centres of particles of the kind can reach. inverse_area (K, 2d): one divided by that
    area. Both have no entry unless these areas differ.
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
    """Of the container's faces (2d,): kind and temperature of those that are thermal, see `kernels.model`,
    as for accommodation and ramp; velocity (2d, d), and by thread shear (threads, 2d, d, WIDTH), the momentum
    that they were given along each axis, both None if no face slides."""

    kind: np.ndarray
    level: np.ndarray
    velocity: np.ndarray | None
    shear: np.ndarray | None
    accommodation: np.ndarray | None
    ramp: Ramp | None


class Law(NamedTuple):
    """normal, tangential: restitution; spins (N, 3) by particle; viscous: see `kernels.model.ContactLaw`."""

    normal: float
    tangential: float
    spins: np.ndarray
    viscous: float | None


class ThreadContext(NamedTuple):
    """The arguments of one thread of a step, number `part`."""

    space: Space
    workspace: Workspace
    part: int


@inner_helper
def position_row(particles, axis):
    """The row of `data` that holds the coordinates along an axis."""
    return particles.rows[axis]


@inner_helper
def velocity_row(particles, axis):
    """The row of `data` that holds the velocities along an axis."""
    return particles.rows[len(particles.images) + axis]


@inner_helper
def number_row(particles):
    """The row of `numbers` that holds them."""
    return particles.rows[len(particles.rows) - 1]


@inner_helper
def number_at(particles, slot):
    """The number of the particle in a slot."""
    return np.int64(particles.numbers[number_row(particles), slot])


@inner_helper
def kind_in(particles, slot, workspace):
    """The kind of the particle in a slot."""
    if len(workspace.kind) == 0:
        return np.int64(0)
    return np.int64(workspace.kind[number_at(particles, slot)])


@inner_helper
def open_space(lengths):
    """A space without faces."""
    if len(lengths) == 3:
        return Space(lengths, (False, False, False), 0.0)
    return Space(lengths, (False, False), 0.0)
