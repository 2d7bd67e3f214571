"""A wall across the container that moves: of finite mass, pushed by the particles on both its sides.

Between its contacts it moves evenly, and each particle stays on its side.
"""

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.model import PISTON_CLOCK, PISTON_PLACE, PISTON_VELOCITY, WALLS
from gaspart.kernels.physics.ballistic import time_to_side
from gaspart.kernels.physics.collision import LEAST
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add


@kernel
def advance_wall(motion, time):
    """Move the wall to `time`."""
    motion[PISTON_PLACE] += motion[PISTON_VELOCITY] * (time - motion[PISTON_CLOCK])
    motion[PISTON_CLOCK] = time


@inner_kernel
def next_moving(flights, i, moving):
    """When a particle touches the wall; inf if it never does."""
    axis, side, motion = moving.axis, moving.side[i], moving.motion
    start = max(flights[i].clock, motion[PISTON_CLOCK])
    x = flights[i].position[axis] + flights[i].velocity[axis] * (start - flights[i].clock)
    place = motion[PISTON_PLACE] + motion[PISTON_VELOCITY] * (start - motion[PISTON_CLOCK])
    gap = side * (x - place) - flights[i].radius
    closing = side * (motion[PISTON_VELOCITY] - flights[i].velocity[axis])
    return start + time_to_side(gap, closing, 0.0)


@inner_helper
def find_moving(flights, i, moving, time, face):
    """The earlier of the contact with the wall, where there may be none, and the face (time, face code)."""
    if moving is not None:
        soon = next_moving(flights, i, moving)
        if soon < time:
            return soon, WALLS
    return time, face


@inner_kernel
def collide_moving_wall(flights, i, model, tally, moving):
    """Let a particle and the wall exchange momentum without loss. Returns the number of the wall, with the
    faces before it.

    They part at a speed that rounding cannot hide, or they would meet for ever.
    """
    axis, side, motion = moving.axis, moving.side[i], moving.motion
    advance_wall(motion, flights[i].clock)
    mass, own = mass_of(i, model.masses, model.law), moving.mass
    before, speed = side * flights[i].velocity[axis], side * motion[PISTON_VELOCITY]
    approach = speed - before
    parting = max(abs(approach), LEAST * max(abs(speed), abs(before)))
    impulse = (approach + parting) * mass * (own / (mass + own))
    after = before + impulse / mass
    flights[i].velocity[axis] = side * after
    motion[PISTON_VELOCITY] -= side * (impulse / own)
    wall = 2 * len(model.space.lengths)
    tally.wall_hits[wall] += 1
    add(tally.wall_impulse, wall, impulse)
    add(tally.wall_energy, wall, -0.5 * impulse * (before + after))
    distance = side * (flights[i].position[axis] - motion[PISTON_PLACE]) / flights[i].radius
    tally.worst[0] = max(tally.worst[0], abs(distance * distance - 1.0))
    return wall
