"""Thermal walls: a particle leaves them with a velocity drawn from their temperature."""

from math import sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import THERMAL
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.rng import flux_speed, normal_pair
from gaspart.kernels.physics.running_sum import add


@inner_kernel
def collide_thermal(flights, i, face, model, tally, law, faces):
    """Give a particle the velocity of one that leaves a thermal wall."""
    d = len(model.space.lengths)
    axis = face // 2
    side = 1.0 if face % 2 else -1.0
    mass = mass_of(i, model.masses, law)
    number = faces.draws[i]
    faces.draws[i] = number + 1
    width = sqrt(faces.level[face] / mass)
    square = 0.0
    for k in range(d):
        square += flights[i].velocity[k] * flights[i].velocity[k]
    approach = side * flights[i].velocity[axis]
    away = width * flux_speed(faces.key, i, number)
    flights[i].velocity[axis] = -side * away
    add(tally.wall_impulse, face, mass * (approach + away))
    if faces.kind[face] == THERMAL:
        add_shear(flights, i, face, mass, faces.sliding)
        one, other, block = normal_pair(faces.key, i, number, 1)
        flights[i].velocity[(axis + 1) % d] = width * one
        if d == 3:
            flights[i].velocity[(axis + 2) % d] = width * other
        drag(flights, i, face, mass, faces.sliding)
        draw_spin(i, face, (number, block), d, tally, law, faces)
    for k in range(d):
        square -= flights[i].velocity[k] * flights[i].velocity[k]
    add(tally.wall_energy, face, 0.5 * mass * square)


@inner_helper
def add_shear(flights, i, face, mass, sliding):
    """Add a particle's momentum along a face to what that was given. mass: negative where the particle takes
    it."""
    if sliding is not None:
        d = sliding.velocity.shape[1]
        for k in range(d):
            if k != face // 2:
                add(sliding.shear, face * d + k, mass * flights[i].velocity[k])


@inner_helper
def drag(flights, i, face, mass, sliding):
    """Let a particle that leaves a face share its motion."""
    if sliding is not None:
        for k in range(sliding.velocity.shape[1]):
            flights[i].velocity[k] += sliding.velocity[face, k]
        add_shear(flights, i, face, -mass, sliding)


@inner_kernel
def draw_spin(i, face, counter, dimension, tally, law, faces):
    """The same for the spin of a rough particle, which has one component in 2D. counter: the draw's number
    and the first block of random words that it may use."""
    if law is None:
        return
    if law.tangential > -1.0:
        number, block = counter
        inertia = 1.0 / law.inverse_inertia[i]
        width = sqrt(faces.level[face] / inertia)
        for k in range(2 if dimension == 2 else 0, 3):
            one, _, block = normal_pair(faces.key, i, number, block)
            spin = width * one
            before = law.spins[i, k]
            add(tally.wall_energy, face, 0.5 * inertia * (before * before - spin * spin))
            law.spins[i, k] = spin
