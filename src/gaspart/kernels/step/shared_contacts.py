"""Contacts of a step shared among threads, with the same bits as with one thread.

Contacts without a common particle may be resolved in any order. So each thread resolves, in order, the
contacts between two of its own slots. Contacts between slots of two threads are postponed. Later contacts of
their particles are also postponed, and so on. Postponed contacts are resolved afterwards in order. The terms
of sums are stored per contact, and added in the order of all contacts.
"""

from typing import NamedTuple

import numpy as np
from numba import prange

from gaspart.kernels.compile.policy import (
    inner_allocating_kernel,
    inner_helper,
    inner_kernel,
    inner_parallel_kernel,
)
from gaspart.kernels.model import Space
from gaspart.kernels.physics.running_sum import add
from gaspart.kernels.step.boundaries import own_impulses
from gaspart.kernels.step.model import StepModel, StepParticles, StepTally, part_of
from gaspart.kernels.step.resolve import fetch_ahead, resolve, resolve_all


class Contacts(NamedTuple):
    """Contacts of a pass."""

    pairs: np.ndarray
    order: np.ndarray
    terms: np.ndarray
    postponed: np.ndarray
    counts: np.ndarray
    extremes: np.ndarray
    bounds: np.ndarray


@inner_helper
def is_among(slot, slots):
    """Return True if a slot is between slots[0] and slots[1]."""
    return slots[0] <= slot < slots[1]


@inner_kernel
def select_own(contacts, slots, held, own):
    """Select the contacts between two slots of one thread, in order; return their number. Particles in
    contact with a particle of another thread are marked in `held`.
    """
    number = 0
    for contact in contacts.order:
        i, j = contacts.pairs[contact, 0], contacts.pairs[contact, 1]
        if is_among(i, slots) and is_among(j, slots):
            own[number] = contact
            number += 1
        elif is_among(i, slots):
            held[i] = True
        elif is_among(j, slots):
            held[j] = True
    return number


@inner_helper
def tally_of_contact(tally, terms):
    """Return a tally whose sums are the terms (..., 2) of one contact. This function is for kernels that
    create no arrays, because it does not count references.
    """
    return StepTally(
        tally.counts, terms, tally.extremes, tally.wall_hits, tally.wall_impulse, tally.wall_loss,
        tally.momentum, tally.energy, tally.impulses, tally.axis, tally.pull, tally.per_length, tally.turns,
        tally.row, None, None, None, tally.fixed,
    )  # fmt: skip


@inner_kernel
def resolve_own(particles, contacts, own, model, step, tally, cells):
    """Resolve one thread's contacts in order; if a particle is held, hold both instead."""
    pairs, held = contacts.pairs, cells.held
    for n in range(len(own)):
        fetch_ahead(particles, pairs, own, n, cells)
        contact = own[n]
        i, j = pairs[contact, 0], pairs[contact, 1]
        if held[i] or held[j]:
            held[i] = held[j] = True
        else:
            contacts.postponed[contact] = False
            its_tally = tally_of_contact(tally, contacts.terms[contact])
            resolve(particles, i, j, model, step, its_tally, None, cells)


@inner_kernel
def resolve_postponed(particles, contacts, model, step, tally, cells):
    """Resolve the postponed contacts, release their particles, and add the terms of all contacts."""
    for contact in contacts.order:
        terms = contacts.terms[contact]
        if contacts.postponed[contact]:
            i, j = contacts.pairs[contact, 0], contacts.pairs[contact, 1]
            cells.held[i] = cells.held[j] = False
            resolve(particles, i, j, model, step, tally_of_contact(tally, terms), None, cells)
        for n in range(len(terms)):
            add(tally.sums, n, terms[n, 0])


@inner_allocating_kernel
def resolve_part(particles, part, contacts, model, step, tally, cells):
    """Resolve the contacts of one thread. The thread writes its counts, extremes and bounds only at the end,
    because threads that write to one cache line wait for each other.
    """
    own = np.empty(len(contacts.order), np.uint32)
    slots = part_of(part, len(cells.listed), particles.positions.shape[1])
    number = select_own(contacts, slots, cells.held, own)
    counts, extremes, bounds = np.zeros_like(tally.counts), tally.extremes.copy(), particles.bounds.copy()
    particles = StepParticles(
        particles.positions, particles.velocities, particles.images, particles.radii, particles.index,
        particles.masses, particles.last_pass, bounds, particles.ordinary,
    )  # fmt: skip
    tally = StepTally(
        counts, tally.sums, extremes, tally.wall_hits, tally.wall_impulse, tally.wall_loss, tally.momentum,
        tally.energy, own_impulses(tally.impulses, part), tally.axis, tally.pull, tally.per_length,
        tally.turns, tally.row, None, None, None, tally.fixed,
    )  # fmt: skip
    resolve_own(particles, contacts, own[:number], model, step, tally, cells)
    contacts.counts[part], contacts.extremes[part], contacts.bounds[part] = counts, extremes, bounds


@inner_parallel_kernel
def resolve_parts(particles, contacts, lengths, periodic, numbers, step, tally, cells):
    """Perform `resolve_part` for all parts. `numbers`: numbers of the model, and the margin of its space."""
    for part in prange(len(cells.listed)):
        normal, impulse_share, inset, margin = numbers
        model = StepModel(Space(lengths, periodic, margin), normal, impulse_share, inset, None, None, None)
        resolve_part(particles, part, contacts, model, step, tally, cells)


@inner_allocating_kernel
def resolve_shared(particles, ordered_pairs, model, step, tally, cells):
    """Perform `resolve_all` with several threads. `ordered_pairs`: pairs and their order."""
    (pairs, order), threads, space = ordered_pairs, len(cells.listed), model.space
    contacts = Contacts(
        pairs,
        order,
        np.zeros((len(order), len(tally.sums), 2)),
        np.ones(len(order), np.bool_),
        np.empty((threads, len(tally.counts)), np.int64),
        np.empty((threads, len(tally.extremes))),
        np.empty((threads, len(particles.bounds)), particles.bounds.dtype),
    )
    numbers = model.normal, model.impulse_share, model.inset, space.margin
    resolve_parts(particles, contacts, space.lengths, space.periodic, numbers, step, tally, cells)
    for part in range(threads):
        tally.counts[:] += contacts.counts[part]
        tally.extremes[:] = np.maximum(tally.extremes, contacts.extremes[part])
        particles.bounds[:] = np.maximum(particles.bounds, contacts.bounds[part])
    resolve_postponed(particles, contacts, model, step, tally, cells)


@inner_allocating_kernel
def resolve_found(particles, ordered_pairs, model, step, tally, threads, law, cells):
    """Resolve the pairs of one search, in their order. The work is shared among threads if there are several
    threads and a neighbour list, and if contacts are smooth.
    """
    if law is None:
        if cells is not None:
            if threads is not None:
                resolve_shared(particles, ordered_pairs, model, step, tally, cells)
                return
    resolve_all(particles, ordered_pairs[0], ordered_pairs[1], model, step, tally, law, cells)
