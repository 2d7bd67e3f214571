"""Time integrals of the stress tensor and of the heat flux (Helfand, Phys. Rev. 119, 1 (1960)).

The stress sum S (d, d) grows by m v v dt while particles fly, and by r dp at a contact, with r the vector
from the second particle to the first and dp what that gains. The heat sum Q (d,) grows by E v dt and by r
times half of the difference of what the two particles gain in energy E, with spins also that of rotation.
Velocities v are about that of the centre of mass, which is conserved, so that a gas that moves as a whole has
the sums of one at rest.

Between contacts m v v summed over all particles, K, is constant, so that its integral until the time t is
K(t) t minus the sum over contacts of their time and of the change of K: a contact adds what concerns its two
particles, and K is summed when S is read. The contacts' part of S is summed by itself too.
"""

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, kernel
from gaspart.kernels.physics.collision import gap_along
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add


class Stress(NamedTuple):
    """sums (2 d^2 + d, 2), those of S, by rows, and of its part from contacts, and of Q, without K(t) t, see
    `running_sum.add`; before (2, d + 1), velocity and energy of two particles before their contact; drift
    (d,), the velocity of the centre of mass."""

    sums: np.ndarray
    before: np.ndarray
    drift: np.ndarray


@inner_helper
def rotational_energy(i, law):
    """Half of the moment of inertia times the square of the spin."""
    if law is not None:
        spin = 0.0
        for k in range(3):
            spin += law.spins[i, k] * law.spins[i, k]
        if spin > 0.0:
            return 0.5 * spin / law.inverse_inertia[i]
    return 0.0


@inner_helper
def velocity_about(flights, i, axis, stress):
    """A component of a particle's velocity about that of the centre of mass."""
    return flights[i].velocity[axis] - stress.drift[axis]


@inner_helper
def energy_of(flights, i, space, masses, law, stress):
    """The kinetic energy of a particle, likewise."""
    square = 0.0
    for k in range(len(space.lengths)):
        v = velocity_about(flights, i, k, stress)
        square += v * v
    return 0.5 * mass_of(i, masses, law) * square + rotational_energy(i, law)


@inner_helper
def note_pair(flights, i, j, space, masses, law, stress):
    """Keep velocities and energies of two particles, which are about to collide."""
    if stress is not None:
        d = len(space.lengths)
        for k in range(d):
            stress.before[0, k] = velocity_about(flights, i, k, stress)
            stress.before[1, k] = velocity_about(flights, j, k, stress)
        stress.before[0, d] = energy_of(flights, i, space, masses, law, stress)
        stress.before[1, d] = energy_of(flights, j, space, masses, law, stress)


@inner_helper
def add_contact(flights, i, j, time, space, masses, law, stress):
    """Add what two particles have exchanged at their contact since `note_pair`."""
    if stress is not None:
        d, sums, before = len(space.lengths), stress.sums, stress.before
        mass, other = mass_of(i, masses, law), mass_of(j, masses, law)
        energy = energy_of(flights, i, space, masses, law, stress)
        other_energy = energy_of(flights, j, space, masses, law, stress)
        passed = 0.5 * ((energy - before[0, d]) - (other_energy - before[1, d]))
        for k in range(d):
            apart = -gap_along(flights, i, j, k, space)
            u, v = velocity_about(flights, i, k, stress), velocity_about(flights, j, k, stress)
            heat = energy * u - before[0, d] * before[0, k] + other_energy * v - before[1, d] * before[1, k]
            add(sums, 2 * d * d + k, apart * passed - time * heat)
            for n in range(d):
                x, y = velocity_about(flights, i, n, stress), velocity_about(flights, j, n, stress)
                flux = mass * (u * x - before[0, k] * before[0, n])
                flux += other * (v * y - before[1, k] * before[1, n])
                passes = apart * mass * (x - before[0, n])
                add(sums, d * k + n, passes - time * flux)
                add(sums, d * d + d * k + n, passes)


@kernel
def add_flights(flights, time, space, masses, law, stress):
    """Add `time` times m v v and E v, summed over all particles."""
    d, sums = len(space.lengths), stress.sums
    for i in range(len(flights)):
        mass, energy = mass_of(i, masses, law), energy_of(flights, i, space, masses, law, stress)
        for k in range(d):
            way = time * velocity_about(flights, i, k, stress)
            add(sums, 2 * d * d + k, energy * way)
            for n in range(d):
                add(sums, d * k + n, mass * way * velocity_about(flights, i, n, stress))
