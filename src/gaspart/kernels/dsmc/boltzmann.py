"""Collisions of a dilute gas: pairs of particles of one cell, wherever they are in it.

The majorant frequency scheme (Ivanov & Rogasinsky, Sov. J. Numer. Anal. Math. Modelling 3, 453 (1988)): the
collisions in a cell are a Markov process in continuous time, in which a pair collides at the rate S g / V,
with S the cross-section and g the relative speed. Trials happen at the rate of all pairs with a bound of S g
and are accepted with the ratio of the two. The time to the next trial has no memory, so that the bound
may change with each collision, and is exact at any time: the velocities of a cell lie in a box, and no
relative speed exceeds its diagonal.
"""

from math import sqrt

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.dsmc.contact import (
    collide_loaded_pair,
    collide_smooth,
    contact_vector,
    load_particle,
    store_particle,
    unit_vector,
)
from gaspart.kernels.dsmc.draws import below, fraction, waiting_time, words_of
from gaspart.kernels.dsmc.model import COLLISIONS, EXCEEDED, TRIALS, kind_in, position_row, velocity_row
from gaspart.kernels.dsmc.stress import add_contact, finish_cell, note_pair

_ROUNDED = 1.0 + 1e-12  # a chance above 1 by more than rounding


@inner_helper
def cross_section(sigma, dimension):
    """The area (3D) or width (2D) in which particles with the distance sigma at contact meet."""
    return 3.141592653589793 * sigma * sigma if dimension == 3 else 2.0 * sigma


@inner_helper
def widened(x, y, low, high):
    """A range that holds x and y as well."""
    return min(min(x, y), low), max(max(x, y), high)


@inner_helper
def bounds_of(u, v, w, first, end):
    """The ranges of three arrays, in one loop: a minimum waits for the one before."""
    low_u = high_u = u[first]
    low_v = high_v = v[first]
    low_w = high_w = w[first]
    for n in range(first + 1, end):
        low_u, high_u = min(u[n], low_u), max(u[n], high_u)
        low_v, high_v = min(v[n], low_v), max(v[n], high_v)
        low_w, high_w = min(w[n], low_w), max(w[n], high_w)
    return low_u, high_u, low_v, high_v, low_w, high_w


@inner_helper
def section_of(particles, pair, context):
    """The cross-section of the particles in two slots."""
    d, kinds = len(context.space.lengths), context.workspace
    if len(kinds.kind) == 0:
        return cross_section(2.0 * kinds.largest, d)
    one, other = kind_in(particles, pair[0], kinds), kind_in(particles, pair[1], kinds)
    return cross_section(kinds.radius[one] + kinds.radius[other], d)


@inner_helper
def scatter_equal(particles, pair, g, square, counter):
    """An elastic collision of spheres of equal mass: their relative velocity g (3,) becomes isotropic."""
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
    """Let the particles in two slots collide. g (3,): their relative velocity, second minus first; counter:
    of the random numbers."""
    d, kinds = len(context.space.lengths), context.workspace
    if law is None:
        if d == 3 and len(kinds.kind) == 0:
            scatter_equal(particles, pair, g, square, counter)
            return
    normal = contact_vector(g, sqrt(square), d, counter)
    one, other = kind_in(particles, pair[0], kinds), kind_in(particles, pair[1], kinds)
    if law is None:
        collide_smooth(particles, pair, normal, (kinds.mass[one], kinds.mass[other]))
    else:
        load_particle(particles, pair[0], 0, one, context, law)
        load_particle(particles, pair[1], 1, other, context, law)
        collide_loaded_pair(normal, context, law)
        store_particle(particles, pair[0], 0, context, law)
        store_particle(particles, pair[1], 1, context, law)


@inner_helper
def between(particles, pair):
    """(3,) the vector from the second to the first of the particles in two slots of a cell."""
    x, y = particles.data[position_row(particles, 0)], particles.data[position_row(particles, 1)]
    z = particles.data[position_row(particles, len(particles.images) - 1)]
    i, j = pair
    return x[i] - x[j], y[i] - y[j], z[i] - z[j]


@inner_helper
def collide_cell(particles, cell, slots, volume, context, law, stress):
    """Make the collisions of one step in a cell, whose particles are in the slots from slots[0] to
    slots[1]. The stress is that of the algorithm: what passes has passed between two places of the cell."""
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
    pairs = 0.5 * number * (number - 1.0) * most / volume * context.workspace.dt
    bound, left, trial, met, exceeded = -1.0, 1.0, 0, 0, 0
    while True:
        if bound < 0.0:
            x, y, z = high_u - low_u, high_v - low_v, flat * (high_w - low_w)
            bound = sqrt(x * x + y * y + z * z)
        words = words_of(key, step, cell, trial, 0)
        left -= waiting_time(words[0]) / (pairs * bound)
        if not left > 0.0:
            break
        i, j = first + below(words[1], number), first + below(words[2], number - 1)
        j += j >= i
        g = u[j] - u[i], v[j] - v[i], flat * (w[j] - w[i])
        square = g[0] * g[0] + g[1] * g[1] + g[2] * g[2]
        share = section_of(particles, (i, j), context) / most
        wanted, offered = fraction(words[3]) * bound, square * share * share
        exceeded += offered > bound * bound * _ROUNDED
        if wanted * wanted < offered:
            if stress is not None:
                note_pair(particles, (i, j), context, stress, law)
            collide_pair(particles, (i, j), g, square, (key, step, cell, trial), context, law)
            if stress is not None:
                add_contact(particles, (i, j), between(particles, (i, j)), context, stress, law)
            met += 1
            low_u, high_u = widened(u[i], u[j], low_u, high_u)
            low_v, high_v = widened(v[i], v[j], low_v, high_v)
            low_w, high_w = widened(w[i], w[j], low_w, high_w)
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
    """Make the collisions of one step in one thread's cells, from cells[0] to cells[1]."""
    for cell in range(cells[0], cells[1]):
        slots = np.int64(grid.starts[cell]), np.int64(grid.starts[cell + 1])
        if slots[1] - slots[0] > 1:
            collide_cell(particles, cell, slots, grid.volume, context, law, stress)
