"""The search across sheared faces, whose boxes have no neighbours there: all boxes of the opposite row.

Rows slide past one another, so that any box of one comes to any of the other. Rows of a container of equal
sides hold so few of the particles that on average this is a few boxes for a search.
"""

from math import inf

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.event.box_lists import member, move
from gaspart.kernels.model import BOX_VISITS, PAIR_TESTS
from gaspart.kernels.physics.lees_edwards import FLOW, GRADIENT, time_of_sheared_contact
from gaspart.kernels.physics.periodic import box_coordinate


@inner_kernel
def _search_row(particles, i, row, image, boxes, space, tally, shear):
    """Search the images above (1) or below (-1) of the boxes that have the coordinate `row` across the flow,
    and are beside that of a particle along the third axis."""
    flights, predictions = particles.flights, particles.predictions
    depth = predictions[i].box[2]
    best, found = predictions[i].contact_time, predictions[i].partner
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
                if time < best or (time == best and time < inf and other < found):
                    best, found = time, other
    predictions[i].contact_time = best
    predictions[i].partner = found


@inner_kernel
def _search_sheared(particles, i, boxes, space, tally, crossed, shear):
    at, last = particles.predictions[i].box[GRADIENT], boxes.per_side[GRADIENT] - 1
    if crossed[FLOW] != 0:  # along the row, all of which was searched when the particle came into it
        return
    if at == last:
        _search_row(particles, i, 0, 1, boxes, space, tally, shear)
    if at == 0:
        _search_row(particles, i, last, -1, boxes, space, tally, shear)


@inner_helper
def search_sheared(particles, i, boxes, space, tally, crossed, shear):
    """Predict the contact of a particle with one across a sheared face, if it is earlier than that predicted;
    arguments as of `box_search.find_contact`."""
    if shear is not None:
        _search_sheared(particles, i, boxes, space, tally, crossed, shear)


@inner_helper
def follow(particles, i, axis, boxes, shear):
    """Let a particle that has crossed the periodic face of an axis be found where its image is that has
    entered, if that is displaced."""
    if shear is not None:
        if axis == GRADIENT:
            x = particles.flights[i].position[FLOW]
            move(
                particles.predictions, boxes, i, FLOW,
                box_coordinate(x, boxes.widths[FLOW], boxes.per_side[FLOW]),
            )  # fmt: skip
