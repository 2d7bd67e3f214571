"""Particles too large for the boxes: how they are searched for, and search.

A small particle tests the oversized ones that are near its box; an oversized one tests the particles in all
boxes that are near its own, and all other oversized ones. Whether two boxes are near, for an oversized
particle, follows from their numbers alone, so it is the same seen from either; and no contact can occur
between particles whose boxes are not. A particle that passes into another box searches what has become near.
"""

from math import inf, sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.event.box_lists import member
from gaspart.kernels.model import BOX_VISITS, NONE, PAIR_TESTS
from gaspart.kernels.physics.flight import time_of_contact

_SLACK = 1e-9  # by which neighbourhoods are drawn wider, so that rounding hides no contact


@inner_helper
def reach_square(flights, i, oversized):
    """Square of the greatest distance between the centre of an oversized particle and of a small one that
    touches it."""
    reach = (flights[i].radius + oversized.largest_radius) * (1.0 + _SLACK)
    return reach * reach


@inner_helper
def gap_square(steps, width):
    """Square of the gap along an axis between boxes that are so many steps apart."""
    gap = max(abs(steps) - 1, 0) * width
    return gap * gap


@inner_helper
def near(x, y, z, widths, square):
    """Whether boxes these steps apart hold points nearer than the root of `square`."""
    return gap_square(x, widths[0]) + gap_square(y, widths[1]) + gap_square(z, widths[2]) < square


@inner_helper
def newly_near(x, y, z, crossed, widths, square):
    """The same, but for boxes that were near before a step `crossed` (3,) into another box, if there was
    one."""
    all_new = crossed[0] == 0 and crossed[1] == 0 and crossed[2] == 0
    return near(x, y, z, widths, square) and (
        all_new or not near(x + crossed[0], y + crossed[1], z + crossed[2], widths, square)
    )


@inner_kernel
def images_along(axis, space):
    """How many images of the container to search on either side along an axis."""
    return 1 if axis < len(space.lengths) and space.periodic[axis] else 0


@inner_kernel
def test_pair(particles, i, other, image, space, tally, gravity):
    """Predict the contact with another particle in an image (3,) of the container, if it is the earliest so
    far."""
    d = len(space.lengths)
    predictions = particles.predictions
    offset = image[0] * space.lengths[0], image[1] * space.lengths[1], image[2] * space.lengths[d - 1]
    tally.counts[PAIR_TESTS] += 1
    time = time_of_contact(particles.flights, i, other, offset, space, gravity)
    before = predictions[i].contact_time
    if time < before or (time == before and time < inf and other < predictions[i].partner):
        predictions[i].contact_time = time
        predictions[i].partner = other


@inner_kernel
def find_oversized(particles, i, boxes, space, tally, crossed, gravity, oversized):
    """Search for an earlier contact of a small particle with the oversized ones near its box; if it has
    crossed into that box by `crossed` (3,), with those only that were not near before."""
    here, n, widths = particles.predictions[i].box, boxes.per_side, boxes.widths
    images_x, images_y, images_z = images_along(0, space), images_along(1, space), images_along(2, space)
    for m in range(len(oversized.particles)):
        other = oversized.particles[m]
        there = particles.predictions[other].box
        square = reach_square(particles.flights, other, oversized)
        for c in range(-images_z, images_z + 1):
            z = there[2] + c * n[2] - here[2]
            for b in range(-images_y, images_y + 1):
                y = there[1] + b * n[1] - here[1]
                for a in range(-images_x, images_x + 1):
                    x = there[0] + a * n[0] - here[0]
                    if newly_near(x, y, z, crossed, widths, square):
                        test_pair(particles, i, other, (a, b, c), space, tally, gravity)


@inner_helper
def span(here, n, width, square, periodic):
    """The first and last coordinate of boxes along an axis that may be near; on a periodic axis they go on
    beyond the container."""
    steps = int(sqrt(square) / width) + 2
    if periodic:
        return here - min(steps, n), here + min(steps, n)
    return max(here - steps, 0), min(here + steps, n - 1)


@inner_helper
def image_of(coordinate, n):
    """In which image of the container a box coordinate lies."""
    return 1 if coordinate >= n else (-1 if coordinate < 0 else 0)


@inner_kernel
def find_around(particles, i, boxes, space, tally, crossed, gravity, oversized):
    """Search for an earlier contact of an oversized particle with all the particles in boxes near its own; if
    it has crossed into that box by `crossed` (3,), in those only that were not near before."""
    here, n, widths = particles.predictions[i].box, boxes.per_side, boxes.widths
    square = reach_square(particles.flights, i, oversized)
    first_x, last_x = span(here[0], n[0], widths[0], square, images_along(0, space) > 0)
    first_y, last_y = span(here[1], n[1], widths[1], square, images_along(1, space) > 0)
    first_z, last_z = span(here[2], n[2], widths[2], square, images_along(2, space) > 0)
    for z in range(first_z, last_z + 1):
        c = image_of(z, n[2])
        plane = (z - c * n[2]) * boxes.strides[2]
        for y in range(first_y, last_y + 1):
            b = image_of(y, n[1])
            line = plane + (y - b * n[1]) * boxes.strides[1]
            for x in range(first_x, last_x + 1):
                if not newly_near(x - here[0], y - here[1], z - here[2], crossed, widths, square):
                    continue
                a = image_of(x, n[0])
                tally.counts[BOX_VISITS] += 1
                box = line + (x - a * n[0]) * boxes.strides[0]
                other = NONE
                for m in range(boxes.filled[box]):
                    other = int(member(boxes, box, m, other))
                    if other != i:
                        test_pair(particles, i, other, (a, b, c), space, tally, gravity)


@inner_kernel
def find_other_oversized(particles, i, space, tally, gravity, oversized):
    """Search for an earlier contact of an oversized particle with the other oversized ones."""
    images_x, images_y, images_z = images_along(0, space), images_along(1, space), images_along(2, space)
    for m in range(len(oversized.particles)):
        other = oversized.particles[m]
        if other == i:
            continue
        for c in range(-images_z, images_z + 1):
            for b in range(-images_y, images_y + 1):
                for a in range(-images_x, images_x + 1):
                    test_pair(particles, i, other, (a, b, c), space, tally, gravity)


@inner_helper
def search_oversized(particles, i, boxes, space, tally, crossed, gravity, oversized):
    """What `find_contact` leaves to be searched where there are oversized particles; `crossed` (3,): the step
    into the next box that the particle has just made, or none."""
    if oversized is not None:
        if particles.flights[i].radius <= oversized.largest_radius:
            find_oversized(particles, i, boxes, space, tally, crossed, gravity, oversized)
        else:
            find_around(particles, i, boxes, space, tally, crossed, gravity, oversized)
            find_other_oversized(particles, i, space, tally, gravity, oversized)
