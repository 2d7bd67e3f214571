"""Jams: particles pressed together between supports, as a row that exactly fills the room between two walls.

The smaller their gaps are, the more often they meet: a row with the energy E and the room x that others press
together with a force F has x = 2 E/F, and meets at a rate that grows as E^(-1/2), or faster where the force
grows as the row straightens. It never ends, since in the model of contacts that last these keep their energy,
and it goes on while particles move beside it. Particles of a jam are fixed. They have not left their places,
and would not if gravity were tilted: so slow contacts could not move them either. A faster one frees all.
"""

from math import sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.event.islands import gap_between, root_of
from gaspart.kernels.event.scene_at_rest import stop
from gaspart.kernels.model import NONE
from gaspart.kernels.obstacles.distance import to_wall
from gaspart.kernels.obstacles.support import leave_of
from gaspart.kernels.physics.periodic import nearest

_FAR = 8.0
_OFTEN = 2.0**-10
STAYS, HOLDS, PRESSED = range(3)  # of marks (3, N): what may be held or is fixed, is held, has many contacts


@inner_helper
def is_jammed(duration, i):
    """Whether a particle belongs to a jam: an island with a number from N on."""
    return duration.island[i] >= len(duration.island)


@inner_helper
def free_if_moved(i, j, rr, rv, gravity, law):
    """Let a contact move those of two particles that a jam holds, if it can give them such a speed. rr, rv:
    products of their separation and relative velocity."""
    if gravity is not None:
        if law is not None:
            _free_if_moved(i, j, rr, rv, gravity, law, law.duration)


@inner_helper
def free(i, gravity, law):
    """Let a particle belong to no jam any more."""
    law.inverse_mass[i] = law.duration.inverse_mass[i]
    gravity.fixed[i] = False
    law.duration.island[i] = NONE


@inner_helper
def is_squeezed(flights, i, j, law):
    """Whether a contact, before it happens, is one of a particle and a jam that meet far more often than by
    gravity."""
    if law is not None:
        return _is_squeezed(flights, i, j, law, law.duration)
    return False


@inner_helper
def _is_squeezed(flights, i, j, law, duration):
    if duration is not None:
        if (law.inverse_mass[i] == 0.0) != (law.inverse_mass[j] == 0.0):
            if is_jammed(duration, i) != is_jammed(duration, j):
                late = flights[i].clock - min(duration.latest[i], duration.latest[j])
                return late < _OFTEN * duration.length
    return False


@inner_helper
def join_jam(flights, i, j, time, squeezed, model, tally, gravity, law):
    """Let a particle that was `squeezed` belong to the jam that it has met."""
    if gravity is not None:
        if law is not None:
            _join_jam(flights, i, j, time, squeezed, model, tally, gravity, law, law.duration)


@inner_helper
def _join_jam(flights, i, j, time, squeezed, model, tally, gravity, law, duration):
    if duration is not None:
        if squeezed:
            joins, other = (j, i) if is_jammed(duration, i) else (i, j)
            stop(flights, joins, time, model, tally)
            law.inverse_mass[joins] = 0.0
            gravity.fixed[joins] = True
            duration.island[joins] = duration.island[other]


@inner_kernel
def _free_if_moved(i, j, rr, rv, gravity, law, duration):
    if duration is None:
        return
    mobility = duration.inverse_mass[i] + duration.inverse_mass[j]
    for particle in (i, j):
        if is_jammed(duration, particle):
            given = 2.0 * rv * duration.inverse_mass[particle]
            ratio = given * given / (duration.moving * duration.moving * mobility * mobility * rr)
            if ratio > _FAR * _FAR:
                law.inverse_mass[particle] = duration.inverse_mass[particle]
            elif ratio > 1.0:
                free(particle, gravity, law)


@inner_helper
def _add(support, x, y, z):
    """Add a plane with this unit vector towards the particle; what is too many is left out."""
    n = support.number[0]
    if n < support.normal.shape[1]:
        support.normal[0, n, 0], support.normal[0, n, 1], support.normal[0, n, 2] = x, y, z
        support.number[0] = n + 1


@inner_helper
def _add_particle(flights, places, i, j, reach, space, support):
    """Add what particle i touches, with a gap of at most `reach`: particle j."""
    if gap_between(flights, places, i, j, space) > reach:
        return
    x, y, z, square = 0.0, 0.0, 0.0, 0.0
    for k in range(len(space.lengths)):
        part = nearest(places[i, k] - places[j, k], space.lengths[k], space.periodic[k])
        square += part * part
        x, y, z = part if k == 0 else x, part if k == 1 else y, part if k == 2 else z
    distance = sqrt(square)
    _add(support, x / distance, y / distance, z / distance)


@inner_helper
def _add_faces(flights, places, i, reach, space, support):
    """The same of the container's faces."""
    for k in range(len(space.lengths)):
        inset = space.margin * flights[i].radius
        if not space.periodic[k] and places[i, k] - inset <= reach:
            _add(support, 1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
        if not space.periodic[k] and space.lengths[k] - places[i, k] - inset <= reach:
            _add(support, -1.0 if k == 0 else 0.0, -1.0 if k == 1 else 0.0, -1.0 if k == 2 else 0.0)


@inner_helper
def _add_walls(flights, places, i, reach, space, support, walls):
    """The same of interior walls."""
    if walls is not None:
        for m in range(len(walls.rows)):
            x, y, z = to_wall(walls.rows, m, places[i], space.lengths)
            distance = sqrt(x * x + y * y + z * z)
            if distance > 0.0 and distance - flights[i].radius <= reach:
                _add(support, -x / distance, -y / distance, -z / distance)


@inner_kernel
def _is_stable(flights, order, n, places, axis, largest, most, pulls, model, stays, support):
    """Whether what the particle order[n] touches, and stays, leaves nothing of these accelerations (M, 3)
    that could move it by more than a reach. most: this reach, and the least such acceleration."""
    i, (reach, least) = order[n], most
    support.number[0] = 0
    _add_faces(flights, places, i, reach, model.space, support)
    _add_walls(flights, places, i, reach, model.space, support, model.walls)
    far = flights[i].radius + largest + reach
    for step in (-1, 1):
        other = n + step
        while 0 <= other < len(order) and abs(places[order[other], axis] - places[i, axis]) <= far:
            if stays[order[other]]:
                _add_particle(flights, places, i, order[other], reach, model.space, support)
            other += step
    for m in range(len(pulls)):
        pull = pulls[m, 0], pulls[m, 1], pulls[m, 2]
        if leave_of(pull, support, 0, len(model.space.lengths)) > least * least:
            return False
    return True


@kernel
def keep_stable(flights, order, places, axis, most, pulls, model, marks, support):
    """Take from the particles that may be held, marks[HOLDS], those that the others, what is fixed and walls
    do not support: `_is_stable`. order (M,): these and fixed ones, by their coordinate along an axis that is
    not periodic; support: of one particle, to work with."""
    stays, holds, largest, changed = marks[STAYS], marks[HOLDS], 0.0, True
    for i in order:
        largest = max(largest, flights[i].radius)
    while changed:
        changed = False
        for n in range(len(order)):
            i = order[n]
            if holds[i] and not _is_stable(
                flights, order, n, places, axis, largest, most, pulls, model, stays, support
            ):
                stays[i] = holds[i] = False
                changed = True


@kernel
def free_unstable(flights, time, marks, model):
    """Free particles of jams that are supported no more. Returns whether there are any."""
    found = False
    for i in range(len(flights)):
        if is_jammed(model.law.duration, i) and not marks[HOLDS, i]:
            flights[i].clock = time
            free(i, model.gravity, model.law)
            found = True
    return found


@kernel
def jam(flights, order, time, marks, parent, model, tally):
    """Hold those of these particles (M,) that belong to a tree with one that has many contacts, or that a jam
    holds already. Returns whether any has not been held before."""
    law, pressed, found = model.law, marks[PRESSED], False
    duration = law.duration
    for i in order:
        pressed[root_of(parent, i)] |= pressed[i] or is_jammed(duration, i)
    for i in order:
        root = root_of(parent, i)
        if pressed[root]:
            found |= not is_jammed(duration, i)
            if not is_jammed(duration, i):
                stop(flights, i, time, model, tally)
            law.inverse_mass[i] = 0.0
            model.gravity.fixed[i] = True
            duration.island[i] = len(flights) + root
    return found
