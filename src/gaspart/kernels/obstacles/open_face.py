"""Open faces: a particle that comes to one leaves the container."""

from math import nan

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add


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


@inner_helper
def collide_open(flights, i, face, model, tally, law, opened):
    """The same where no face may be open."""
    if opened is not None:
        leave(flights, i, face, model, tally, law, opened)
