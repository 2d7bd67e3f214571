"""Search of all pairs before every event (Spencer 2021, section 3.1).

The other searches are tested against it.
"""

from math import inf

from gaspart.kernels.compile.policy import inner_helper
from gaspart.kernels.model import NONE, PAIR_TESTS
from gaspart.kernels.obstacles.face import next_face
from gaspart.kernels.obstacles.interior_wall import find_wall
from gaspart.kernels.physics.flight import time_of_contact
from gaspart.kernels.physics.lees_edwards import FLOW, GRADIENT, time_of_sheared_contact


@inner_helper
def image_offset(image, space):
    """Return the displacement (3,) of one of the 3^d images, and True if it exists."""
    x, y, z = image % 3 - 1, image // 3 % 3 - 1, image // 9 - 1 if len(space.lengths) == 3 else 0
    last = len(space.lengths) - 1
    absent = (x != 0 and not space.periodic[0]) or (y != 0 and not space.periodic[1])
    absent = absent or (z != 0 and not space.periodic[last])
    return (x * space.lengths[0], y * space.lengths[1], z * space.lengths[last]), not absent


@inner_helper
def time_in_image(flights, i, j, offset, space, gravity, shear):
    """Return the time at which two particles touch if the second is displaced by `offset` (3,). Across
    sheared faces particle j is also displaced by the shear; then one image represents all images along the
    flow.
    """
    if shear is not None:
        if offset[GRADIENT] != 0.0:
            if offset[FLOW] != 0.0:
                return inf
            image = 1 if offset[GRADIENT] > 0.0 else -1
            return time_of_sheared_contact(flights, i, j, image, offset[2], space, shear)
    return time_of_contact(flights, i, j, offset, space, gravity)


@inner_helper
def first_of_all(particles, boxes, model, tally):
    """Return the earliest of all events: (time, particle, partner, face code). NONE represents a missing
    particle, partner or face. `boxes` is a single box. No predictions are stored, so none can be outdated.
    """
    flights, space, gravity = particles.flights, model.space, model.gravity
    soon = inf
    first = second = face = NONE
    for i in range(len(flights)):
        time, code = next_face(particles, i, boxes, space, -inf, gravity, model.faces, None)
        time, code = find_wall(particles, i, boxes, space, gravity, model.walls, time, code)
        if time < soon:
            soon, first, face = time, i, code
    for i in range(len(flights)):
        for j in range(i + 1, len(flights)):
            for image in range(3 ** len(space.lengths)):
                offset, present = image_offset(image, space)
                if present:
                    tally.counts[PAIR_TESTS] += 1
                    time = time_in_image(flights, i, j, offset, space, gravity, model.shear)
                    if time < soon:
                        soon, first, second = time, i, j
    return soon, first, second, face
