"""Time integrals of the stress tensor and of the heat flux.

They follow Helfand, Phys. Rev. 119, 1 (1960). The stress sum S (d, d) grows by m v v dt in flight, and by r
dp at a collision. r is the vector from the second particle to the first, and dp the momentum gained by the
first. The heat sum Q (d,) grows by E v dt in flight. At a collision it grows by r times half of the
difference between the energy gains of the two particles. The energy E includes rotation if there are spins.
Velocities v are relative to the centre of mass, whose velocity is conserved. So a gas that moves as a whole
has the same sums as a gas at rest.

Between collisions the sum K of m v v over all particles is constant. So its integral up to the time t is K(t)
t minus a sum over collisions of the collision time multiplied by the change of K. Each collision adds the
contribution of its two particles. K is summed when S is read. The collisional part of S is also summed
separately.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.physics.collision import gap_along
from gaspart.kernels.physics.lees_edwards import FLOW, GRADIENT, flow_at
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add


class Stress(NamedTuple):
    """Sums of the stress tensor and of the heat flux."""

    sums: np.ndarray
    before: np.ndarray
    drift: np.ndarray


@inner_helper
def rotational_energy(i, law):
    """Return half of the moment of inertia multiplied by the squared spin."""
    if law is not None:
        spin = 0.0
        for k in range(3):
            spin += law.spins[i, k] * law.spins[i, k]
        if spin > 0.0:
            return 0.5 * spin / law.inverse_inertia[i]
    return 0.0


@inner_helper
def velocity_about(flights, i, axis, stress):
    """Return a velocity component of a particle relative to the centre of mass."""
    return flights[i].velocity[axis] - stress.drift[axis]


@inner_helper
def energy_of(flights, i, space, masses, law, stress):
    """Return the kinetic energy of a particle relative to the centre of mass."""
    square = 0.0
    for k in range(len(space.lengths)):
        v = velocity_about(flights, i, k, stress)
        square += v * v
    return 0.5 * mass_of(i, masses, law) * square + rotational_energy(i, law)


@inner_helper
def note_pair(flights, i, j, space, masses, law, stress):
    """Store velocities and energies of two particles before their collision."""
    if stress is not None:
        d = len(space.lengths)
        for k in range(d):
            stress.before[0, k] = velocity_about(flights, i, k, stress)
            stress.before[1, k] = velocity_about(flights, j, k, stress)
        stress.before[0, d] = energy_of(flights, i, space, masses, law, stress)
        stress.before[1, d] = energy_of(flights, j, space, masses, law, stress)


@inner_helper
def add_contact(flights, i, j, time, space, masses, law, stress):
    """Add the transfer between two particles at their collision since `note_pair`."""
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


# Time integrals of the stress tensor and the heat flux of a sheared gas.
#
# They are the same integrals as at the top of this module, with velocities c relative to the flow. The flow
# is relative to the centre of mass. If the centre of mass moves across the flow at a speed w, it also moves
# along it with the flow at its position. So the gas is equivalent to a gas whose centre of mass is at rest
# and that is lower by w t. During a flight of constant velocity c_x changes linearly. So the transport
# consists of polynomials of at most third order. Simpson's rule integrates them exactly, before each event of
# a particle, from the time of its last event.


_SIMPSON = 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0


@inner_helper
def flow_about(height, time, space, stress, shear):
    """Return the flow velocity at a height and a time, relative to the centre of mass."""
    return flow_at(height, space, shear) - shear.rate * stress.drift[GRADIENT] * time


@inner_helper
def relative(flights, i, axis, flow, stress):
    """Return a velocity component of a particle relative to the flow."""
    v = velocity_about(flights, i, axis, stress)
    return v - flow if axis == FLOW else v


@inner_kernel
def add_flight(flights, i, time, sign, model, stress, shear):
    """Add, multiplied by a sign, the transport by a particle from its clock to `time`."""
    space, sums = model.space, stress.sums
    d, late = len(space.lengths), time - flights[i].clock
    mass, turning = mass_of(i, model.masses, model.law), rotational_energy(i, model.law)
    for part in range(3):
        passed = 0.5 * part * late
        height = flights[i].position[GRADIENT] + flights[i].velocity[GRADIENT] * passed
        flow = flow_about(height, flights[i].clock + passed, space, stress, shear)
        weight = sign * _SIMPSON[part] * late
        square = 0.0
        for k in range(d):
            c = relative(flights, i, k, flow, stress)
            square += c * c
            for n in range(d):
                add(sums, d * k + n, weight * mass * c * relative(flights, i, n, flow, stress))
        for k in range(d):
            energy = 0.5 * mass * square + turning
            add(sums, 2 * d * d + k, weight * energy * relative(flights, i, k, flow, stress))


@kernel
def add_sheared_flights(flights, time, sign, model, stress):
    """Add, multiplied by a sign, the transport by all particles from their clocks to `time`."""
    for i in range(len(flights)):
        add_flight(flights, i, time, sign, model, stress, model.shear)


@inner_helper
def end_flight(flights, i, time, model, stress, shear):
    """Add the transport by a particle up to an event to which it has not been advanced yet."""
    if shear is not None:
        _end_flight(flights, i, time, model, stress, shear)


@inner_helper
def _end_flight(flights, i, time, model, stress, shear):
    if stress is not None:
        add_flight(flights, i, time, 1.0, model, stress, shear)


@inner_kernel
def _add_exchange(flights, i, j, model, stress, shear):
    """Add the transfer between two particles at their collision since `note_pair`."""
    space, sums, before = model.space, stress.sums, stress.before
    d, mass, other = (
        len(space.lengths),
        mass_of(i, model.masses, model.law),
        mass_of(j, model.masses, model.law),
    )
    flow = flow_about(flights[i].position[GRADIENT], flights[i].clock, space, stress, shear)
    other_flow = flow_about(flights[j].position[GRADIENT], flights[j].clock, space, stress, shear)
    gained = energy_of(flights, i, space, model.masses, model.law, stress) - before[0, d]
    gained -= mass * flow * (velocity_about(flights, i, FLOW, stress) - before[0, FLOW])
    other_gained = energy_of(flights, j, space, model.masses, model.law, stress) - before[1, d]
    other_gained -= other * other_flow * (velocity_about(flights, j, FLOW, stress) - before[1, FLOW])
    for k in range(d):
        apart = -gap_along(flights, i, j, k, space)
        add(sums, 2 * d * d + k, 0.5 * apart * (gained - other_gained))
        for n in range(d):
            passes = apart * mass * (velocity_about(flights, i, n, stress) - before[0, n])
            add(sums, d * k + n, passes)
            add(sums, d * d + d * k + n, passes)


@inner_helper
def _add_sheared(flights, i, j, model, stress, shear):
    if stress is not None:
        _add_exchange(flights, i, j, model, stress, shear)


@inner_helper
def tally_contact(flights, i, j, time, model, stress, shear):
    """Add the transfer between two particles at their collision, in a gas that may be sheared."""
    if shear is None:
        add_contact(flights, i, j, time, model.space, model.masses, model.law, stress)
    else:
        _add_sheared(flights, i, j, model, stress, shear)
