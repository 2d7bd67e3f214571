"""Random kicks of all particles at once: the stochastic thermostat of a driven granular gas."""

from math import inf, sqrt

from gaspart.kernels.compile.policy import inner_helper, kernel
from gaspart.kernels.obstacles.well import mass_of
from gaspart.kernels.physics.flight import advance
from gaspart.kernels.physics.rng import normal_pair
from gaspart.kernels.physics.running_sum import add


@inner_helper
def _energy(flights, i, mass, space):
    square = 0.0
    for k in range(len(space.lengths)):
        square += flights[i].velocity[k] * flights[i].velocity[k]
    return 0.5 * mass * square


@inner_helper
def _kick(flights, i, width, key, number, space):
    """Add normal random numbers of this width to the velocity components."""
    one, other, block = normal_pair(key, i, number, 1)
    flights[i].velocity[0] += width * one
    flights[i].velocity[1] += width * other
    if len(space.lengths) == 3:
        one, _, _ = normal_pair(key, i, number, block)
        flights[i].velocity[2] += width * one


@kernel
def kick_all(flights, time, width, counter, model, given):
    """Advance all particles to `time` and kick them, with a width of `width` for mass 1, without changing the
    total momentum. counter: the (2,) words of the key, and the number of the kick. given (1, 2): the energy
    that they have been given, see `running_sum.add`."""
    (key, number), space = counter, model.space
    total = px = py = pz = 0.0
    last = len(space.lengths) - 1
    for i in range(len(flights)):
        advance(flights, i, time, space, model.gravity)
        mass = mass_of(i, model.masses, model.law)
        if mass < inf:
            add(given, 0, -_energy(flights, i, mass, space))
            velocity = flights[i].velocity
            px, py = px - mass * velocity[0], py - mass * velocity[1]
            pz -= mass * velocity[last]
            _kick(flights, i, width / sqrt(mass), key, number, space)
            px, py = px + mass * velocity[0], py + mass * velocity[1]
            pz += mass * velocity[last]
            total += mass
    mean = px / total, py / total, pz / total
    for i in range(len(flights)):
        mass = mass_of(i, model.masses, model.law)
        if mass < inf:
            for k in range(len(space.lengths)):
                flights[i].velocity[k] -= mean[k]
            add(given, 0, _energy(flights, i, mass, space))
