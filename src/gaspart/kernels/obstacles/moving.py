"""Moving obstacles: vibrating faces, pistons, and a moving interior wall.

A vibrating face is at the side of the container at time 0, and moves inwards from there. A particle hits the
face when its height above the side, h(t) = x + v t + a t^2 / 2, becomes equal to the height s(t) of the face.
A sawtooth moves inwards at a constant speed in each period and returns at once; a sine is at
(stroke / 2) (1 - cos(2 pi t / period)). Heights and velocities are measured inwards from the side of the
container. The remainder of a division (%) is exact, and so it is the same on every machine.
"""

from __future__ import annotations

from math import inf, sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.model import NONE, PISTON_CLOCK, PISTON_PLACE, PISTON_VELOCITY, WALLS
from gaspart.kernels.physics.ballistic import advance_coordinate, time_to_side
from gaspart.kernels.physics.collision import LEAST, collide_wall_by_law
from gaspart.kernels.physics.flight import acceleration_of, face_plane
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.running_sum import add
from gaspart.kernels.physics.sine import TURN, sine_cosine

# Piston: a face of finite mass, which a constant force pushes inwards and which particles push back.
#
# A piston starts at the side of the container, and bounces there without loss. Between its contacts it
# therefore moves on one parabola, or on two: outwards to the side, and from there inwards. Positions and
# velocities are measured inwards from the side of the container.


@inner_helper
def time_to_stop(position, velocity, push):
    """Return the time until a piston reaches the side of the container, or inf."""
    return time_to_side(position, -velocity, -push)


@kernel
def fly_piston(position, velocity, push, late):
    """Return (position, velocity) of a piston after some time without a hit by a particle."""
    stop = time_to_stop(position, velocity, push)
    if late < stop:
        return advance_coordinate(position, velocity, push, late), velocity + push * late
    back = -(velocity + push * stop)
    late -= stop
    return advance_coordinate(0.0, back, push, late), back + push * late


@kernel
def time_to_piston(x, v, position, velocity, push):
    """Return the time until a particle touches a piston; inf if it never does. `x`: height of the particle.
    `v`: inward velocity of the particle.
    """
    stop = time_to_stop(position, velocity, push)
    time = time_to_side(x - position, velocity - v, push)
    if time <= stop:
        return time
    back = -(velocity + push * stop)
    return stop + time_to_side(x + v * stop, back - v, push)


@inner_kernel
def next_piston(particles, i, space, piston):
    """Return the time at which a particle touches the piston."""
    flights, face = particles.flights, piston.face
    upper, axis = face % 2 == 1, face // 2
    flight, motion = flights[i], piston.motion
    x, v = flight.position[axis] - face_plane(flights, i, axis, upper, space), flight.velocity[axis]
    if upper:
        x, v = -x, -v
    position, velocity = motion[PISTON_PLACE], motion[PISTON_VELOCITY]
    start = max(flight.clock, motion[PISTON_CLOCK])
    if start > motion[PISTON_CLOCK]:
        position, velocity = fly_piston(position, velocity, piston.push, start - motion[PISTON_CLOCK])
    return start + time_to_piston(x + v * (start - flight.clock), v, position, velocity, piston.push)


@inner_helper
def find_piston(particles, i, axis, space, piston):
    """Return (time, face code) of the contact with a piston across an axis; inf without a piston."""
    if piston is None:
        return inf, NONE
    if piston.face // 2 != axis:
        return inf, NONE
    return next_piston(particles, i, space, piston), piston.face


@kernel
def advance_piston(motion, push, time):
    """Advance a piston to `time`."""
    late = time - motion[PISTON_CLOCK]
    motion[PISTON_PLACE], motion[PISTON_VELOCITY] = fly_piston(
        motion[PISTON_PLACE], motion[PISTON_VELOCITY], push, late
    )
    motion[PISTON_CLOCK] = time


@inner_kernel
def collide_with_piston(flights, i, face, model, tally, piston):
    """Exchange momentum between a particle and the piston without loss. Their separation speed is large
    enough for the clocks to resolve the next contact. This adds a small push, which a piston needs that lies
    on a particle at rest.
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
    """Perform `collide_with_piston` if there is a piston."""
    if piston is not None:
        collide_with_piston(flights, i, face, model, tally, piston)


@inner_helper
def is_piston(face, piston):
    """Return True if a face is a piston."""
    if piston is None:
        return False
    return face == piston.face


# Moving wall across the container: it has a finite mass and is pushed by the particles on both sides.
#
# Between its contacts its velocity is constant, and each particle stays on its side.


@kernel
def advance_wall(motion, time):
    """Advance the wall to `time`."""
    motion[PISTON_PLACE] += motion[PISTON_VELOCITY] * (time - motion[PISTON_CLOCK])
    motion[PISTON_CLOCK] = time


@inner_kernel
def next_moving(flights, i, moving):
    """Return the time at which a particle touches the wall; inf if it never does."""
    axis, side, motion = moving.axis, moving.side[i], moving.motion
    start = max(flights[i].clock, motion[PISTON_CLOCK])
    x = flights[i].position[axis] + flights[i].velocity[axis] * (start - flights[i].clock)
    position = motion[PISTON_PLACE] + motion[PISTON_VELOCITY] * (start - motion[PISTON_CLOCK])
    gap = side * (x - position) - flights[i].radius
    closing = side * (motion[PISTON_VELOCITY] - flights[i].velocity[axis])
    return start + time_to_side(gap, closing, 0.0)


@inner_helper
def find_moving(flights, i, moving, time, face):
    """Return the earlier of the contact with a moving wall and the face (time, face code)."""
    if moving is not None:
        soon = next_moving(flights, i, moving)
        if soon < time:
            return soon, WALLS
    return time, face


@inner_kernel
def collide_moving_wall(flights, i, model, tally, moving):
    """Exchange momentum between a particle and the wall without loss. Their separation speed exceeds rounding
    errors; otherwise they would collide forever. Returns the number of the wall, counted after the faces.
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


# Hard faces at rest: the momentum transferred at a hit.


@inner_helper
def bounce(flights, i, face, model, tally, law):
    """Reflect a particle at a hard face, by the law if any; return the momentum given to the face."""
    axis = face // 2
    if law is None:
        velocity = flights[i].velocity[axis]
        flights[i].velocity[axis] = -velocity
        return 2.0 * mass_of(i, model.masses, law) * abs(velocity)
    side = 1.0 if face % 2 else -1.0
    normal = side if axis == 0 else 0.0, side if axis == 1 else 0.0, side if axis == 2 else 0.0
    return collide_wall_by_law(flights, i, normal, 0.0, model.space, tally, law)


_RESOLVED = 2.0**-52  # minimum step of a search, as a fraction of clock and period
_SLACK = 1.0 + 2.0**-20  # distance, in strokes, beyond which a particle needs no search


@kernel
def place_and_velocity(time, sine, stroke, period):
    """Return position and inward velocity of a face at a time within its period."""
    if not sine:
        speed = stroke / period
        return speed * time, speed
    s, c = sine_cosine(time / period)
    return 0.5 * stroke * (1.0 - c), 0.5 * stroke * TURN / period * s


@inner_helper
def time_to_sawtooth(gap, closing, pull, duration):
    """Return the time until a particle touches a uniformly moving face, and True if it does. `duration`: time
    for which the face moves uniformly; without a contact it is the result.
    """
    time = time_to_side(gap, closing, pull)
    return (time, True) if time < duration else (duration, False)


@inner_helper
def time_to_sine(gap, closing, most):
    """Return a time before which a particle cannot touch a face, and if it touches now. The time is the root
    for the largest acceleration `most` of their approach.
    """
    if gap <= 0.0 and closing > 0.0:
        return 0.0, True
    gap = max(gap, 0.0)
    root = sqrt(closing * closing + 2.0 * most * gap)
    return (2.0 * gap / (root + closing) if closing > 0.0 else (root - closing) / most), False


@kernel
def time_to_vibrating(x, v, a, clocks, at, sine, stroke, period):
    """Return the time until a particle hits a vibrating face; inf if it does not. At the contact the two must
    approach each other. The result is also inf if there is no contact before the end of the epoch, because
    all events are predicted again in the next epoch. Without this limit, a particle that approaches the
    stroke at 1e-16 of its former speed would be searched for in 1e16 periods, whose phases depend on
    rounding. Above the stroke the particle flies to the stroke without a search. Within the stroke, each step
    of the search ends before the first contact, for any motion of the face, so no contact is missed. With the
    largest acceleration of the face, the steps converge quadratically to the contact, like Newton's method.
    `x` and `v` and `a`: height, inward velocity and acceleration of the particle. `clocks`: time since the
    start of the epoch, and length of the epoch, at the time of x and v. `at`: time within the period of the
    face, at the time of x and v.
    """
    largest = 0.5 * stroke * (TURN / period) * (TURN / period) + abs(a)
    clock, epoch = clocks
    time = 0.0
    while clock + time <= epoch:
        height, velocity = advance_coordinate(x, v, a, time), v + a * time
        if height > stroke:
            step, meets = time_to_side(height - stroke, -velocity, -a), False
        else:
            face_height, speed = place_and_velocity(at, sine, stroke, period)
            if sine:
                step, meets = time_to_sine(height - face_height, speed - velocity, largest)
            else:
                step, meets = time_to_sawtooth(height - face_height, speed - velocity, -a, period - at)
        if meets:
            return time + step
        if not step < inf:
            return inf
        if step < _RESOLVED * (clock + time + period):
            step = _RESOLVED * (clock + time + period)
        time += step
        at = (at + step) % period
    return inf


@inner_helper
def moves(face, motion):
    """Return True if a face vibrates."""
    if motion is None:
        return False
    return motion.stroke[face] > 0.0


@inner_helper
def is_near(particles, i, face, boxes, space, motion):
    """Return True if a particle in this box may touch the face."""
    axis, upper = face // 2, face % 2 == 1
    at, width = particles.predictions[i].box[axis], boxes.widths[axis]
    inset = face_plane(particles.flights, i, axis, False, space)
    reach = inset + _SLACK * motion.stroke[face]
    return space.lengths[axis] - (at + 1) * width <= reach if upper else at * width <= reach


@inner_kernel
def next_vibrating(particles, i, axis, boxes, space, gravity, motion):
    """Return the next contact with a vibrating face of an axis: (time, face code)."""
    flights, soon, code = particles.flights, inf, NONE
    for face in range(2 * axis, 2 * axis + 2):
        if motion.stroke[face] > 0.0 and is_near(particles, i, face, boxes, space, motion):
            flight = flights[i]
            upper = face % 2 == 1
            a = 0.0
            if gravity is not None:
                a = acceleration_of(flights, i, axis, space, gravity)
            plane = face_plane(flights, i, axis, upper, space)
            x, v = flight.position[axis] - plane, flight.velocity[axis]
            if upper:
                x, v, a = -x, -v, -a
            period = motion.period[face]
            at = (motion.begun[face] + flight.clock) % period
            sine, stroke = motion.sine[face], motion.stroke[face]
            clocks = flight.clock, motion.epoch[0]
            time = flight.clock + time_to_vibrating(x, v, a, clocks, at, sine, stroke, period)
            if time < soon:
                soon, code = time, face
    return soon, code


@inner_helper
def find_vibrating(particles, i, axis, boxes, space, gravity, motion):
    """Perform `next_vibrating` if there is a vibrating face."""
    if motion is None:
        return inf, NONE
    return next_vibrating(particles, i, axis, boxes, space, gravity, motion)


@inner_kernel
def collide_vibrating(flights, i, face, model, tally, law, motion):
    """Reflect a particle in the rest frame of a vibrating face. The work of the face is its velocity
    multiplied by the transferred momentum. The separation speed is large enough for the clocks to resolve the
    next contact. The energy of this small push is also counted.
    """
    axis, period = face // 2, motion.period[face]
    inwards = -1.0 if face % 2 else 1.0
    at = (motion.begun[face] + flights[i].clock) % period
    _, speed = place_and_velocity(at, motion.sine[face], motion.stroke[face], period)
    mass = mass_of(i, model.masses, law)
    flights[i].velocity[axis] -= inwards * speed
    impulse = 0.0
    if inwards * flights[i].velocity[axis] < 0.0:
        impulse = bounce(flights, i, face, model, tally, law)
    work = speed * impulse
    parting = inwards * flights[i].velocity[axis]
    push = motion.slowest[face] - parting
    if push > 0.0:
        flights[i].velocity[axis] += inwards * push
        impulse += mass * push
        work += mass * push * (speed + parting + 0.5 * push)
    flights[i].velocity[axis] += inwards * speed
    add(tally.wall_impulse, face, impulse)
    add(tally.wall_energy, face, -work)


@inner_helper
def collide_moving(flights, i, face, model, tally, law, motion):
    """Perform `collide_vibrating` if there is a vibrating face."""
    if motion is not None:
        collide_vibrating(flights, i, face, model, tally, law, motion)
