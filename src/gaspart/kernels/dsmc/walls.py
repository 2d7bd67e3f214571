"""Particles at the container's faces: hard by the law of contacts, or thermal.

Only a particle that a step has brought beyond a face comes here. It is put back to where the step began and
flies from face to face until the step ends, under gravity on parabolas.
"""

from math import inf, sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.dsmc.contact import Sums, count_loss, law_of, return_spin, take_spin
from gaspart.kernels.dsmc.model import ENERGY, MOMENTUM, open_space
from gaspart.kernels.model import HARD, NONE, THERMAL
from gaspart.kernels.physics.ballistic import flown
from gaspart.kernels.physics.collision import collide_wall_by_law
from gaspart.kernels.physics.rng import flux_speed, normal_pair
from gaspart.kernels.physics.running_sum import add_whole

_HITS = 64
"""At most so many of a particle in a step; the rest of its bounces on a floor would be shorter than a few
hundredths of the step, and it stays there until the step ends."""


@inner_helper
def time_to_face(y, u, a):
    """Time until a particle at a height y over a face, with a speed u and an acceleration a, all inward,
    comes to it, and the speed with which it does: the root of y + u t + a t^2/2 in the forms that do not
    cancel. inf if it never does."""
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
def next_face(flights, radius, space, gravity):
    """The next face that a particle comes to: (time from now, face, speed towards it); NONE if there is
    none."""
    first, face, speed = inf, NONE, 0.0
    for k in range(len(space.lengths)):
        if space.periodic[k]:
            continue
        inset = space.margin * radius
        x, v = flights[0].position[k], flights[0].velocity[k]
        a = 0.0
        if gravity is not None:
            a = gravity[k]
        time, w = time_to_face(x - inset, v, a)
        if time < first:
            first, face, speed = time, 2 * k, w
        time, w = time_to_face(space.lengths[k] - inset - x, -v, -a)
        if time < first:
            first, face, speed = time, 2 * k + 1, w
    return first, face, speed


@inner_helper
def fly(flights, time, space, gravity):
    """Move a particle along its flight."""
    for k in range(len(space.lengths)):
        if gravity is None:
            flights[0].position[k] += flights[0].velocity[k] * time
        else:
            x, v = flights[0].position[k], flights[0].velocity[k]
            flights[0].position[k] = flown(x, v, gravity[k], time)
            flights[0].velocity[k] = v + gravity[k] * time


@inner_kernel
def draw_spin(i, level, inertia, key, counter, spins):
    """Draw the spin of particle i, with `counter` its number of components, at a temperature `level`.
    counter: besides, the number of the draw and the first block of random words that it may use. Returns the
    energy that the face is given."""
    components, number, block = counter
    width, given = sqrt(level / inertia), 0.0
    for k in range(3 - components, 3):
        one, _, block = normal_pair(key, i, number, block)
        before, spin = spins[i, k], width * one
        given += 0.5 * inertia * (before * before - spin * spin)
        spins[i, k] = spin
    return given


@inner_helper
def add_shear(face, mass, setting, shear):
    """Add the momentum along a face of the particle in a thread's room to what the face was given. mass:
    negative where the particle takes it."""
    if shear is not None:
        tools, part = setting.tools, setting.part
        for k in range(shear.shape[2]):
            if k != face // 2:
                given = mass * tools.flights[part, 0].velocity[k]
                add_whole(shear[part, face, k], given, tools.scales[MOMENTUM])


@inner_helper
def drag(face, mass, setting, velocity, shear):
    """Let the particle in a thread's room, which leaves a face, share its motion."""
    if velocity is not None:
        for k in range(velocity.shape[1]):
            setting.tools.flights[setting.part, 0].velocity[k] += velocity[face, k]
        add_shear(face, -mass, setting, shear)


@inner_kernel
def leave_thermal(i, face, which, number, setting, faces, law):
    """Give particle i, of a kind, at a thermal face, the velocity of one that leaves it: the draw with this
    number of its own. See `obstacles.thermal`."""
    part, tools, key = setting.part, setting.tools, setting.tools.wall_key
    flights, mass, inertia = tools.flights[part], tools.mass[which], tools.inertia[which]
    d, axis, side = len(setting.space.lengths), face // 2, 1.0 if face % 2 else -1.0
    level = faces.level[face]
    width, square, given = sqrt(level / mass), 0.0, 0.0
    for k in range(d):
        square += flights[0].velocity[k] * flights[0].velocity[k]
    away = width * flux_speed(key, i, number)
    impulse = mass * (side * flights[0].velocity[axis] + away)
    flights[0].velocity[axis] = -side * away
    if faces.kind[face] == THERMAL:
        add_shear(face, mass, setting, faces.shear)
        one, other, block = normal_pair(key, i, number, 1)
        flights[0].velocity[(axis + 1) % d] = width * one
        if d == 3:
            flights[0].velocity[(axis + 2) % d] = width * other
        drag(face, mass, setting, faces.velocity, faces.shear)
        if law is not None:
            if law.tangential > -1.0:
                components = 1 if d == 2 else 3
                given = draw_spin(i, level, inertia, key, (components, number, block), law.spins)
    for k in range(d):
        square -= flights[0].velocity[k] * flights[0].velocity[k]
    add_whole(tools.wall_impulse[part, face], impulse, tools.scales[MOMENTUM])
    add_whole(tools.wall_heat[part, face], 0.5 * mass * square + given, tools.scales[ENERGY])


@inner_kernel
def bounce(i, face, which, setting, law):
    """Reflect particle i, of a kind, in its place in a thread's room, at a hard face."""
    part, tools, axis, side = setting.part, setting.tools, face // 2, 1.0 if face % 2 else -1.0
    flights = setting.tools.flights[part]
    if law is None:
        impulse = 2.0 * setting.tools.mass[which] * abs(flights[0].velocity[axis])
        flights[0].velocity[axis] = -flights[0].velocity[axis]
    else:
        take_spin(i, 0, which, setting, law)
        normal = side if axis == 0 else 0.0, side if axis == 1 else 0.0, side if axis == 2 else 0.0
        sums = Sums(setting.tools.sums[part])
        impulse = collide_wall_by_law(
            flights, 0, normal, 0.0, open_space(setting.space.lengths), sums, law_of(setting, law)
        )
        return_spin(i, 0, setting, law)
        count_loss(setting)
    add_whole(tools.wall_impulse[part, face], impulse, tools.scales[MOMENTUM])


@inner_kernel
def fly_among_faces(i, which, setting, gravity, faces, law):
    """Let particle i, of a kind, in its place in a thread's room, fly for a step."""
    space, left, part = setting.space, setting.tools.dt, setting.part
    flights, radius = setting.tools.flights[part], setting.tools.radius[which]
    for hit in range(_HITS):
        time, face, speed = next_face(flights, radius, space, gravity)
        if not time <= left:
            fly(flights, left, space, gravity)
            return
        fly(flights, time, space, gravity)
        left -= time
        axis, upper = face // 2, face % 2 == 1
        inset = space.margin * radius
        flights[0].position[axis] = space.lengths[axis] - inset if upper else inset
        flights[0].velocity[axis] = speed if upper else -speed
        setting.tools.wall_hits[part, face] += 1
        hard = True
        if faces is not None:
            hard = faces.kind[face] == HARD
            if not hard:
                leave_thermal(i, face, which, setting.tools.clock[0] * _HITS + hit, setting, faces, law)
        if hard:
            bounce(i, face, which, setting, law)
