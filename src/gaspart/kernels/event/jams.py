"""Jams: particles that are pressed together between supports.

A jam resembles a row of particles that exactly fills the space between two walls. A force F compresses a row
with the kinetic energy E along the row until the free length x is 2 E/F. So the collision rate grows as the
energy decreases: as E^(-1/2), or as E^(-3/2) if gravity presses a row that is nearly straight, because F then
grows as x^(-1/2). In the TC model these contacts conserve energy. The rate grows without limit if moving
particles next to the row prevent it from becoming an island at rest.

Therefore the particles of a jam are fixed. Two conditions define a jam. No particle has left its position.
Under a tilted gravity no particle would leave it either, because the touching particles that stay support it
(`keep_stable`). So a slow contact could not move a particle far. A contact with a moving particle always
dissipates. In addition, it

- frees the particle of the jam, if it can give the particle a speed above `ContactDuration.moving`;
- frees the whole jam, like an island, if it can give the particle `_FAR` times this speed;
- adds the other particle to the jam, if the two collide so often that the other particle is squeezed.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.model import LOSS, NONE, Support
from gaspart.kernels.obstacles.distance import to_wall
from gaspart.kernels.obstacles.support import leave_of
from gaspart.kernels.physics.contact import SHORTEST
from gaspart.kernels.physics.flight import acceleration_of, advance, advance_coordinate, mark_resting
from gaspart.kernels.physics.periodic import nearest
from gaspart.kernels.physics.running_sum import add

# Search for particles of a scene under gravity that have come to rest.


TOUCHES, MOVES, RESTS = range(3)  # rows of marks in `find_resting`
_PAUSE = 4.0  # longest time between contacts of a supported particle, in contact durations


@inner_helper
def _lies(flights, i, space, gravity):
    """Return True if a particle is fixed, or at rest on faces or interior walls."""
    lies = True
    for k in range(len(space.lengths)):
        lies &= flights[i].velocity[k] == 0.0 and acceleration_of(flights, i, k, space, gravity) == 0.0
    return lies


@kernel
def find_resting(flights, before, time, most, model, marks):
    """Mark (3, N) particles that touch others, particles that move, and particles at rest. A particle touches
    others if it has lasting contacts. A particle moves if it is farther than `most` from its position in
    `before` (N, d), which is then updated. A particle is at rest if it does not move, and either touches
    others or lies on a wall.
    """
    space, gravity, duration = model.space, model.gravity, model.law.duration
    for i in range(len(flights)):
        marks[TOUCHES, i] = time - duration.latest[i] < _PAUSE * duration.length
        square = 0.0
        for k in range(len(space.lengths)):
            pull = acceleration_of(flights, i, k, space, gravity)
            late = time - flights[i].clock
            x = advance_coordinate(flights[i].position[k], flights[i].velocity[k], pull, late)
            square += (x - before[i, k]) * (x - before[i, k])
            before[i, k] = x
        marks[MOVES, i] = square > most * most
        stays = marks[TOUCHES, i] or _lies(flights, i, space, gravity)
        marks[RESTS, i] = stays and not marks[MOVES, i]


@inner_kernel
def stop(flights, i, time, model, tally):
    """Advance a particle to `time` and stop it; its energy counts as dissipated."""
    advance(flights, i, time, model.space, model.gravity)
    square = 0.0
    for k in range(len(model.space.lengths)):
        square += flights[i].velocity[k] * flights[i].velocity[k]
        flights[i].velocity[k] = 0.0
    if square > 0.0:
        add(tally.sums, LOSS, 0.5 * square / model.law.inverse_mass[i])


@kernel
def stop_all(flights, time, model, tally):
    """Stop every particle."""
    for i in range(len(flights)):
        stop(flights, i, time, model, tally)


# Islands: particles that support one another and are at rest, while particles elsewhere move.
#
# With a contact duration, a settled pile has tiny elastic contacts forever. An island has no events, because
# gravity does not act on it until another particle collides with one of its particles.


@inner_helper
def root_of(parent, i):
    """Return the root of the tree of a particle, and shorten paths for the next search."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@inner_kernel
def gap_between(flights, positions, i, j, space):
    """Return the gap between the surfaces of two particles at their positions (N, d)."""
    square = 0.0
    for k in range(len(space.lengths)):
        part = nearest(positions[j, k] - positions[i, k], space.lengths[k], space.periodic[k])
        square += part * part
    return sqrt(square) - flights[i].radius - flights[j].radius


@kernel
def join(flights, order, positions, axis, reach, space, parent):
    """Join particles with gaps of at most `reach` into trees; `parent` (N,) are the parents. `order`: (M,),
    these particles, sorted by their coordinate along a nonperiodic axis.
    """
    largest = 0.0
    for i in order:
        parent[i] = i
        largest = max(largest, flights[i].radius)
    for first in range(len(order)):
        i = order[first]
        furthest = positions[i, axis] + flights[i].radius + largest + reach
        for second in range(first + 1, len(order)):
            j = order[second]
            if positions[j, axis] > furthest:
                break
            if gap_between(flights, positions, i, j, space) <= reach:
                parent[root_of(parent, j)] = root_of(parent, i)


@kernel
def hold(flights, order, time, marks, parent, model, tally):
    """Fix the particles of each tree in which all particles rest and some touch others. Returns True if there
    are any such trees. `order`: particles. `marks`: (3, N), see `find_resting`; overwritten with marks of the
    trees.
    """
    touches, rests = marks[TOUCHES], marks[RESTS]
    island, any_held = model.law.duration.island, False
    for i in order:
        root = root_of(parent, i)
        touches[root] |= touches[i]
        rests[root] &= rests[i]
    for i in order:
        root = root_of(parent, i)
        if rests[root] and touches[root]:
            stop(flights, i, time, model, tally)
            island[i] = root
            model.gravity.fixed[i] = True
            any_held = True
    return any_held


@inner_kernel
def wake_island(flights, number, time, boxes, model, gravity, law):
    """Free the particles of an island, so that gravity and contacts act on them again."""
    if gravity is not None:
        for i in range(len(flights)):
            if law.duration.island[i] == number:
                gravity.fixed[i] = False
                law.inverse_mass[i] = law.duration.inverse_mass[i]
                flights[i].clock = time
                mark_resting(flights, i, model.space, gravity, boxes.resting)


STAYS, HELD, PRESSED = range(3)  # marks (3, N): has not moved or is fixed; may be fixed; has many contacts
_FAR = 8.0  # speed that frees a jam divided by the speed that frees a particle; in heights the ratio is 64
_OFTEN = 2.0**-3 * SHORTEST  # longest time between contacts of a squeezed particle, in contact durations


class Line(NamedTuple):
    """Particles sorted along a nonperiodic axis."""

    order: np.ndarray
    positions: np.ndarray
    axis: int


class Limits(NamedTuple):
    """Disturbances that a stable particle withstands."""

    pulls: np.ndarray
    least: float
    reach: float
    support: Support


@inner_helper
def is_jammed(duration, i):
    """Return True if a particle belongs to a jam, an island numbered N or higher."""
    return duration.island[i] >= len(duration.island)


@inner_helper
def free(i, gravity, law):
    """Remove a particle from its jam."""
    law.inverse_mass[i] = law.duration.inverse_mass[i]
    gravity.fixed[i] = False
    law.duration.island[i] = NONE


@inner_helper
def free_if_moved(i, j, rr, rv, gravity, law):
    """Free particles of a jam among two colliding particles, if their contact can move them. `rr` and `rv`:
    products of their separation and relative velocity.
    """
    if gravity is not None:
        if law is not None:
            _free_if_moved(i, j, rr, rv, gravity, law, law.duration)


@inner_kernel
def _free_if_moved(i, j, rr, rv, gravity, law, duration):
    if duration is None:
        return
    least = duration.moving * (duration.inverse_mass[i] + duration.inverse_mass[j]) * sqrt(rr)
    for particle in (i, j):
        if is_jammed(duration, particle):
            change = 2.0 * abs(rv) * duration.inverse_mass[particle]
            if change > _FAR * least:
                law.inverse_mass[particle] = duration.inverse_mass[particle]  # so that `loop.wake` frees all
            elif change > least:
                free(particle, gravity, law)


@inner_helper
def pressed_particle(flights, i, j, law):
    """Return the particle, both at their contact, that the other one's jam presses, or NONE."""
    if law is not None:
        return _pressed_particle(flights, i, j, law, law.duration)
    return NONE


@inner_helper
def _pressed_particle(flights, i, j, law, duration):
    if duration is not None:
        late = flights[i].clock - min(duration.latest[i], duration.latest[j])
        if late < _OFTEN * duration.length:
            if is_jammed(duration, i) and law.inverse_mass[j] > 0.0:
                return j
            if is_jammed(duration, j) and law.inverse_mass[i] > 0.0:
                return i
    return NONE


@inner_helper
def join_jam(flights, i, j, model, tally, gravity, law):
    """Add particle i to the jam of particle j after their collision; NONE has no effect."""
    if gravity is not None:
        if law is not None:
            _join_jam(flights, i, j, model, tally, gravity, law, law.duration)


@inner_helper
def _join_jam(flights, i, j, model, tally, gravity, law, duration):
    if duration is not None:
        if i != NONE:
            stop(flights, i, flights[i].clock, model, tally)
            _fix(i, duration.island[j], gravity, law)


@inner_helper
def _fix(i, number, gravity, law):
    """Add a particle at rest to the jam with this number."""
    law.inverse_mass[i] = 0.0
    gravity.fixed[i] = True
    law.duration.island[i] = number


@inner_helper
def _add(support, x, y, z):
    """Add a plane, given by its unit vector towards the particle; ignore excess planes."""
    n = support.number[0]
    if n < support.normal.shape[1]:
        support.normal[0, n, 0], support.normal[0, n, 1], support.normal[0, n, 2] = x, y, z
        support.number[0] = n + 1


@inner_helper
def _add_particle(flights, positions, i, j, space, limits):
    """Add particle j to the support of particle i, if they touch."""
    if gap_between(flights, positions, i, j, space) <= limits.reach:
        x = y = z = 0.0
        for k in range(len(space.lengths)):
            part = nearest(positions[i, k] - positions[j, k], space.lengths[k], space.periodic[k])
            x, y, z = part if k == 0 else x, part if k == 1 else y, part if k == 2 else z
        distance = sqrt(x * x + y * y + z * z)
        _add(limits.support, x / distance, y / distance, z / distance)


@inner_helper
def _add_faces(flights, positions, i, space, limits):
    """Add the container's faces that the particle touches."""
    near = space.margin * flights[i].radius + limits.reach
    for k in range(len(space.lengths)):
        x, y, z = 1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0
        if not space.periodic[k] and positions[i, k] <= near:
            _add(limits.support, x, y, z)
        if not space.periodic[k] and space.lengths[k] - positions[i, k] <= near:
            _add(limits.support, -x, -y, -z)


@inner_helper
def _add_walls(flights, positions, i, space, limits, walls):
    """Add the interior walls that the particle touches."""
    if walls is not None:
        for m in range(len(walls.rows)):
            x, y, z = to_wall(walls.rows, m, positions[i], space.lengths)
            distance = sqrt(x * x + y * y + z * z)
            if 0.0 < distance <= flights[i].radius + limits.reach:
                _add(limits.support, -x / distance, -y / distance, -z / distance)


@inner_kernel
def _is_stable(flights, n, largest, line, limits, model, stays):
    """Return True if the fixed supports leave little of every acceleration of a particle. `n`: index of the
    particle in the line. `largest`: largest radius.
    """
    order, positions, axis = line
    i, support = order[n], limits.support
    support.number[0] = 0
    _add_faces(flights, positions, i, model.space, limits)
    _add_walls(flights, positions, i, model.space, limits, model.walls)
    far = flights[i].radius + largest + limits.reach
    for step in (-1, 1):
        other = n + step
        while 0 <= other < len(order) and abs(positions[order[other], axis] - positions[i, axis]) <= far:
            if stays[order[other]]:
                _add_particle(flights, positions, i, order[other], model.space, limits)
            other += step
    for m in range(len(limits.pulls)):
        pull = limits.pulls[m, 0], limits.pulls[m, 1], limits.pulls[m, 2]
        if leave_of(pull, support, 0, len(model.space.lengths)) > limits.least * limits.least:
            return False
    return True


@kernel
def keep_stable(flights, line, limits, model, marks):
    """Remove the mark HELD of particles in a line that are not supported in their positions. Supports are the
    other marked particles, fixed particles and walls. The search is repeated until no mark changes.
    """
    stays, held, largest, changed = marks[STAYS], marks[HELD], 0.0, True
    for i in line.order:
        largest = max(largest, flights[i].radius)
    while changed:
        changed = False
        for n in range(len(line.order)):
            i = line.order[n]
            if held[i] and not _is_stable(flights, n, largest, line, limits, model, stays):
                stays[i] = held[i] = False
                changed = True


@kernel
def free_unstable(flights, time, marks, model):
    """Free the particles of jams that are no longer supported; return True if there are any."""
    any_free = False
    for i in range(len(flights)):
        if is_jammed(model.law.duration, i) and not marks[HELD, i]:
            flights[i].clock = time
            free(i, model.gravity, model.law)
            any_free = True
    return any_free


@kernel
def jam(flights, order, time, marks, parent, model, tally):
    """Fix the particles (M,) of trees with a pressed or fixed particle; return True if any are new."""
    pressed, duration, any_new = marks[PRESSED], model.law.duration, False
    for i in order:
        pressed[root_of(parent, i)] |= pressed[i] or is_jammed(duration, i)
    for i in order:
        root = root_of(parent, i)
        if pressed[root]:
            if not is_jammed(duration, i):
                stop(flights, i, time, model, tally)
                any_new = True
            _fix(i, len(flights) + root, model.gravity, model.law)
    return any_new
