"""Open faces: a particle that comes to one leaves the container, and its number is vacant.

A particle that enters takes the lowest vacant number: vacant numbers are counted in blocks, so that the
search for it is short, and its result depends on nothing but which particles are inside.
"""

from math import nan

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import NONE
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add

NUMBERS = 256
"""Numbers of particles in a block of `Open.vacant`."""


@inner_kernel
def leave(flights, i, face, model, tally, law, opened):
    """Take a particle away, with its energy, and the momentum that it carries through the face."""
    axis, square = face // 2, 0.0
    mass = mass_of(i, model.masses, law)
    add(tally.wall_impulse, face, mass * abs(flights[i].velocity[axis]))
    for k in range(len(model.space.lengths)):
        square += flights[i].velocity[k] * flights[i].velocity[k]
        flights[i].position[k] = nan
        flights[i].velocity[k] = 0.0
    add(tally.wall_energy, face, 0.5 * mass * square)
    opened.present[i] = 0
    opened.vacant[i // NUMBERS] += 1


@inner_helper
def collide_open(flights, i, face, model, tally, law, opened):
    """Let a particle leave, where a face may be open."""
    if opened is not None:
        leave(flights, i, face, model, tally, law, opened)


@inner_kernel
def lowest_vacant(opened):
    """Return the lowest number that no particle inside has, or NONE."""
    for block in range(len(opened.vacant)):
        if opened.vacant[block] > 0:
            for i in range(block * NUMBERS, min((block + 1) * NUMBERS, len(opened.present))):
                if not opened.present[i]:
                    return i
    return NONE


@inner_kernel
def occupy(opened, i, face):
    """Count a particle that has entered through a face as present."""
    opened.present[i] = 1
    opened.vacant[i // NUMBERS] -= 1
    opened.entries[face] += 1
