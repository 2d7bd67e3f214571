"""Wells at the container's faces: a step of the potential at a distance from the wall."""

from math import inf, sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import NONE, STICKY, WELL_EDGES
from gaspart.kernels.physics.flight import advance, face_plane
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.per_area import add_per_area, spin_before, velocity_before
from gaspart.kernels.physics.running_sum import add


@inner_helper
def edge_plane(flights, i, face, space, faces):
    """Where the centre of a particle crosses the edge of a face's well."""
    upper = face % 2 == 1
    width = faces.width[face]
    return face_plane(flights, i, face // 2, upper, space) + (-width if upper else width)


@inner_kernel
def time_to_edge(flights, i, axis, space, faces):
    """When a particle that moves along an axis comes to the edge of a well there, or, stuck to a face, is to
    be judged again because a contact has moved it: (time, face code)."""
    v = flights[i].velocity[axis]
    clock = flights[i].clock
    place = faces.place[i, axis]
    upper = place > 0 or (place == 0 and v > 0.0)
    face = 2 * axis + (1 if upper else 0)
    if faces.kind[face] == STICKY and place != 0:
        return clock, face
    if faces.depth[face] > 0.0 and (place == 0 or (v > 0.0) != upper):
        way = edge_plane(flights, i, face, space, faces) - flights[i].position[axis]
        return clock + way / v, WELL_EDGES + face
    return inf, NONE


@inner_helper
def cross_edge(flights, i, face, model, tally, law, faces):
    """Let a particle into a well, or out of it if it is fast enough. The wall takes the momentum of the
    step."""
    axis = face // 2
    flights[i].position[axis] = edge_plane(flights, i, face, model.space, faces)
    side = 1.0 if face % 2 else -1.0
    mass = mass_of(i, model.masses, law)
    step = 2.0 * faces.depth[face] / mass
    before = side * flights[i].velocity[axis]
    if before > 0.0:
        after = sqrt(before * before + step)
        faces.place[i, axis] = 1 if face % 2 else -1
    elif before * before > step:
        after = -sqrt(before * before - step)
        faces.place[i, axis] = 0
    else:
        after = -before
    flights[i].velocity[axis] = side * after
    add(tally.wall_impulse, face, mass * (before - after))


@inner_kernel
def collide_edge(flights, i, face, model, tally, law, faces):
    """`cross_edge` as a function of its own. Returns the number of the face."""
    cross_edge(flights, i, face, model, tally, law, faces)
    return face


@inner_helper
def meet_edge(flights, i, face, time, model, tally, faces):
    """Advance a particle to the edge of a well, and let it in or out. Returns the number of the face."""
    if faces is not None:
        advance(flights, i, time, model.space, model.gravity)
        velocity = velocity_before(flights, i, tally.per_area)
        before = velocity, spin_before(i, model.law, tally.per_area)
        met = collide_edge(flights, i, face - WELL_EDGES, model, tally, model.law, faces)
        add_per_area(flights, i, met, before, model, tally.per_area)
        return met
    return face
