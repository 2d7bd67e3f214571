"""Collisions of a dense gas, between particles at a distance of one diameter.

The collision rate is multiplied by the contact value at the local density. The scheme is by Montanero &
Santos, Phys. Rev. E 54, 438 (1996), and Phys. Fluids 9, 2057 (1997), for the Enskog equation. A particle
draws a unit vector e. Its partner is drawn in the cell that contains the point one diameter away along e.
They collide with an impulse along e, at a rate proportional to their speed of approach along e. Each
collision conserves momentum and energy, and transfers both over a diameter. Trial collisions follow one
another as in `boltzmann`, cell by cell. The bound of a cell is computed from the largest number of particles
and the highest speeds in any cell within reach. A collision that exceeds a bound raises it.

Half of the collisions of a step come before the flight and half after it, where cells follow in the opposite
order. So a step is symmetric in time. If cells followed in the same order in all steps, energy would flow
along it. If all collisions came after the flight, samples would show velocities after the kicks that balance
gravity and the gradient of the pressure.

A trial in a cell changes particles up to a distance `reach` away, so threads cannot work on arbitrary cells.
Therefore the cells are divided into an even number of slabs along one axis, each at least two reaches wide. A
trial in one slab changes no particle within reach of the next slab but one. First all even slabs are
processed at the same time, then all odd ones. Within a slab, cells are processed one after another. This
order is the same for any number of threads. If a speed increases, a trial updates the bounds of its own slab
at once. The bounds of the other slabs are computed again before their trials begin.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.dsmc.boltzmann import (
    add_contact,
    collide_loaded_pair,
    collide_smooth,
    finish_cell,
    in_plane,
    load_particle,
    note_pair,
    store_particle,
    unit_vector,
)
from gaspart.kernels.dsmc.cells import accessible_part
from gaspart.kernels.dsmc.model import (
    COLLISIONS,
    EXCEEDED,
    TRIALS,
    below,
    fraction,
    kind_in,
    position_row,
    velocity_row,
    waiting_time,
    words_of,
)
from gaspart.kernels.physics.exact_sum import add_exact

FILLED, SURFACE = range(2)
KIND_BLOCK = 255  # block of random words of a trial for the kind of the partner
_FULLEST = 0.7  # largest packing fraction at which contact values are evaluated
_ROUNDED = 1.0 + 1e-12  # probability above 1 by more than rounding


class Dense(NamedTuple):
    """Local density, bounds and slabs of the cells of a dense gas."""

    fields: np.ndarray
    speed: np.ndarray
    near_speed: np.ndarray
    near_count: np.ndarray
    room: np.ndarray
    reach: np.ndarray
    wraps: np.ndarray
    axis: int
    slabs: np.ndarray
    drift: np.ndarray
    ball: float
    weight: float
    slope: float
    bend: float
    highest: np.ndarray
    least_part: float | None
    half: np.ndarray


@inner_helper
def contact_value(filled, surface, radius, dense):
    """Return the contact value of the pair distribution, 1/f + slope X/f^2 + bend X^2/f^3. Here f = 1 -
    filled and X = 2 surface `radius`; `radius` is the product of two radii divided by their sum. See
    `theory.discretisation`.
    """
    free = 1.0 - min(filled, _FULLEST)
    ratio = 2.0 * surface * radius / free
    return (1.0 + ratio * (dense.slope + dense.bend * ratio)) / free


@inner_kernel
def sliding_maximum(values, room, reach, stride, per_side, wraps):
    """Replace values by the maximum within reach along one axis; `room` is workspace."""
    number = len(values)
    for n in range(number):
        room[n] = values[n]
    span = min(2 * reach + 1, per_side)
    for n in range(number):
        at = n // stride % per_side
        line = n - at * stride
        most = values[n]
        for k in range(span):
            other = at - reach + k
            if wraps:
                other = (other + per_side) % per_side if span < per_side else k
            elif span == per_side:
                other = k
            if 0 <= other < per_side:
                most = max(most, room[line + other * stride])
        values[n] = most


@inner_kernel
def look_at_cells(particles, cells, grid, workspace, dense):
    """Find highest speed and number of particles in cells[0] to cells[1]. The fields of these cells are
    smoothed after a flight if the weight is positive.
    """
    d = len(particles.images)
    if dense.half[0] == 1 and dense.weight > 0.0:
        smooth(particles, cells, grid, workspace, dense)
    for cell in range(cells[0], cells[1]):
        first, end = np.int64(grid.starts[cell]), np.int64(grid.starts[cell + 1])
        most = 0.0
        for slot in range(first, end):
            square = 0.0
            for k in range(d):
                v = particles.data[velocity_row(particles, k), slot] - dense.drift[k]
                square += v * v
            most = max(most, square)
        dense.speed[cell] = sqrt(most)
        dense.near_count[cell] = end - first


@inner_kernel
def find_bounds(grid, workspace, dense):
    """Compute the bounds for trials in each cell, after `look_at_cells`."""
    filled = surface = 0.0
    for cell in range(len(grid.starts) - 1):
        filled = max(filled, dense.fields[FILLED, cell])
        surface = max(surface, dense.fields[SURFACE, cell])
    dense.highest[0] = contact_value(filled, surface, 0.5 * workspace.largest, dense)
    for k in range(len(grid.per_side)):
        along = dense.reach[k], grid.strides[k], grid.per_side[k], dense.wraps[k]
        sliding_maximum(dense.near_count, dense.room, *along)
    find_near_speeds(grid, dense)


@inner_kernel
def find_near_speeds(grid, dense):
    """Compute, for each cell, the highest speed in any cell within reach."""
    for cell in range(len(grid.starts) - 1):
        dense.near_speed[cell] = dense.speed[cell]
    for k in range(len(grid.per_side)):
        along = dense.reach[k], grid.strides[k], grid.per_side[k], dense.wraps[k]
        sliding_maximum(dense.near_speed, dense.room, *along)


@inner_kernel
def smooth(particles, cells, grid, workspace, dense):
    """Update the smoothed fields of some cells with their present particles."""
    d = len(particles.images)
    factor = dense.ball / grid.volume
    for cell in range(cells[0], cells[1]):
        filled = surface = 0.0
        for slot in range(np.int64(grid.starts[cell]), np.int64(grid.starts[cell + 1])):
            radius = workspace.radius[kind_in(particles, slot, workspace)]
            power = radius if d == 2 else radius * radius
            filled += power * radius
            surface += power
        dense.fields[FILLED, cell] += dense.weight * (factor * filled - dense.fields[FILLED, cell])
        dense.fields[SURFACE, cell] += dense.weight * (factor * surface - dense.fields[SURFACE, cell])


@inner_helper
def cell_at(particles, slot, sigma, direction, grid, context, dense):
    """Return the cell at a distance from the particle in a slot; -1 outside."""
    cell, lengths = 0, context.space.lengths
    for k in range(len(lengths)):
        x = particles.data[position_row(particles, k), slot] + sigma * direction[k]
        if dense.wraps[k]:
            if x < 0.0:
                x += lengths[k]
            elif x >= lengths[k]:
                x -= lengths[k]
        along = (x - grid.origin[k]) * grid.inverse[k]
        if not 0.0 <= along < grid.per_side[k]:
            if not dense.wraps[k]:
                return -1
            along = min(max(along, 0.0), grid.per_side[k] - 1.0)
        cell += np.int64(along) * grid.strides[k]
    return cell


@inner_kernel
def raise_speed(cell, slab, speed, grid, dense):
    """Store a higher speed of a cell, and update the cells of a slab within reach."""
    dense.speed[cell] = speed
    d = len(dense.reach)
    first, count = (0, 0, 0), (1, 1, 1)
    for k in range(d):
        span = min(2 * dense.reach[k] + 1, grid.per_side[k])
        at = cell // grid.strides[k] % grid.per_side[k]
        low = at - dense.reach[k] if span < grid.per_side[k] else 0
        first = first[1], first[2], low
        count = count[1], count[2], span
    for n in range(count[0] * count[1] * count[2]):
        coordinates = (
            first[0] + n // (count[1] * count[2]),
            first[1] + n // count[2] % count[1],
            first[2] + n % count[2],
        )
        near_cell, inside = 0, True
        for k in range(d):
            at = coordinates[3 - d + k]
            if dense.wraps[k]:
                at = (at + grid.per_side[k]) % grid.per_side[k]
            inside &= (at >= 0) & (at < grid.per_side[k])
            if k == dense.axis:
                inside &= (at >= dense.slabs[slab]) & (at < dense.slabs[slab + 1])
            near_cell += at * grid.strides[k]
        if inside:
            dense.near_speed[near_cell] = max(dense.near_speed[near_cell], speed)


@inner_helper
def note_speed(particles, slot, cell, slab, grid, dense):
    """Update the bounds of a slab after a change of a particle's velocity."""
    square = 0.0
    for k in range(len(particles.images)):
        v = particles.data[velocity_row(particles, k), slot] - dense.drift[k]
        square += v * v
    if square > dense.speed[cell] * dense.speed[cell]:
        raise_speed(cell, slab, sqrt(square), grid, dense)


@inner_helper
def collide_at(particles, pair, kinds, direction, sigma, context, law, stress):
    """Apply a collision along a direction to two particles, and count |r . dp|. `pair`: slots of the
    particles. `kinds`: kinds of the particles.
    """
    workspace = context.workspace
    if stress is not None:
        note_pair(particles, pair, context, stress, law)
    if law is None:
        passed = collide_smooth(
            particles, pair, direction, (workspace.mass[kinds[0]], workspace.mass[kinds[1]])
        )
    else:
        load_particle(particles, pair[0], 0, kinds[0], context, law)
        load_particle(particles, pair[1], 1, kinds[1], context, law)
        passed = collide_loaded_pair(direction, context, law)
        store_particle(particles, pair[0], 0, context, law)
        store_particle(particles, pair[1], 1, context, law)
    if stress is not None:
        apart = -sigma * direction[0], -sigma * direction[1], -sigma * direction[2]
        add_contact(particles, pair, apart, context, stress, law)
    add_exact(workspace.virial[context.part], sigma * passed)


@inner_helper
def approach_along(particles, pair, direction):
    """Return the speed at which two particles approach along a direction from the first to the second."""
    approach = 0.0
    for k in range(len(particles.images)):
        row = velocity_row(particles, k)
        approach -= (particles.data[row, pair[1]] - particles.data[row, pair[0]]) * direction[k]
    return approach


@inner_helper
def partner_of(particles, slot, sigma, direction, pick, grid, context, dense):
    """Return slot and cell of the partner drawn for a particle, or -1."""
    cell = cell_at(particles, slot, sigma, direction, grid, context, dense)
    if cell < 0:
        return np.int64(-1), np.int64(-1)
    partner = np.int64(grid.starts[cell]) + pick
    if partner >= np.int64(grid.starts[cell + 1]) or partner == slot:
        return np.int64(-1), np.int64(-1)
    return partner, np.int64(cell)


@inner_helper
def relative_chance(pair, cells, kinds, largest, dense, workspace, dimension):
    """Return the size and density factor of the collision probability, divided by its maximum."""
    first, second = workspace.radius[kinds[0]], workspace.radius[kinds[1]]
    size = (first + second) / (2.0 * workspace.largest)
    filled = 0.5 * (dense.fields[FILLED, cells[0]] + dense.fields[FILLED, cells[1]])
    surface = 0.5 * (dense.fields[SURFACE, cells[0]] + dense.fields[SURFACE, cells[1]])
    contact = contact_value(filled, surface, first * second / (first + second), dense) / largest
    return contact * (size if dimension == 2 else size * size)


@inner_helper
def weight_of_partner(particles, slot, partner, cell, grid, context, dense, least_part):
    """Return the collision probability relative to its maximum if sizes differ between walls, otherwise 1.
    The grid covers what the smallest particles can reach. The weight is 0 for a partner that cannot be where
    the contact direction puts it. It is larger in a cell of which the partners can reach only a part, because
    this part contains all of them. `partner`: radius of the partner, contact distance and contact direction.
    `cell`: cell of the partner. `least_part`: see `Dense`.
    """
    if least_part is None:
        return 1.0
    (radius, sigma, direction), workspace = partner, context.workspace
    gap = (radius - workspace.radius[0]) * workspace.margin
    for k in range(len(context.space.lengths)):
        along = particles.data[position_row(particles, k), slot] + sigma * direction[k] - grid.origin[k]
        along, low = along * grid.inverse[k], gap * grid.inverse[k]
        if not dense.wraps[k] and not low <= along <= grid.per_side[k] - low:
            return 0.0
    return least_part / max(accessible_part(cell, radius, dense.wraps, grid, workspace), least_part)


@inner_helper
def increase(rate, least_part):
    """Return a rate of trials for the largest `weight_of_partner`."""
    return rate if least_part is None else rate / least_part


@inner_helper
def try_once(particles, counter, words, bound, grid, context, dense, options):
    """Perform one trial; return whether it is a collision, and whether its probability exceeded 1. `counter`:
    key, step, cell and trial. `options`: the law, the sums of the stress, the slab, and `least_part`, see
    `Dense`.
    """
    key, step, cell, trial = counter
    law, stress, slab, least_part = options
    workspace, d = context.workspace, len(context.space.lengths)
    first = np.int64(grid.starts[cell])
    i = first + below(words[1], np.int64(grid.starts[cell + 1]) - first)
    kind, other_kind = kind_in(particles, i, workspace), np.int64(0)
    if len(workspace.radius) > 1:
        extra = words_of(key, step, cell, trial, KIND_BLOCK)
        other_kind = below(extra[0], len(workspace.radius))
    direction = in_plane(key, step, cell, trial) if d == 2 else unit_vector(key, step, cell, trial)
    radii = workspace.radius[kind], workspace.radius[other_kind]
    sigma = radii[0] + radii[1]
    pick = below(words[2], np.int64(dense.near_count[cell]))
    j, there = partner_of(particles, i, sigma, direction, pick, grid, context, dense)
    if j < 0:
        return False, False
    if kind_in(particles, j, workspace) != other_kind:
        return False, False
    pair, kinds = (i, j), (kind, other_kind)
    approach = approach_along(particles, pair, direction)
    chance = relative_chance(pair, (cell, there), kinds, dense.highest[0], dense, workspace, d)
    partner = radii[1], sigma, direction
    chance *= weight_of_partner(particles, i, partner, there, grid, context, dense, least_part)
    exceeded = approach * chance > bound * _ROUNDED
    if fraction(words[3]) * bound < approach * chance:
        collide_at(particles, pair, kinds, direction, sigma, context, law, stress)
        note_speed(particles, i, cell, slab, grid, dense)
        note_speed(particles, j, there, slab, grid, dense)
        return True, exceeded
    return False, exceeded


@inner_helper
def collide_dense_cell(particles, cell, rate, grid, context, dense, options):
    """Perform the collisions of half a step in a cell. `rate`: rate of trials divided by three factors: the
    number of particles in the cell, the largest number of particles in a cell within reach, and the bound of
    the speed. `options`: the options of `try_once`.
    """
    workspace = context.workspace
    counts, key, step = workspace.counts[context.part], workspace.key, 2 * workspace.clock[0] + dense.half[0]
    number = np.int64(grid.starts[cell + 1]) - np.int64(grid.starts[cell])
    pairs = rate * number * dense.near_count[cell]
    remaining, trial = 1.0 if number > 0 else 0.0, 0
    while remaining > 0.0:
        words = words_of(key, step, cell, trial, 0)
        bound = dense.speed[cell] + dense.near_speed[cell]
        remaining -= waiting_time(words[0]) / (pairs * bound)
        if not remaining > 0.0:
            break
        counter = key, step, cell, trial
        done, beyond = try_once(particles, counter, words, bound, grid, context, dense, options)
        counts[COLLISIONS] += done
        counts[EXCEEDED] += beyond
        trial += 1
    counts[TRIALS] += trial


@inner_kernel
def collide_slab(particles, slab, grid, context, dense, law, stress):
    """Perform the collisions of half a step in a slab, cell after cell, of the second `half` in the opposite
    order.
    """
    workspace, d = context.workspace, len(context.space.lengths)
    sigma = 2.0 * workspace.largest
    around = 6.283185307179586 * (sigma if d == 2 else 2.0 * sigma * sigma)
    rate = 0.5 * around * dense.highest[0] / grid.volume * 0.5 * workspace.dt * len(workspace.radius)
    rate = increase(rate, dense.least_part)
    options = law, stress, slab, dense.least_part
    stride = grid.strides[dense.axis]
    row = stride * grid.per_side[dense.axis]
    first, width = dense.slabs[slab] * stride, (dense.slabs[slab + 1] - dense.slabs[slab]) * stride
    number = (len(grid.starts) - 1) // row * width
    for n in range(number):
        at = number - 1 - n if dense.half[0] == 1 else n
        cell = at // width * row + first + at % width
        collide_dense_cell(particles, cell, rate, grid, context, dense, options)
        if stress is not None:
            finish_cell(context, stress)
