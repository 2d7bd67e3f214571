"""Time integrals of the stress tensor and of the heat flux of a sheared gas.

They are those of `stress`, with velocities relative to the flow, c. The flow is that about the centre of
mass: if this moves across it at a speed w, it moves along it as the flow does where it is, so that all is as
in a gas at rest that is w t lower. A flight of constant velocity changes c_x steadily, so what it carries,
polynomials of at most third order, is integrated by Simpson's rule, which is exact: before each event of a
particle, from the time of the last one.
"""

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.event.stress import add_contact, energy_of, rotational_energy, velocity_about
from gaspart.kernels.physics.collision import gap_along
from gaspart.kernels.physics.lees_edwards import FLOW, GRADIENT, flow_at
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add

_SIMPSON = 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0


@inner_helper
def flow_about(height, time, space, stress, shear):
    """The flow's velocity at a height at a time, about the centre of mass."""
    return flow_at(height, space, shear) - shear.rate * stress.drift[GRADIENT] * time


@inner_helper
def relative(flights, i, axis, flow, stress):
    """A component of a particle's velocity relative to the flow."""
    v = velocity_about(flights, i, axis, stress)
    return v - flow if axis == FLOW else v


@inner_kernel
def add_flight(flights, i, time, sign, model, stress, shear):
    """Add, with a sign, what a particle carries from its clock to `time`."""
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
    """The same for all particles."""
    for i in range(len(flights)):
        add_flight(flights, i, time, sign, model, stress, model.shear)


@inner_helper
def end_flight(flights, i, time, model, stress, shear):
    """Add what a particle has carried until an event, to which it has not been advanced yet."""
    if shear is not None:
        _end_flight(flights, i, time, model, stress, shear)


@inner_helper
def _end_flight(flights, i, time, model, stress, shear):
    if stress is not None:
        add_flight(flights, i, time, 1.0, model, stress, shear)


@inner_kernel
def _add_exchange(flights, i, j, model, stress, shear):
    """Add what two particles have exchanged at their contact since `stress.note_pair`."""
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
    """Add what two particles have exchanged at their contact, of a gas that is sheared or not."""
    if shear is None:
        add_contact(flights, i, j, time, model.space, model.masses, model.law, stress)
    else:
        _add_sheared(flights, i, j, model, stress, shear)
