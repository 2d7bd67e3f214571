"""Time integrals of the stress tensor and of the heat flux (Helfand, Phys. Rev. 119, 1 (1960)).

The stress sum S (d, d) grows by m v v dt while particles fly, and by r dp at a collision, with r the vector
from the second particle to the first and dp what that gains. The heat sum Q (d,) grows by E v dt and by r
times half of the difference of what the two particles gain in energy E, which with spins includes that of
rotation. Velocities v are about that of the centre of mass, which is conserved, so that a gas that moves as a
whole has the sums of one at rest. A particle's velocity is constant in a step without walls and pull, so
nothing is approximated. The collisions' part of S is summed by itself too.

The sums of a cell are made by one thread and added exactly, so that they do not depend on threads.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.dsmc.model import kind_in, number_at, velocity_row
from gaspart.kernels.physics.exact_sum import add_exact


class Stress(NamedTuple):
    """By thread: sums (threads, 2 d^2 + d, WIDTH), those of S, by rows, of its part from collisions, and of
    Q; cell (threads, 2 d^2 + d), what the present cell adds; before (threads, 2, d + 1), velocity and energy
    of two particles before they collide. drift (d,): the velocity of the centre of mass."""

    sums: np.ndarray
    cell: np.ndarray
    before: np.ndarray
    drift: np.ndarray


@inner_helper
def velocity_about(particles, slot, axis, stress):
    """A component of the velocity of the particle in a slot about that of the centre of mass."""
    return particles.data[velocity_row(particles, axis), slot] - stress.drift[axis]


@inner_helper
def energy_of(particles, slot, context, stress, law):
    """The kinetic energy of the particle in a slot, likewise."""
    workspace = context.workspace
    kind = kind_in(particles, slot, workspace)
    square = 0.0
    for k in range(len(context.space.lengths)):
        v = velocity_about(particles, slot, k, stress)
        square += v * v
    energy = 0.5 * workspace.mass[kind] * square
    if law is not None:
        spin, number = 0.0, number_at(particles, slot)
        for k in range(3):
            spin += law.spins[number, k] * law.spins[number, k]
        if spin > 0.0:  # the moment of inertia of smooth particles may be infinite
            energy += 0.5 * workspace.inertia[kind] * spin
    return energy


@inner_helper
def add_flight(particles, slot, context, stress, law):
    """Add what the particle in a slot carries in a step."""
    d, workspace, cell = len(context.space.lengths), context.workspace, stress.cell[context.part]
    mass = workspace.mass[kind_in(particles, slot, workspace)]
    energy = energy_of(particles, slot, context, stress, law)
    for k in range(d):
        way = velocity_about(particles, slot, k, stress) * workspace.dt
        cell[2 * d * d + k] += energy * way
        for n in range(d):
            cell[d * k + n] += way * mass * velocity_about(particles, slot, n, stress)


@inner_helper
def finish_cell(context, stress):
    """Move the sums of the present cell to those of its thread."""
    cell, sums = stress.cell[context.part], stress.sums[context.part]
    for n in range(len(cell)):
        add_exact(sums[n], cell[n])
        cell[n] = 0.0


@inner_kernel
def add_flights(particles, cells, grid, context, stress, law):
    """Add what the particles of some cells, from cells[0] to cells[1], carry in a step."""
    for cell in range(cells[0], cells[1]):
        for slot in range(np.int64(grid.starts[cell]), np.int64(grid.starts[cell + 1])):
            add_flight(particles, slot, context, stress, law)
        finish_cell(context, stress)


@inner_helper
def note_pair(particles, pair, context, stress, law):
    """Keep velocities and energies of the particles in two slots, which are to collide."""
    before, d = stress.before[context.part], len(context.space.lengths)
    for n in range(2):
        for k in range(d):
            before[n, k] = velocity_about(particles, pair[n], k, stress)
        before[n, d] = energy_of(particles, pair[n], context, stress, law)


@inner_helper
def add_contact(particles, pair, apart, context, stress, law):
    """Add what has passed between the particles in two slots since `note_pair`. apart (3,): the vector from
    the second to the first."""
    before, cell = stress.before[context.part], stress.cell[context.part]
    d, workspace = len(context.space.lengths), context.workspace
    mass = workspace.mass[kind_in(particles, pair[0], workspace)]
    first = energy_of(particles, pair[0], context, stress, law) - before[0, d]
    second = energy_of(particles, pair[1], context, stress, law) - before[1, d]
    for n in range(d):
        gained = mass * (velocity_about(particles, pair[0], n, stress) - before[0, n])
        cell[2 * d * d + n] += apart[n] * 0.5 * (first - second)
        for k in range(d):
            cell[d * k + n] += apart[k] * gained
            cell[d * d + d * k + n] += apart[k] * gained
