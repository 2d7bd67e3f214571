"""Impulses by the place where a particle receives them, along one axis (`kernels.physics.planes`), in steps.

Between two impulses a particle flies freely here too, for a time that may be negative: a contact is where the
pair is rewound to, a reflection at the face. So positions change by flights alone, and what these carry
through planes follows from the impulses, to rounding, whatever the step.
"""

import numpy as np

from gaspart.kernels.compile.policy import inner_helper
from gaspart.kernels.physics.planes import bin_at, row_of
from gaspart.kernels.physics.running_sum import add_whole


@inner_helper
def place_and_speed(particles, slot, ago, tally, impulses):
    """Where a particle was on its present flight at a time `ago` (negative) before the end of the step, along
    the axis, and its velocity at that end; 0 and 0 if no impulses are tallied."""
    if impulses is not None:
        v = np.float64(particles.velocities[tally.axis, slot])
        return particles.positions[tally.axis, slot] + ago * (v + 0.5 * tally.pull * ago), v
    return 0.0, 0.0


@inner_helper
def add_impulse(particles, slot, place, change, tally, thread, impulses):
    """Add the impulse that has changed the velocity of a particle along the axis, at a place."""
    if impulses is not None:
        if change != 0.0:
            bins, number = impulses.shape[2] - 1, particles.index[slot]
            place *= tally.per_length
            place -= np.floor(place * tally.turns) * bins
            bin_, part = bin_at(place, bins)
            row = row_of(number, tally.row)
            impulse = np.float64(particles.masses[number]) * change
            upper = impulse * part
            add_whole(impulses[thread, row, bin_], impulse - upper, tally.momentum)
            add_whole(impulses[thread, row, bin_ + 1], upper, tally.momentum)


@inner_helper
def add_contact(particles, slot, before, tally, impulses):
    """Add the impulse of a contact. before: what `place_and_speed` gave then."""
    if impulses is not None:
        place, speed = before
        change = particles.velocities[tally.axis, slot] - speed
        add_impulse(particles, slot, place, change, tally, 0, impulses)


@inner_helper
def add_reflection(particles, slot, axis, at, tally, thread, impulses):
    """Add the impulse of a face across an axis. at: its place, and the change of the velocity."""
    if impulses is not None:
        if axis == tally.axis:
            place, change = np.float64(at[0]), np.float64(at[1])
            add_impulse(particles, slot, place, change, tally, thread, impulses)


@inner_helper
def add_share(i, face, given, tally, thread, per_area):
    """Add the momentum and the heat that a particle gives to a face to the sums per accessible area."""
    if per_area is not None:
        share, (impulse, heat) = tally.share[tally.size[i], face], given
        add_whole(per_area[thread, face, 0], share * impulse, tally.momentum)
        add_whole(per_area[thread, face, 1], share * heat, tally.energy)


@inner_helper
def own_impulses(impulses, part):
    """The sums of one thread, as if there were no others."""
    if impulses is None:
        return None
    return impulses[part : part + 1]
