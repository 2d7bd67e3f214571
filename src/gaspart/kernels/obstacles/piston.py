"""A piston: a face of finite mass, which a constant force pushes inwards and particles push back.

It starts at the side of the container and bounces off that without loss. Between its contacts it therefore
moves on one parabola, or on two: one outwards to the side, and one from there. Places and velocities count
from the container's side inwards.
"""

from math import inf

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.model import NONE, PISTON_CLOCK, PISTON_PLACE, PISTON_VELOCITY
from gaspart.kernels.physics.ballistic import flown, time_to_side
from gaspart.kernels.physics.flight import face_plane
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add


@inner_helper
def time_to_stop(place, velocity, push):
    """Time until a piston reaches the side of the container; inf if it never does."""
    return time_to_side(place, -velocity, -push)


@kernel
def moved(place, velocity, push, late):
    """(place, velocity) of a piston some time later, if it meets no particle."""
    stop = time_to_stop(place, velocity, push)
    if late < stop:
        return flown(place, velocity, push, late), velocity + push * late
    back = -(velocity + push * stop)
    late -= stop
    return flown(0.0, back, push, late), back + push * late


@kernel
def time_to_piston(x, v, place, velocity, push):
    """Time until a particle of height x and inward velocity v touches a piston; inf if it never does."""
    stop = time_to_stop(place, velocity, push)
    time = time_to_side(x - place, velocity - v, push)
    if time <= stop:
        return time
    back = -(velocity + push * stop)
    return stop + time_to_side(x + v * stop, back - v, push)


@inner_kernel
def next_piston(particles, i, space, piston):
    """When a particle touches the piston."""
    flights, face = particles.flights, piston.face
    upper, axis = face % 2 == 1, face // 2
    flight, motion = flights[i], piston.motion
    x, v = flight.position[axis] - face_plane(flights, i, axis, upper, space), flight.velocity[axis]
    if upper:
        x, v = -x, -v
    place, velocity = motion[PISTON_PLACE], motion[PISTON_VELOCITY]
    start = max(flight.clock, motion[PISTON_CLOCK])
    if start > motion[PISTON_CLOCK]:
        place, velocity = moved(place, velocity, piston.push, start - motion[PISTON_CLOCK])
    return start + time_to_piston(x + v * (start - flight.clock), v, place, velocity, piston.push)


@inner_helper
def find_piston(particles, i, axis, space, piston):
    """(time, face code) of the contact with a piston across an axis, where there may be none."""
    if piston is None:
        return inf, NONE
    if piston.face // 2 != axis:
        return inf, NONE
    return next_piston(particles, i, space, piston), piston.face


@kernel
def advance_piston(motion, push, time):
    """Move a piston to `time`."""
    late = time - motion[PISTON_CLOCK]
    motion[PISTON_PLACE], motion[PISTON_VELOCITY] = moved(
        motion[PISTON_PLACE], motion[PISTON_VELOCITY], push, late
    )
    motion[PISTON_CLOCK] = time


@inner_kernel
def collide_with_piston(flights, i, face, model, tally, piston):
    """Let a particle and the piston exchange momentum without loss.

    They part so fast that the clocks resolve the next contact: a push, which a piston needs that lies on a
    particle at rest.
    """
    axis, inwards = face // 2, -1.0 if face % 2 else 1.0
    motion = piston.motion
    advance_piston(motion, piston.push, flights[i].clock)
    mass = mass_of(i, model.masses, model.law)
    before = inwards * flights[i].velocity[axis]
    approach = motion[PISTON_VELOCITY] - before
    parting = max(abs(approach), piston.slowest[0])
    impulse = (approach + parting) * mass * (piston.mass / (mass + piston.mass))
    after = before + impulse / mass
    flights[i].velocity[axis] = inwards * after
    motion[PISTON_VELOCITY] -= impulse / piston.mass
    add(tally.wall_impulse, face, impulse)
    add(tally.wall_energy, face, -0.5 * impulse * (before + after))


@inner_helper
def collide_piston(flights, i, face, model, tally, piston):
    """The same where there may be no piston."""
    if piston is not None:
        collide_with_piston(flights, i, face, model, tally, piston)


@inner_helper
def is_piston(face, piston):
    """Whether a face is a piston."""
    if piston is None:
        return False
    return face == piston.face
