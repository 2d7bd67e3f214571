"""Faces with a kind (see `gaspart.surfaces`): what a thermal, sticky or attracting wall does to a body."""

from math import inf, sqrt

from gaspart.draws import flux_speed, normal_pair
from gaspart.engines.flight import advance_row, face_plane
from gaspart.engines.layout import EDGES, NOTHING, STICKY, THERMAL, THERMAL_NORMAL
from gaspart.engines.running_sum import add
from gaspart.kernel import inner_helper, inner_kernel


@inner_kernel
def mass_of(body, masses, law):
    """The mass of a body that can move, in the kernel's unit."""
    if law is not None:
        return 1.0 / law.inverse_mass[body]
    if masses is not None:
        return masses[body]
    return 1.0


@inner_helper
def edge_plane(rows, body, face, space, surfaces):
    """Where the centre of a body crosses the edge of a face's well."""
    upper = face % 2 == 1
    width = surfaces.width[face]
    return face_plane(rows, body, face // 2, upper, space) + (-width if upper else width)


@inner_kernel
def find_edge(rows, body, axis, space, surfaces):
    """When a body that moves along an axis comes to the edge of a well there, or, stuck to a face, is to be
    judged anew because a contact has moved it: (time, face code)."""
    d = len(space.lengths)
    v = rows[body, d + axis]
    clock = rows[body, 2 * d]
    place = surfaces.place[body, axis]
    upper = place > 0 or (place == 0 and v > 0.0)
    face = 2 * axis + (1 if upper else 0)
    if surfaces.kind[face] == STICKY and place != 0:
        return clock, face
    if surfaces.depth[face] > 0.0 and (place == 0 or (v > 0.0) != upper):
        return clock + (edge_plane(rows, body, face, space, surfaces) - rows[body, axis]) / v, EDGES + face
    return inf, NOTHING


@inner_kernel
def meet_edge(rows, body, face, time, space, masses, counters, gravity, law, surfaces):
    """Advance a body to the edge of a well, and let it in or out. Returns the number of the face."""
    advance_row(rows, body, time, space, gravity)
    cross_edge(rows, body, face, space, masses, counters, law, surfaces)
    return face


@inner_helper
def cross_edge(rows, body, face, space, masses, counters, law, surfaces):
    """Let a body into a well, or out of it if it is fast enough. The wall takes the momentum of the step."""
    axis = face // 2
    column = len(space.lengths) + axis
    rows[body, axis] = edge_plane(rows, body, face, space, surfaces)
    side = 1.0 if face % 2 else -1.0
    mass = mass_of(body, masses, law)
    step = 2.0 * surfaces.depth[face] / mass
    before = side * rows[body, column]
    if before > 0.0:
        after = sqrt(before * before + step)
        surfaces.place[body, axis] = 1 if face % 2 else -1
    elif before * before > step:
        after = -sqrt(before * before - step)
        surfaces.place[body, axis] = 0
    else:
        after = -before
    rows[body, column] = side * after
    add(counters.wall_impulse, face, mass * (before - after))


@inner_kernel
def leave_at_temperature(rows, body, face, space, masses, counters, law, surfaces):
    """Give a body the velocity of one that leaves a thermal wall."""
    d = len(space.lengths)
    axis = face // 2
    side = 1.0 if face % 2 else -1.0
    mass = mass_of(body, masses, law)
    number = surfaces.draws[body]
    surfaces.draws[body] = number + 1
    width = sqrt(surfaces.level[face] / mass)
    square = 0.0
    for k in range(d):
        square += rows[body, d + k] * rows[body, d + k]
    approach = side * rows[body, d + axis]
    away = width * flux_speed(surfaces.key, body, number)
    rows[body, d + axis] = -side * away
    add(counters.wall_impulse, face, mass * (approach + away))
    if surfaces.kind[face] == THERMAL:
        one, other, block = normal_pair(surfaces.key, body, number, 1)
        rows[body, d + (axis + 1) % d] = width * one
        if d == 3:
            rows[body, d + (axis + 2) % d] = width * other
        turn_at_temperature(body, face, number, block, counters, law, surfaces, d)
    for k in range(d):
        square -= rows[body, d + k] * rows[body, d + k]
    add(counters.wall_energy, face, 0.5 * mass * square)


@inner_kernel
def turn_at_temperature(body, face, number, block, counters, law, surfaces, d):
    """The same for the spin of a rough body, which has one component in 2D."""
    if law is None:
        return
    if law.tangential > -1.0:
        inertia = 1.0 / law.inverse_inertia[body]
        width = sqrt(surfaces.level[face] / inertia)
        for k in range(2 if d == 2 else 0, 3):
            one, _, block = normal_pair(surfaces.key, body, number, block)
            spin = width * one
            before = law.spins[body, k]
            add(counters.wall_energy, face, 0.5 * inertia * (before * before - spin * spin))
            law.spins[body, k] = spin


@inner_kernel
def stick_or_leave(rows, body, face, space, masses, counters, law, surfaces):
    """Judge a body at a sticky face by all the normal energy that it has, in flight and in its vibration."""
    axis = face // 2
    column = len(space.lengths) + axis
    side = 1.0 if face % 2 else -1.0
    mass = mass_of(body, masses, law)
    before = side * rows[body, column]
    held = surfaces.held[body, axis]
    energy = held + 0.5 * mass * before * before
    if energy < 0.5 * surfaces.level[face] * surfaces.level[face] / mass:
        surfaces.held[body, axis] = energy
        surfaces.place[body, axis] = 1 if face % 2 else -1
        after = 0.0
    else:
        surfaces.held[body, axis] = 0.0
        surfaces.place[body, axis] = 0
        after = -abs(before) if held == 0.0 else -sqrt(2.0 * energy / mass)
    rows[body, column] = side * after
    add(counters.wall_impulse, face, mass * (before - after))


@inner_kernel
def touch_surface(rows, body, face, space, masses, counters, law, surfaces):
    """Let a face with a kind act on a body that has come to it. False if it is hard."""
    kind = surfaces.kind[face]
    if kind in (THERMAL, THERMAL_NORMAL):
        leave_at_temperature(rows, body, face, space, masses, counters, law, surfaces)
    elif kind == STICKY:
        stick_or_leave(rows, body, face, space, masses, counters, law, surfaces)
    else:
        return False
    return True
