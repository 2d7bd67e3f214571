"""Collisions of a dilute gas, between any two particles of a cell.

The majorant frequency scheme (Ivanov & Rogasinsky, Sov. J. Numer. Anal. Math. Modelling 3, 453 (1988)): the
collisions in a cell are a Markov process in continuous time. A pair collides at the rate S g / V, with the
cross-section S, the relative speed g and the cell volume V. Trial collisions happen at the rate of all pairs
with an upper bound of S g. They are accepted with the probability S g divided by the bound. The time to the
next trial has no memory, so the bound may change after each collision. The bound is exact at any time: the
velocities in a cell lie in a box, and no relative speed exceeds its diagonal.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.dsmc.cells import accessible_part
from gaspart.kernels.dsmc.model import (
    COLLISIONS,
    EXCEEDED,
    TRIALS,
    below,
    fraction,
    kind_in,
    number_at,
    open_space,
    position_row,
    velocity_row,
    waiting_time,
    words_of,
)
from gaspart.kernels.model import LOSS, ContactLaw
from gaspart.kernels.physics.collision import collide_by_law
from gaspart.kernels.physics.exact_sum import add_exact

# Sampling of a collision: the direction of contact, and the transferred momentum.
#
# Let n be the unit vector at contact from the first to the second of two particles that collide somewhere in
# a cell, and g their relative velocity (second minus first). The probability density of n is proportional to
# -g.n if this is positive. In three dimensions, the relative velocity after an elastic collision is then
# isotropic. In two dimensions, the impact parameter is uniform.


class Sums(NamedTuple):
    """Sums to which the collision law of the event-driven engine adds."""

    sums: np.ndarray


@inner_helper
def unit_vector(key, step, cell, trial):
    """Draw an isotropic unit vector (3,) from blocks 1, 2, ... of the trial (Marsaglia 1972)."""
    block = 0
    while True:
        block += 1
        words = words_of(key, step, cell, trial, block)
        for n in range(0, 4, 2):
            u, v = 2.0 * fraction(words[n]) - 1.0, 2.0 * fraction(words[n + 1]) - 1.0
            s = u * u + v * v
            if s < 1.0:
                root = 2.0 * sqrt(1.0 - s)
                return u * root, v * root, 1.0 - 2.0 * s


@inner_helper
def in_plane(key, step, cell, trial):
    """Draw an isotropic unit vector (3,) in the plane of the first two axes."""
    block = 0
    while True:
        block += 1
        words = words_of(key, step, cell, trial, block)
        for n in range(0, 4, 2):
            u, v = 2.0 * fraction(words[n]) - 1.0, 2.0 * fraction(words[n + 1]) - 1.0
            s = u * u + v * v
            if s < 1.0:
                return (u * u - v * v) / s, 2.0 * u * v / s, 0.0


@inner_helper
def impact_parameter(key, step, cell, trial):
    """Draw a number from -1 to 1 from block 1 of the trial's random words."""
    words = words_of(key, step, cell, trial, 1)
    return 2.0 * fraction(words[0]) - 1.0


@inner_helper
def contact_vector(g, speed, dimension, counter):
    """Draw the unit vector (3,) from the first to the second particle of a collision. `g`: (3,), relative
    velocity, second minus first. `speed`: magnitude of g. `counter`: key, step, cell and trial.
    """
    key, step, cell, trial = counter
    x, y, z = g[0] / speed, g[1] / speed, g[2] / speed
    if dimension == 2:
        sine = impact_parameter(key, step, cell, trial)
        cosine = sqrt(1.0 - sine * sine)
        return -cosine * x - sine * y, -cosine * y + sine * x, 0.0
    a, b, c = unit_vector(key, step, cell, trial)
    a, b, c = a - x, b - y, c - z
    size = sqrt(a * a + b * b + c * c)
    if size > 0.0:
        return a / size, b / size, c / size
    return -x, -y, -z


@inner_helper
def collide_smooth(particles, pair, normal, masses):
    """Apply an elastic collision to the smooth particles in two slots; return the transferred momentum.
    `normal`: (3,), unit vector from the first particle to the second.
    """
    i, j = pair
    total, approach = masses[0] + masses[1], 0.0
    for k in range(len(particles.images)):
        v = particles.data[velocity_row(particles, k)]
        approach -= (v[j] - v[i]) * normal[k]
    to_i, to_j = 2.0 * masses[1] / total * approach, 2.0 * masses[0] / total * approach
    for k in range(len(particles.images)):
        v = particles.data[velocity_row(particles, k)]
        v[i] -= to_i * normal[k]
        v[j] += to_j * normal[k]
    return masses[0] * to_i


@inner_helper
def law_of(context, law):
    """Return the collision law of the event-driven engine for the two particles in a thread's workspace."""
    workspace, part = context.workspace, context.part
    inverses = workspace.inverse_mass[part], workspace.inverse_inertia[part]
    return ContactLaw(
        law.normal, law.tangential, law.viscous, *inverses, workspace.pair_spins[part], None, None
    )


@inner_helper
def load_spin(i, row, which, context, law):
    """Write mass and spin of a particle to a row of a thread's workspace. `i`: number of the particle. `row`:
    row of the workspace. `which`: kind of the particle.
    """
    workspace, part = context.workspace, context.part
    workspace.inverse_mass[part, row] = 1.0 / workspace.mass[which]
    workspace.inverse_inertia[part, row] = 1.0 / workspace.inertia[which]
    for k in range(3):
        workspace.pair_spins[part, row, k] = law.spins[i, k]


@inner_helper
def store_spin(i, row, context, law):
    """Write the spin from the workspace back to the particle."""
    for k in range(3):
        law.spins[i, k] = context.workspace.pair_spins[context.part, row, k]


@inner_helper
def load_particle(particles, slot, row, which, context, law):
    """Write the particle in a slot to a row of a thread's workspace. `row`: row of the workspace. `which`:
    kind of the particle.
    """
    flights = context.workspace.flights[context.part]
    for k in range(len(particles.images)):
        flights[row].velocity[k] = particles.data[velocity_row(particles, k), slot]
        flights[row].position[k] = 0.0
    flights[row].radius = context.workspace.radius[which]
    load_spin(number_at(particles, slot), row, which, context, law)


@inner_helper
def store_particle(particles, slot, row, context, law):
    """Write velocity and spin from the workspace back to the particle."""
    flights = context.workspace.flights[context.part]
    for k in range(len(particles.images)):
        particles.data[velocity_row(particles, k), slot] = flights[row].velocity[k]
    store_spin(number_at(particles, slot), row, context, law)


@inner_helper
def count_loss(context):
    """Move the energy dissipated by the law from the thread's workspace to its tally."""
    workspace, sums = context.workspace, context.workspace.sums[context.part]
    add_exact(workspace.loss[context.part], sums[LOSS, 0] + sums[LOSS, 1])
    sums[LOSS, 0] = sums[LOSS, 1] = 0.0


@inner_helper
def collide_loaded_pair(normal, context, law):
    """Apply the collision law to the pair in a thread's workspace; return the normal momentum."""
    flights = context.workspace.flights[context.part]
    rr = rv = 0.0
    for k in range(len(context.space.lengths)):
        flights[1].position[k] = normal[k]
        rr += normal[k] * normal[k]
        rv += normal[k] * (flights[1].velocity[k] - flights[0].velocity[k])
    sums = Sums(context.workspace.sums[context.part])
    passed = collide_by_law(
        flights, 0, 1, rr, rv, open_space(context.space.lengths), sums, law_of(context, law)
    )
    count_loss(context)
    return passed


# Time integrals of the stress tensor and of the heat flux (Helfand, Phys. Rev. 119, 1 (1960)).
#
# The stress sum S (d, d) grows by m v v dt in flight, and by r dp at a collision. r is the vector from the
# second particle to the first, and dp the momentum gained by the first. The heat sum Q (d,) grows by E v dt
# in flight. At a collision it grows by r times half of the difference between the energy gains of the two
# particles. The energy E includes rotation if there are spins. Velocities v are relative to the centre of
# mass, whose velocity is conserved. So a gas that moves as a whole has the same sums as a gas at rest.
# Without walls and gravity the velocity of a particle is constant during the flight of a step, so the sums
# are exact. The collisional part of S is also summed separately.
#
# One thread computes the sums of a cell, and adds them exactly, so they do not depend on the number of
# threads.


class Stress(NamedTuple):
    """Sums of the stress tensor and of the heat flux, by thread."""

    sums: np.ndarray
    cell: np.ndarray
    before: np.ndarray
    drift: np.ndarray


@inner_helper
def velocity_about(particles, slot, axis, stress):
    """Return a velocity component of a particle relative to the centre of mass."""
    return particles.data[velocity_row(particles, axis), slot] - stress.drift[axis]


@inner_helper
def energy_of(particles, slot, context, stress, law):
    """Return the kinetic energy of the particle in a slot, relative to the centre of mass."""
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
    """Add the transport by the flight of the particle in a slot during a step."""
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
    """Add the sums of the present cell to the sums of its thread."""
    cell, sums = stress.cell[context.part], stress.sums[context.part]
    for n in range(len(cell)):
        add_exact(sums[n], cell[n])
        cell[n] = 0.0


@inner_kernel
def add_flights(particles, cells, grid, context, stress, law):
    """Add the transport by the flights of the particles in cells[0] to cells[1]."""
    for cell in range(cells[0], cells[1]):
        for slot in range(np.int64(grid.starts[cell]), np.int64(grid.starts[cell + 1])):
            add_flight(particles, slot, context, stress, law)
        finish_cell(context, stress)


@inner_helper
def note_pair(particles, pair, context, stress, law):
    """Store velocities and energies of the particles in two slots before their collision."""
    before, d = stress.before[context.part], len(context.space.lengths)
    for n in range(2):
        for k in range(d):
            before[n, k] = velocity_about(particles, pair[n], k, stress)
        before[n, d] = energy_of(particles, pair[n], context, stress, law)


@inner_helper
def add_contact(particles, pair, apart, context, stress, law):
    """Add the transfer between the particles in two slots since `note_pair`. `apart`: (3,), vector from the
    second particle to the first.
    """
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


_ROUNDED = 1.0 + 1e-12  # probability above 1 by more than rounding


@inner_helper
def cross_section(sigma, dimension):
    """Return the cross-section for a contact distance sigma: an area (3D) or a width (2D)."""
    return 3.141592653589793 * sigma * sigma if dimension == 3 else 2.0 * sigma


@inner_helper
def widen_range(x, y, low, high):
    """Extend a range so that it contains x and y."""
    return min(min(x, y), low), max(max(x, y), high)


@inner_helper
def bounds_of(u, v, w, first, end):
    """Return the ranges of three arrays in one loop, which takes as long as a loop over one of them."""
    low_u = high_u = u[first]
    low_v = high_v = v[first]
    low_w = high_w = w[first]
    for n in range(first + 1, end):
        low_u, high_u = min(u[n], low_u), max(u[n], high_u)
        low_v, high_v = min(v[n], low_v), max(v[n], high_v)
        low_w, high_w = min(w[n], low_w), max(w[n], high_w)
    return low_u, high_u, low_v, high_v, low_w, high_w


@inner_helper
def smallest_part(particles, cell, slots, grid, context):
    """Return the smallest `accessible_part` of a cell for any of its particles."""
    workspace, periodic, part = context.workspace, context.space.periodic, 1.0
    if len(workspace.kind) > 0 and accessible_part(cell, workspace.largest, periodic, grid, workspace) < 1.0:
        for slot in range(slots[0], slots[1]):
            radius = workspace.radius[kind_in(particles, slot, workspace)]
            part = min(part, accessible_part(cell, radius, periodic, grid, workspace))
    return part


@inner_helper
def section_of(particles, pair, cell, grid, context):
    """Return the cross-section of the particles in two slots, divided by the part of the cell for pairs. In a
    part of the cell that only the smaller particle reaches, there is no collision. So the collision rate is
    inversely proportional to the part that the smaller particle reaches.
    """
    d, kinds = len(context.space.lengths), context.workspace
    if len(kinds.kind) == 0:
        return cross_section(2.0 * kinds.largest, d)
    first = kinds.radius[kind_in(particles, pair[0], kinds)]
    second = kinds.radius[kind_in(particles, pair[1], kinds)]
    smaller = min(first, second)
    return cross_section(first + second, d) / accessible_part(
        cell, smaller, context.space.periodic, grid, kinds
    )


@inner_helper
def scatter_equal(particles, pair, g, square, counter):
    """Apply an elastic collision to spheres of equal mass: their relative velocity g (3,) becomes
    isotropic.
    """
    i, j = pair
    half = 0.5 * sqrt(square)
    direction = unit_vector(counter[0], counter[1], counter[2], counter[3])
    for k in range(3):
        v = particles.data[velocity_row(particles, k)]
        change = half * direction[k] - 0.5 * g[k]
        v[i] -= change
        v[j] += change


@inner_helper
def collide_pair(particles, pair, g, square, counter, context, law):
    """Apply a collision to the particles in two slots. `g`: (3,), relative velocity, second minus first.
    `counter`: key, step, cell and trial of the random numbers.
    """
    d, kinds = len(context.space.lengths), context.workspace
    if law is None:
        if d == 3 and len(kinds.kind) == 0:
            scatter_equal(particles, pair, g, square, counter)
            return
    normal = contact_vector(g, sqrt(square), d, counter)
    first, second = kind_in(particles, pair[0], kinds), kind_in(particles, pair[1], kinds)
    if law is None:
        collide_smooth(particles, pair, normal, (kinds.mass[first], kinds.mass[second]))
    else:
        load_particle(particles, pair[0], 0, first, context, law)
        load_particle(particles, pair[1], 1, second, context, law)
        collide_loaded_pair(normal, context, law)
        store_particle(particles, pair[0], 0, context, law)
        store_particle(particles, pair[1], 1, context, law)


@inner_helper
def separation_vector(particles, pair):
    """Return the vector (3,) from the second to the first particle in two slots."""
    x, y = particles.data[position_row(particles, 0)], particles.data[position_row(particles, 1)]
    z = particles.data[position_row(particles, len(particles.images) - 1)]
    i, j = pair
    return x[i] - x[j], y[i] - y[j], z[i] - z[j]


@inner_helper
def collide_cell(particles, cell, slots, grid, context, law, stress):
    """Perform the collisions of one step in a cell. The particles of the cell are in slots[0] to slots[1].
    For the stress of the algorithm, momentum is transferred between two points of the cell.
    """
    first, end = slots
    d, number, key, step = (
        len(context.space.lengths),
        end - first,
        context.workspace.key,
        context.workspace.clock[0],
    )
    u = particles.data[velocity_row(particles, 0)]
    v = particles.data[velocity_row(particles, 1)]
    w = particles.data[velocity_row(particles, d - 1)]
    low_u, high_u, low_v, high_v, low_w, high_w = bounds_of(u, v, w, first, end)
    flat = 0.0 if d == 2 else 1.0
    most = cross_section(2.0 * context.workspace.largest, d)
    most /= smallest_part(particles, cell, slots, grid, context)
    pairs = 0.5 * number * (number - 1.0) * most / grid.volume * context.workspace.dt
    bound, remaining, trial, met, exceeded = -1.0, 1.0, 0, 0, 0
    while True:
        if bound < 0.0:
            x, y, z = high_u - low_u, high_v - low_v, flat * (high_w - low_w)
            bound = sqrt(x * x + y * y + z * z)
        words = words_of(key, step, cell, trial, 0)
        remaining -= waiting_time(words[0]) / (pairs * bound)
        if not remaining > 0.0:
            break
        i, j = first + below(words[1], number), first + below(words[2], number - 1)
        j += j >= i
        g = u[j] - u[i], v[j] - v[i], flat * (w[j] - w[i])
        square = g[0] * g[0] + g[1] * g[1] + g[2] * g[2]
        share = section_of(particles, (i, j), cell, grid, context) / most
        threshold, offered = fraction(words[3]) * bound, square * share * share
        exceeded += offered > bound * bound * _ROUNDED
        if threshold * threshold < offered:
            if stress is not None:
                note_pair(particles, (i, j), context, stress, law)
            collide_pair(particles, (i, j), g, square, (key, step, cell, trial), context, law)
            if stress is not None:
                add_contact(particles, (i, j), separation_vector(particles, (i, j)), context, stress, law)
            met += 1
            low_u, high_u = widen_range(u[i], u[j], low_u, high_u)
            low_v, high_v = widen_range(v[i], v[j], low_v, high_v)
            low_w, high_w = widen_range(w[i], w[j], low_w, high_w)
            bound = -1.0
        trial += 1
    counts = context.workspace.counts[context.part]
    counts[COLLISIONS] += met
    counts[TRIALS] += trial
    counts[EXCEEDED] += exceeded
    if stress is not None:
        finish_cell(context, stress)


@inner_kernel
def collide_cells(particles, cells, grid, context, law, stress):
    """Perform the collisions of one step in the cells of one thread, cells[0] to cells[1]."""
    for cell in range(cells[0], cells[1]):
        slots = np.int64(grid.starts[cell]), np.int64(grid.starts[cell + 1])
        if slots[1] - slots[0] > 1:
            collide_cell(particles, cell, slots, grid, context, law, stress)
