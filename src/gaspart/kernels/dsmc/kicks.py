"""Random kicks of all particles at once: the stochastic thermostat of a driven granular gas."""

from math import sqrt

from gaspart.kernels.compile.policy import inner_helper, kernel
from gaspart.kernels.dsmc.model import kind_in, number_at, velocity_row
from gaspart.kernels.physics.rng import normal_pair
from gaspart.kernels.physics.running_sum import add


@inner_helper
def _energy(particles, slot, mass):
    square = 0.0
    for k in range(len(particles.images)):
        v = particles.data[velocity_row(particles, k), slot]
        square += v * v
    return 0.5 * mass * square


@inner_helper
def _kick(particles, slot, width, counter, mass, momentum):
    """Kick one particle, and add to `momentum` (3,) what it takes. counter: the key and the number of the
    kick."""
    key, number = counter
    i = number_at(particles, slot)
    one, other, block = normal_pair(key, i, number, 1)
    changes = one, other, 0.0
    if len(particles.images) == 3:
        third, _, _ = normal_pair(key, i, number, block)
        changes = one, other, third
    for k in range(len(particles.images)):
        particles.data[velocity_row(particles, k), slot] += width * changes[k]
    scale = mass * width
    x, y, z = momentum
    return x + scale * changes[0], y + scale * changes[1], z + scale * changes[2]


@kernel
def kick_all(particles, workspace, width, counter, given):
    """Kick all particles, with a width of `width` for mass 1, without changing the total momentum. counter:
    see `_kick`; given (1, 2): the energy that they have been given, see `running_sum.add`."""
    momentum, total = (0.0, 0.0, 0.0), 0.0
    for slot in range(particles.data.shape[1]):
        mass = workspace.mass[kind_in(particles, slot, workspace)]
        add(given, 0, -_energy(particles, slot, mass))
        momentum = _kick(particles, slot, width / sqrt(mass), counter, mass, momentum)
        total += mass
    for slot in range(particles.data.shape[1]):
        mass = workspace.mass[kind_in(particles, slot, workspace)]
        for k in range(len(particles.images)):
            particles.data[velocity_row(particles, k), slot] -= momentum[k] / total
        add(given, 0, _energy(particles, slot, mass))
