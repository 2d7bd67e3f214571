"""One sampled collision: the direction of contact, and what passes there.

Of two particles that meet somewhere in a cell, the unit vector n from the first to the second at their
contact has a density proportional to -g.n where that is positive, g being the relative velocity (second minus
first). In three dimensions this makes the relative velocity after an elastic collision isotropic; in two the
impact parameter is uniform.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper
from gaspart.kernels.dsmc.draws import fraction, words_of
from gaspart.kernels.dsmc.model import number_at, open_space, velocity_row
from gaspart.kernels.model import LOSS, ContactLaw
from gaspart.kernels.physics.collision import collide_by_law
from gaspart.kernels.physics.exact_sum import add_exact


class Sums(NamedTuple):
    """What the contact law of the event-driven engine adds to."""

    sums: np.ndarray


@inner_helper
def unit_vector(key, step, cell, trial):
    """(3,) an isotropic unit vector (Marsaglia, Ann. Math. Stat. 43, 645 (1972)), from blocks 1, 2 ... of
    the trial's random words."""
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
    """(3,) the same in the plane of the first two axes."""
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
    """A number from -1 to 1, from block 1 of the trial's random words."""
    words = words_of(key, step, cell, trial, 1)
    return 2.0 * fraction(words[0]) - 1.0


@inner_helper
def contact_vector(g, speed, dimension, counter):
    """(3,) the unit vector from the first particle to the second at a sampled contact. g (3,): the relative
    velocity, second minus first; speed: its size; counter: key, step, cell and trial."""
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
    """An elastic contact of smooth particles in two slots. normal (3,): the unit vector from the first to the
    second. Returns the momentum that passes."""
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
    """The law of the event-driven engine's physics, for the two particles in a thread's room."""
    workspace, part = context.workspace, context.part
    inverses = workspace.inverse_mass[part], workspace.inverse_inertia[part]
    return ContactLaw(
        law.normal, law.tangential, law.viscous, *inverses, workspace.pair_spins[part], None, None
    )


@inner_helper
def load_spin(i, place, which, context, law):
    """Write mass and spin of particle i, of a kind, into a place of a thread's room."""
    workspace, part = context.workspace, context.part
    workspace.inverse_mass[part, place] = 1.0 / workspace.mass[which]
    workspace.inverse_inertia[part, place] = 1.0 / workspace.inertia[which]
    for k in range(3):
        workspace.pair_spins[part, place, k] = law.spins[i, k]


@inner_helper
def store_spin(i, place, context, law):
    """Write the spin back from there."""
    for k in range(3):
        law.spins[i, k] = context.workspace.pair_spins[context.part, place, k]


@inner_helper
def load_particle(particles, slot, place, which, context, law):
    """Write the particle in a slot, of a kind, into a place of a thread's room."""
    flights = context.workspace.flights[context.part]
    for k in range(len(particles.images)):
        flights[place].velocity[k] = particles.data[velocity_row(particles, k), slot]
        flights[place].position[k] = 0.0
    flights[place].radius = context.workspace.radius[which]
    load_spin(number_at(particles, slot), place, which, context, law)


@inner_helper
def store_particle(particles, slot, place, context, law):
    """Write velocity and spin back from there."""
    flights = context.workspace.flights[context.part]
    for k in range(len(particles.images)):
        particles.data[velocity_row(particles, k), slot] = flights[place].velocity[k]
    store_spin(number_at(particles, slot), place, context, law)


@inner_helper
def count_loss(context):
    """Move the energy that the law has taken from the thread's room to its tally."""
    workspace, sums = context.workspace, context.workspace.sums[context.part]
    add_exact(workspace.loss[context.part], sums[LOSS, 0] + sums[LOSS, 1])
    sums[LOSS, 0] = sums[LOSS, 1] = 0.0


@inner_helper
def collide_loaded_pair(normal, context, law):
    """A contact by the law of the two particles in a thread's room. Returns the momentum that passes along
    the normal."""
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
