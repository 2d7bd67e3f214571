"""Momentum and heat given to faces by particles of several sizes, divided by accessible areas.

The accessible area of a face is the area that centres of particles of one size can reach. If all particles
have one size, no separate sums are needed, because the area is a single number.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add


class PerArea(NamedTuple):
    """Sums of the event-driven engine per accessible area."""

    inverse: np.ndarray
    size: np.ndarray
    sums: np.ndarray


@inner_helper
def velocity_before(flights, i, per_area):
    """Return the velocity (3,) of a particle, 0 along a third axis in 2D; zeros if nothing is summed."""
    if per_area is not None:
        velocity = flights[i].velocity
        return velocity[0], velocity[1], velocity[2] if len(velocity) == 3 else 0.0
    return 0.0, 0.0, 0.0


@inner_helper
def spin_energy(i, law):
    """Return the rotational energy of a particle; 0 for smooth particles."""
    if law is None:
        return 0.0
    if law.tangential > -1.0:
        square = law.spins[i, 0] * law.spins[i, 0] + law.spins[i, 1] * law.spins[i, 1]
        return 0.5 * (square + law.spins[i, 2] * law.spins[i, 2]) / law.inverse_inertia[i]
    return 0.0


@inner_helper
def spin_before(i, law, per_area):
    """Return the rotational energy of a particle if it is summed, otherwise 0."""
    if per_area is not None:
        return spin_energy(i, law)
    return 0.0


@inner_helper
def add_per_area(flights, i, face, before, model, per_area):
    """Add the momentum and energy that a face has received from a particle. `before`: velocity of the
    particle before the hit, and its rotational energy.
    """
    if per_area is not None:
        (velocity, spin), law = before, model.law
        mass, inverse = mass_of(i, model.masses, law), per_area.inverse[per_area.size[i], face]
        d, axis, side = len(model.space.lengths), face // 2, 1.0 if face % 2 else -1.0
        first, square = face * (d + 1), 0.0
        for k in range(d):
            after = flights[i].velocity[k]
            change = velocity[k] - after
            square += change * (velocity[k] + after)
            along = side if k == axis else 1.0
            add(per_area.sums, first + k, along * mass * change * inverse)
        lost = 0.5 * mass * square + (spin - spin_energy(i, law))
        add(per_area.sums, first + d, lost * inverse)
