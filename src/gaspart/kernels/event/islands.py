"""Islands: particles that lean on one another and are at rest, while others move elsewhere.

With a contact duration a pile that has settled goes on with tiny elastic contacts for ever. An island has no
events: gravity does not act on it until another particle meets one of it.
"""

from math import sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel, kernel
from gaspart.kernels.event.scene_at_rest import RESTS, TOUCHES, stop
from gaspart.kernels.physics.flight import mark_resting
from gaspart.kernels.physics.periodic import nearest


@inner_helper
def root_of(parent, i):
    """The root of a particle's tree, with shorter ways to it for the next search."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@inner_kernel
def gap_between(flights, places, i, j, space):
    """Between the surfaces of two particles at their places (N, d)."""
    square = 0.0
    for k in range(len(space.lengths)):
        part = nearest(places[j, k] - places[i, k], space.lengths[k], space.periodic[k])
        square += part * part
    return sqrt(square) - flights[i].radius - flights[j].radius


@kernel
def join(flights, order, places, axis, reach, space, parent):
    """Join particles whose gaps are at most `reach` in trees with the parents (N,). order (M,): these
    particles, by their coordinate along an axis that is not periodic."""
    largest = 0.0
    for i in order:
        parent[i] = i
        largest = max(largest, flights[i].radius)
    for first in range(len(order)):
        i = order[first]
        furthest = places[i, axis] + flights[i].radius + largest + reach
        for second in range(first + 1, len(order)):
            j = order[second]
            if places[j, axis] > furthest:
                break
            if gap_between(flights, places, i, j, space) <= reach:
                parent[root_of(parent, j)] = root_of(parent, i)


@kernel
def hold(flights, order, time, marks, parent, model, tally):
    """Hold those of these particles that belong to a tree of which all rest, and some touch others: `marks`
    (3, N), see `scene_at_rest.find_resting`, which become those of the trees. Returns whether there are any.
    """
    touches, rests = marks[TOUCHES], marks[RESTS]
    island, found = model.law.duration.island, False
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
            found = True
    return found


@inner_kernel
def wake_island(flights, number, time, boxes, model, gravity, law):
    """Let gravity act again on the particles of an island, and contacts move them."""
    if gravity is not None:
        for i in range(len(flights)):
            if law.duration.island[i] == number:
                gravity.fixed[i] = False
                law.inverse_mass[i] = law.duration.inverse_mass[i]
                flights[i].clock = time
                mark_resting(flights, i, model.space, gravity, boxes.resting)
