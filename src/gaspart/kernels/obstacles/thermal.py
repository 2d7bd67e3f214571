"""Thermal walls: a particle leaves them with a velocity drawn from their temperature."""

from math import sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import NONE, THERMAL
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.rng import flux_speed, normal_pair, random_words, uniform
from gaspart.kernels.physics.running_sum import add


@inner_helper
def mirrors(i, face, number, key, accommodation):
    """Whether a face leaves a particle its velocity, mirrored, at the hit with this number (Maxwell's model):
    by a word of block 0, of which `flux_speed` takes another."""
    if accommodation is None:
        return False
    _, word, _, _ = random_words(key, i, number, 0)
    return uniform(word) >= accommodation[face]


@inner_helper
def temperature_at(face, position, lengths, level, ramp):
    """The temperature of a thermal face where a particle at this position (d,) hits it."""
    if ramp is None:
        return level[face]
    return _on_ramp(face, position, lengths, level[face], ramp)


@inner_helper
def _on_ramp(face, position, lengths, low, ramp):
    axis = ramp.axis[face]
    if axis == NONE:
        return low
    part = min(max(position[axis] / lengths[axis], 0.0), 1.0)
    return (1.0 - part) * low + part * ramp.high[face]


@inner_kernel
def collide_thermal(flights, i, face, model, tally, law, faces):
    """Give a particle the velocity of one that leaves a thermal wall."""
    d = len(model.space.lengths)
    axis = face // 2
    side = 1.0 if face % 2 else -1.0
    mass = mass_of(i, model.masses, law)
    number = faces.draws[i]
    faces.draws[i] = number + 1
    if mirrors(i, face, number, faces.key, faces.accommodation):
        add(tally.wall_impulse, face, 2.0 * mass * abs(flights[i].velocity[axis]))
        flights[i].velocity[axis] = -flights[i].velocity[axis]
        return
    level = temperature_at(face, flights[i].position, model.space.lengths, faces.level, faces.ramp)
    width = sqrt(level / mass)
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
        draw_spin(i, face, level, faces.key, (number, block), d, tally, law)
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
def draw_spin(i, wall, level, key, counter, dimension, tally, law):
    """The same for the spin of a rough particle, which has one component in 2D. wall: the row of the tally;
    level: the temperature; counter: the draw's number and the first block of random words that it may use."""
    if law is None:
        return
    if law.tangential > -1.0:
        number, block = counter
        inertia = 1.0 / law.inverse_inertia[i]
        width = sqrt(level / inertia)
        for k in range(2 if dimension == 2 else 0, 3):
            one, _, block = normal_pair(key, i, number, block)
            spin = width * one
            before = law.spins[i, k]
            add(tally.wall_energy, wall, 0.5 * inertia * (before * before - spin * spin))
            law.spins[i, k] = spin
