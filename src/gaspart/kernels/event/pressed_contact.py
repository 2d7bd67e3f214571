"""Contacts of two particles that gravity presses together, as in a stack at rest.

The lower one rests on a floor, on a wall, or is fixed, so that the upper one falls relative to it and would
meet it infinitely often. Or both are in a row that others press: the slower they are, the more often they
meet, as their momentum times this rate is the force. With a contact duration they part at least so fast that
gravity lets them meet again after a small part of it; this energy, far below that of a fall through a
diameter, is counted as a negative loss.
"""

from math import sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import LOSS
from gaspart.kernels.obstacles.short_bounce import longest_rest
from gaspart.kernels.obstacles.support import release
from gaspart.kernels.obstacles.wedge import rest_in_wedge
from gaspart.kernels.physics.collision import gap_along, push
from gaspart.kernels.physics.contact_duration import SHORTEST, meet_often
from gaspart.kernels.physics.flight import acceleration_of
from gaspart.kernels.physics.running_sum import add


@inner_helper
def least_parting(flights, i, j, space, gravity, law):
    """The least speed at which two particles that touch, and have been advanced to the present time, part; 0
    if nothing presses them together."""
    if gravity is not None:
        if law is not None:
            return _pressed_parting(flights, i, j, space, gravity, law.duration)
    return 0.0


@inner_helper
def _pressed_parting(flights, i, j, space, gravity, duration):
    if duration is not None:
        square = along = whole = 0.0
        for k in range(len(space.lengths)):
            gap = gap_along(flights, i, j, k, space)
            pull = acceleration_of(flights, j, k, space, gravity)
            pull -= acceleration_of(flights, i, k, space, gravity)
            square += gap * gap
            along += gap * pull
            whole += gravity.acceleration[k] * gravity.acceleration[k]
        pressing = max(0.0, -along / sqrt(square))
        if meet_often(flights, i, j, duration):
            pressing = max(pressing, sqrt(whole))
        return pressing * 0.5 * SHORTEST * duration.length
    return 0.0


@inner_kernel
def direction(flights, i, j, space):
    """(3,) the unit vector from a particle to another one."""
    x, y = gap_along(flights, i, j, 0, space), gap_along(flights, i, j, 1, space)
    z = gap_along(flights, i, j, 2, space)
    distance = sqrt(x * x + y * y + z * z)
    return x / distance, y / distance, z / distance


@inner_helper
def part(flights, i, j, least, model, tally, law):
    """Let two particles that have collided part at least so fast."""
    if law is not None:
        _part_pressed(flights, i, j, least, model.space, tally, law, law.duration)


@inner_kernel
def _part_pressed(flights, i, j, least, space, tally, law, duration):
    if duration is None or least == 0.0:
        return
    normal = direction(flights, i, j, space)
    speed = 0.0
    for k in range(len(space.lengths)):
        speed += normal[k] * (flights[j].velocity[k] - flights[i].velocity[k])
    if speed < least:
        mobility = law.inverse_mass[i] + law.inverse_mass[j]
        impulse = (least - speed) / mobility
        push(flights, i, -impulse * law.inverse_mass[i], normal, space)
        push(flights, j, impulse * law.inverse_mass[j], normal, space)
        add(tally.sums, LOSS, -0.5 * (least * least - speed * speed) / mobility)


@inner_helper
def release_pair(flights, i, j, model, tally, gravity, law):
    """Let gravity act in full on two particles that have collided, unless one rests below a fixed one."""
    if gravity is not None:
        _release_from(flights, i, j, model, tally, gravity, law)
        _release_from(flights, j, i, model, tally, gravity, law)


@inner_helper
def _release_from(flights, i, j, model, tally, gravity, law):
    """The same of the first of two particles."""
    if not _rests_below(flights, i, j, model.space, tally, gravity, law):
        release(flights, i, model.space, gravity.support)


@inner_helper
def _rests_below(flights, i, j, space, tally, gravity, law):
    """Let the first of two particles rest in the wedge between what it rests on and a fixed second one.
    Returns whether it does."""
    if law is not None:
        if law.inverse_mass[j] == 0.0:
            return _rests_below_fixed(flights, i, j, space, tally, gravity, law, law.duration)
    return False


@inner_kernel
def _rests_below_fixed(flights, i, j, space, tally, gravity, law, duration):
    if duration is None:
        return False
    normal = direction(flights, i, j, space)
    particle = 1.0 / law.inverse_mass[i], longest_rest(flights, i, gravity, law)
    return rest_in_wedge(flights, i, normal, particle, space, tally, gravity, gravity.support)
