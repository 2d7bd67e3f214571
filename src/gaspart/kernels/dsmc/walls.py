"""Hits of particles at hard, thermal and open faces of the container.

This code is used only for two kinds of particles: those that a step has moved beyond a face, and those that
enter during the step. A particle of the first kind returns to its position at the beginning of the step. Both
kinds fly from face to face until the end of the step, under gravity on parabolas. All hits are performed,
whatever their number. If smooth elastic particles have many hits, whole periods of the motion are performed
at once. The bounces of other particles on a floor are performed until they are too short to matter.
"""

from math import floor, inf, sqrt

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.dsmc.boltzmann import Sums, count_loss, law_of, load_spin, store_spin
from gaspart.kernels.dsmc.model import UNFINISHED, open_space
from gaspart.kernels.model import HARD, NONE, OPEN, THERMAL
from gaspart.kernels.obstacles.thermal import mirrors, temperature_at
from gaspart.kernels.physics.ballistic import advance_coordinate
from gaspart.kernels.physics.collision import collide_wall_by_law
from gaspart.kernels.physics.exact_sum import add_exact
from gaspart.kernels.physics.rng import flux_speed, normal_pair

_FEW = 64
"""Number of hits of a particle per step that are always performed one by one, with their own random numbers.
"""
_MOST = 2**24
"""Maximum number of hits without a closed form; a step with more hits of a particle cannot be completed."""
_REST = 2.0**-20
"""Longest bounce of an inelastic or rough particle that counts as rest at a face, as a fraction of a step."""


@inner_helper
def time_to_face(y, u, a):
    """Return the time until a particle reaches a face, and its speed there. The height y over the face, the
    speed u and the acceleration a are directed inwards. The time is the root of y + u t + a t^2/2 in the form
    without cancellation; inf if the particle never reaches the face.
    """
    y = max(y, 0.0)
    square = u * u - 2.0 * y * a
    if square >= 0.0:
        w = sqrt(square)
        if u < 0.0:
            return 2.0 * y / (w - u), w
        if a < 0.0:
            return (w + u) / -a, w
    return inf, 0.0


@inner_helper
def along(axis, upper, flights, radius, space, gravity):
    """Return height of a particle over a face, speed and acceleration, all directed inwards."""
    inset = space.margin * radius
    x, v, a = flights[0].position[axis], flights[0].velocity[axis], 0.0
    if gravity is not None:
        a = gravity[axis]
    if upper:
        return space.lengths[axis] - inset - x, -v, -a
    return x - inset, v, a


@inner_helper
def next_face(flights, radius, space, gravity, resting):
    """Return the next face that a particle reaches: (time from now, face, speed towards it). Without such a
    face, the time is infinite and the face equals NONE. `resting`: bits of the axes along which the particle
    rests.
    """
    first, face, speed = inf, NONE, 0.0
    for k in range(len(space.lengths)):
        if space.periodic[k] or resting >> k & 1:
            continue
        for side in range(2):
            y, u, a = along(k, side == 1, flights, radius, space, gravity)
            time, w = time_to_face(y, u, a)
            if time < first:
                first, face, speed = time, 2 * k + side, w
    return first, face, speed


@inner_helper
def fly_along(axis, flights, time, gravity):
    """Move a particle along one axis of its flight."""
    x, v = flights[0].position[axis], flights[0].velocity[axis]
    if gravity is None:
        flights[0].position[axis] = x + v * time
    else:
        flights[0].position[axis] = advance_coordinate(x, v, gravity[axis], time)
        flights[0].velocity[axis] = v + gravity[axis] * time


@inner_helper
def fly(flights, time, space, gravity, resting):
    """Move a particle along its flight, except along axes on which it rests."""
    for k in range(len(space.lengths)):
        if not resting >> k & 1:
            fly_along(k, flights, time, gravity)


@inner_helper
def put_at_face(face, speed, flights, radius, space):
    """Place a particle at a face, with its speed towards the face."""
    axis, upper, inset = face // 2, face % 2 == 1, space.margin * radius
    flights[0].position[axis] = space.lengths[axis] - inset if upper else inset
    flights[0].velocity[axis] = speed if upper else -speed


@inner_kernel
def draw_spin(i, level, inertia, key, counter, spins):
    """Draw the spin of a particle; return the energy given to the face. `i`: number of the particle. `level`:
    temperature. `counter`: number of components of the spin, number of the draw, and first block of random
    words for the draw.
    """
    components, number, block = counter
    width, energy = sqrt(level / inertia), 0.0
    for k in range(3 - components, 3):
        deviate, _, block = normal_pair(key, i, number, block)
        before, spin = spins[i, k], width * deviate
        energy += 0.5 * inertia * (before * before - spin * spin)
        spins[i, k] = spin
    return energy


@inner_helper
def add_shear(face, mass, context, shear):
    """Add the momentum of a particle along a face to the momentum given to the face. `mass`: negative if the
    particle receives the momentum.
    """
    if shear is not None:
        workspace, part = context.workspace, context.part
        for k in range(shear.shape[2]):
            if k != face // 2:
                momentum = mass * workspace.flights[part, 0].velocity[k]
                add_exact(shear[part, face, k], momentum)


@inner_helper
def drag(face, mass, context, velocity, shear):
    """Add the velocity of a sliding face to the velocity of a particle that leaves it."""
    if velocity is not None:
        for k in range(velocity.shape[1]):
            context.workspace.flights[context.part, 0].velocity[k] += velocity[face, k]
        add_shear(face, -mass, context, shear)


@inner_helper
def press(face, which, impulse, context):
    """Count the momentum that a particle of a kind gives to a face along its normal."""
    workspace, part = context.workspace, context.part
    add_exact(workspace.wall_impulse[part, face], impulse)
    if len(workspace.inverse_area) > 0:
        add_exact(workspace.per_area[part, face, face // 2], impulse * workspace.inverse_area[which, face])


@inner_helper
def warm(face, which, heat, shear, context):
    """Count the energy and the tangential momentum (3,) that a particle gives to a thermal face. `which`:
    kind of the particle.
    """
    workspace, part = context.workspace, context.part
    add_exact(workspace.wall_heat[part, face], heat)
    if len(workspace.inverse_area) > 0:
        d, inverse = len(context.space.lengths), workspace.inverse_area[which, face]
        for k in range(d):
            if k != face // 2:
                add_exact(workspace.per_area[part, face, k], shear[k] * inverse)
        add_exact(workspace.per_area[part, face, d], heat * inverse)


@inner_helper
def momentum_of(mass, flights):
    """Return the momentum (3,) of the particle in a thread's workspace; in 2D the third component is 0."""
    velocity = flights[0].velocity
    return mass * velocity[0], mass * velocity[1], mass * velocity[2] if len(velocity) == 3 else 0.0


@inner_kernel
def leave_thermal(i, face, which, number, context, faces, law):
    """Give a particle at a thermal face the velocity with which it leaves. The velocity is random; see
    `obstacles.thermal`. `i` and `which`: number and kind of the particle. `number`: number of the draw for
    this particle.
    """
    part, workspace, key = context.part, context.workspace, context.workspace.wall_key
    flights, mass, inertia = workspace.flights[part], workspace.mass[which], workspace.inertia[which]
    d, axis, side = len(context.space.lengths), face // 2, 1.0 if face % 2 else -1.0
    if mirrors(i, face, number, key, faces.accommodation):
        press(face, which, 2.0 * mass * abs(flights[0].velocity[axis]), context)
        flights[0].velocity[axis] = -flights[0].velocity[axis]
        return
    arrived = momentum_of(mass, flights)
    level = temperature_at(face, flights[0].position, context.space.lengths, faces.level, faces.ramp)
    width, square, spin_energy = sqrt(level / mass), 0.0, 0.0
    for k in range(d):
        square += flights[0].velocity[k] * flights[0].velocity[k]
    away = width * flux_speed(key, i, number)
    impulse = mass * (side * flights[0].velocity[axis] + away)
    flights[0].velocity[axis] = -side * away
    if faces.kind[face] == THERMAL:
        add_shear(face, mass, context, faces.shear)
        first, second, block = normal_pair(key, i, number, 1)
        flights[0].velocity[(axis + 1) % d] = width * first
        if d == 3:
            flights[0].velocity[(axis + 2) % d] = width * second
        drag(face, mass, context, faces.velocity, faces.shear)
        if law is not None:
            if law.tangential > -1.0:
                components = 1 if d == 2 else 3
                spin_energy = draw_spin(i, level, inertia, key, (components, number, block), law.spins)
    for k in range(d):
        square -= flights[0].velocity[k] * flights[0].velocity[k]
    leaving = momentum_of(mass, flights)
    shear = arrived[0] - leaving[0], arrived[1] - leaving[1], arrived[2] - leaving[2]
    press(face, which, impulse, context)
    warm(face, which, 0.5 * mass * square + spin_energy, shear, context)


@inner_kernel
def bounce(i, face, which, context, law):
    """Reflect the particle in a thread's workspace at a hard face. `i` and `which`: number and kind of the
    particle.
    """
    axis, side = face // 2, 1.0 if face % 2 else -1.0
    flights = context.workspace.flights[context.part]
    if law is None:
        impulse = 2.0 * context.workspace.mass[which] * abs(flights[0].velocity[axis])
        flights[0].velocity[axis] = -flights[0].velocity[axis]
    else:
        load_spin(i, 0, which, context, law)
        normal = side if axis == 0 else 0.0, side if axis == 1 else 0.0, side if axis == 2 else 0.0
        sums = Sums(context.workspace.sums[context.part])
        impulse = collide_wall_by_law(
            flights, 0, normal, 0.0, open_space(context.space.lengths), sums, law_of(context, law)
        )
        store_spin(i, 0, context, law)
        count_loss(context)
    press(face, which, impulse, context)


@inner_helper
def bounce_often(face, times, speed, which, context):
    """Count a number of elastic bounces of a smooth particle at a face, at one speed. `which`: kind of the
    particle.
    """
    workspace = context.workspace
    workspace.wall_hits[context.part, face] += np.int64(times)
    press(face, which, 2.0 * workspace.mass[which] * speed * times, context)


@inner_helper
def lean(face, which, duration, context, gravity):
    """Put a particle to rest at a face for some time; the face carries its weight. `duration`: duration of
    the rest. `which`: kind of the particle.
    """
    axis = face // 2
    context.workspace.flights[context.part, 0].velocity[axis] = 0.0
    press(face, which, context.workspace.mass[which] * abs(gravity[axis]) * duration, context)


@inner_kernel
def finish_axis(axis, remaining, which, context, gravity):
    """Move a smooth elastic particle along one axis for some time, with all its bounces. The axes are
    independent. Between the first and the last bounces, whole periods of the motion are performed at once.
    """
    space, workspace = context.space, context.workspace
    flights, radius = workspace.flights[context.part], workspace.radius[which]
    skipped = False
    while True:
        first, face, speed = inf, NONE, 0.0
        for side in range(2):
            y, u, a = along(axis, side == 1, flights, radius, space, gravity)
            time, w = time_to_face(y, u, a)
            if time < first:
                first, face, speed = time, 2 * axis + side, w
        if not first <= remaining:
            fly_along(axis, flights, remaining, gravity)
            return
        remaining -= first
        put_at_face(face, -speed, flights, radius, space)
        bounce_often(face, 1.0, speed, which, context)
        if skipped:
            continue
        y, u, a = along(axis, face % 2 == 0, flights, radius, space, gravity)
        time, w = time_to_face(y, u, a)  # to the opposite face
        across, period = time < inf, 2.0 * time
        if not across:
            period = 2.0 * speed / a  # the acceleration is towards this face and away from the opposite face
        if gravity is not None:
            if not period > remaining * 2.0**-53:
                lean(face, which, remaining, context, gravity)
                return
        number = floor(remaining / period)
        remaining = max(remaining - number * period, 0.0)
        bounce_often(face, number, speed, which, context)
        if across:
            bounce_often(face ^ 1, number, w, which, context)
        skipped = True


@inner_helper
def finish_axes(remaining, which, context, gravity, resting):
    """Move a smooth elastic particle along all axes for some time, with all its bounces."""
    space = context.space
    for k in range(len(space.lengths)):
        if space.periodic[k]:
            fly_along(k, context.workspace.flights[context.part], remaining, gravity)
        elif not resting >> k & 1:
            finish_axis(k, remaining, which, context, gravity)


@inner_helper
def comes_to_rest(face, speed, remaining, which, context, gravity, law):
    """Return True if a particle rests at a hard face; count its loss and weight. A particle that hits a face
    rests there if its bounces are too short, because later bounces would be even shorter.
    """
    workspace, axis = context.workspace, face // 2
    pull = gravity[axis] if face % 2 else -gravity[axis]  # towards the face
    shortest = 0.0
    if law is not None:
        shortest = _REST * workspace.dt
    if not (pull > 0.0 and 2.0 * speed <= pull * shortest):
        return False
    mass = workspace.mass[which]
    add_exact(workspace.loss[context.part], 0.5 * mass * speed * speed)
    press(face, which, mass * speed, context)
    lean(face, which, remaining, context, gravity)
    return True


@inner_kernel
def leave_open(i, face, which, context, present):
    """Remove a particle, and count the energy and momentum that it carries through the face."""
    if present is None:
        return
    workspace, part = context.workspace, context.part
    flights, mass, square = workspace.flights[part], workspace.mass[which], 0.0
    press(face, which, mass * abs(flights[0].velocity[face // 2]), context)
    for k in range(len(context.space.lengths)):
        square += flights[0].velocity[k] * flights[0].velocity[k]
        flights[0].position[k] = 0.5 * context.space.lengths[k]
        flights[0].velocity[k] = 0.0
    add_exact(workspace.wall_heat[part, face], 0.5 * mass * square)
    present[i] = 0


@inner_kernel
def fly_among_faces(i, which, remaining, context, gravity, faces, law):
    """Move the particle in the workspace to the end of a step, with all its hits. `i` and `which`: number and
    kind of the particle. `remaining`: time until the end of the step.
    """
    space, workspace, part = context.space, context.workspace, context.part
    flights, radius = workspace.flights[part], workspace.radius[which]
    resting, clock = 0, np.int64(workspace.clock[0])
    for hit in range(_MOST):
        time, face, speed = next_face(flights, radius, space, gravity, resting)
        if not time <= remaining:
            fly(flights, remaining, space, gravity, resting)
            return
        if faces is None and law is None:
            if hit >= _FEW:
                finish_axes(remaining, which, context, gravity, resting)
                return
        fly(flights, time, space, gravity, resting)
        remaining -= time
        put_at_face(face, speed, flights, radius, space)
        hard = True
        if faces is not None:
            hard = faces.kind[face] == HARD
        if gravity is not None:
            if hard and comes_to_rest(face, speed, remaining, which, context, gravity, law):
                resting |= 1 << (face // 2)
                continue
        workspace.wall_hits[part, face] += 1
        if faces is not None:
            if faces.kind[face] == OPEN:
                leave_open(i, face, which, context, faces.present)
                return
        if hard:
            bounce(i, face, which, context, law)
        if faces is not None:
            if not hard:
                number = clock * _FEW + hit if hit < _FEW else -1 - (clock * _MOST + hit)
                leave_thermal(i, face, which, number, context, faces, law)
    workspace.counts[part, UNFINISHED] += 1
