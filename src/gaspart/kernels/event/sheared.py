"""Search across sheared faces, in all boxes of the opposite row.

Boxes have no fixed neighbours across sheared faces: rows slide past each other, so any box of one row passes
any box of the other. In a container with equal sides a row contains so few of the particles that this amounts
to a few boxes per search on average.
"""

from __future__ import annotations

from math import inf

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.event.boxes import member, move
from gaspart.kernels.model import BOX_VISITS, PAIR_TESTS
from gaspart.kernels.physics.lees_edwards import (
    FLOW,
    GRADIENT,
    UPPER_FACE,
    displacement,
    time_of_sheared_contact,
)
from gaspart.kernels.physics.mass import mass_of
from gaspart.kernels.physics.periodic import box_coordinate, nearest
from gaspart.kernels.physics.running_sum import add


@inner_kernel
def _search_row(particles, i, row, image, boxes, space, tally, shear):
    """Search the images above (1) or below (-1) of a row of boxes. The boxes have the coordinate `row` across
    the flow, and are neighbours of the particle's box along the third axis.
    """
    flights, predictions = particles.flights, particles.predictions
    depth = predictions[i].box[2]
    best, partner = predictions[i].contact_time, predictions[i].partner
    for step in range(3):
        beside = boxes.neighbour[2, depth, step]
        if beside < 0:
            continue
        offset = boxes.shift[2, depth, step] * space.lengths[len(space.lengths) - 1]
        tally.counts[BOX_VISITS] += boxes.per_side[FLOW]
        for x in range(boxes.per_side[FLOW]):
            box = x * boxes.strides[FLOW] + row * boxes.strides[GRADIENT] + beside
            other = 0
            for n in range(boxes.filled[box]):
                other = member(boxes, box, n, other)
                if other == i:
                    continue
                tally.counts[PAIR_TESTS] += 1
                time = time_of_sheared_contact(flights, i, other, image, offset, space, shear)
                if time < best or (time == best and time < inf and other < partner):
                    best, partner = time, other
    predictions[i].contact_time = best
    predictions[i].partner = partner


@inner_kernel
def _search_sheared(particles, i, boxes, space, tally, crossed, shear):
    at, last = particles.predictions[i].box[GRADIENT], boxes.per_side[GRADIENT] - 1
    if crossed[FLOW] != 0:  # the whole row was searched when the particle entered its row
        return
    if at == last:
        _search_row(particles, i, 0, 1, boxes, space, tally, shear)
    if at == 0:
        _search_row(particles, i, last, -1, boxes, space, tally, shear)


@inner_helper
def search_sheared(particles, i, boxes, space, tally, crossed, shear):
    """Predict an earlier contact across a sheared face; `boxes.find_contact` explains the arguments."""
    if shear is not None:
        _search_sheared(particles, i, boxes, space, tally, crossed, shear)


@inner_helper
def follow(particles, i, axis, boxes, shear):
    """Move a particle that has crossed a sheared face into the box of its displaced image."""
    if shear is not None:
        if axis == GRADIENT:
            x = particles.flights[i].position[FLOW]
            move(
                particles.predictions, boxes, i, FLOW,
                box_coordinate(x, boxes.widths[FLOW], boxes.per_side[FLOW]),
            )  # fmt: skip


# Contacts across sheared faces: the second particle is replaced by its image, and then moved back.


@inner_helper
def unfold(flights, i, j, time, space, shear):
    """Move the second particle of a contact across a sheared face to its image. It is the image next to the
    first particle. Returns 1 if the image is above, -1 if below, and 0 otherwise.
    """
    if shear is None:
        return 0
    return _unfold(flights, i, j, time, space, shear)


@inner_kernel
def _unfold(flights, i, j, time, space, shear):
    height, length = space.lengths[GRADIENT], space.lengths[FLOW]
    gap = flights[j].position[GRADIENT] - flights[i].position[GRADIENT]
    image = 0
    if gap + gap > height:
        image = -1
    elif gap + gap < -height:
        image = 1
    if image != 0:
        shear.kept[0], shear.kept[1] = flights[j].position[FLOW], flights[j].position[GRADIENT]
        flights[j].position[GRADIENT] += image * height
        x = flights[i].position[FLOW]
        gap = flights[j].position[FLOW] - x + image * displacement(time, shear) % length
        while gap + gap > length or gap + gap < -length:
            gap = nearest(gap, length, True)
        flights[j].position[FLOW] = x + gap
        flights[j].velocity[FLOW] += image * shear.velocity
        shear.kept[2] = flights[j].velocity[FLOW]
    return image


@inner_helper
def fold(flights, j, image, model, tally, shear):
    """Move the second particle back, and add the energy that the faces receive. The change of its velocity is
    the same as for its image, but the change of its energy differs.
    """
    if shear is not None:
        _fold(flights, j, image, model, tally, shear)


@inner_kernel
def _fold(flights, j, image, model, tally, shear):
    if image != 0:
        flights[j].position[FLOW], flights[j].position[GRADIENT] = shear.kept[0], shear.kept[1]
        change = flights[j].velocity[FLOW] - shear.kept[2]
        flights[j].velocity[FLOW] -= image * shear.velocity
        mass = mass_of(j, model.masses, model.law)
        add(tally.wall_energy, UPPER_FACE, image * shear.velocity * mass * change)
