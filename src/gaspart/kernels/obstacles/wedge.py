"""Particles that slide along a wall into an acute wedge, under an overhanging wall or fixed particle.

This throws the particle down; it comes to rest below, and is under it again at once, at less of its speed:
for ever, in no time. It comes to rest between both; what remains is its velocity along both.
"""

from math import sqrt

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import LOSS
from gaspart.kernels.obstacles.support import dot, lies_on_floor
from gaspart.kernels.physics.collision import velocity_of
from gaspart.kernels.physics.running_sum import add

_INTO = 2.0**-40  # of its speed: what leads less into a plane runs along it


@inner_helper
def count_planes(support, i):
    """How many planes of interior walls a particle rests on."""
    if support is None:
        return 0
    return support.number[i]


@inner_helper
def plane_normal(support, i, n):
    """(3,) the unit vector from one of these planes to the particle."""
    if support is None:
        return 0.0, 0.0, 0.0
    return support.normal[i, n, 0], support.normal[i, n, 1], support.normal[i, n, 2]


@inner_helper
def fastest_at_rest(gravity, longest, support):
    """The speed across a horizontal wall below which a bounce is taken for rest."""
    square = 0.0
    for k in range(len(gravity.acceleration)):
        square += gravity.acceleration[k] * gravity.acceleration[k]
    strength = sqrt(square)
    speed = strength * longest
    if support is not None:
        speed = max(speed, sqrt(2.0 * strength * support.height))
    return speed


@inner_kernel
def come_to_rest_again(flights, i, longest, space, gravity, support):
    """What a particle that has just bounced keeps of its velocity, when it comes to rest again on that on
    which it rested: (velocity (3,), the number of planes that it led into, the normal (3,) of the last one).
    The number is 0 if there are none, or if its speed lets it bounce there as well."""
    w, normal, number = velocity_of(flights, i, space), (0.0, 0.0, 0.0), 0
    planes, fastest = count_planes(support, i), fastest_at_rest(gravity, longest, support)
    for n in range(planes if planes > 0 else 3):
        if planes > 0:
            p = plane_normal(support, i, n)
        elif lies_on_floor(flights, i, n, space, gravity, longest):
            side = -1.0 if gravity.acceleration[n] > 0.0 else 1.0
            p = side if n == 0 else 0.0, side if n == 1 else 0.0, side if n == 2 else 0.0
        else:
            continue
        into = -dot(p, w)
        if into >= fastest:
            return w, 0, normal
        if into > _INTO * sqrt(dot(w, w)):
            w = w[0] + into * p[0], w[1] + into * p[1], w[2] + into * p[2]
            normal, number = p, number + 1
    return w, number, normal


@inner_kernel
def rest_in_wedge(flights, i, normal, particle, space, tally, gravity, support):
    """After a bounce on something in the direction of a unit vector (3,): let a particle rest between this
    and what it rested on, if it would meet it again at once. particle: its mass, and the longest bounce taken
    for rest. Returns whether it rests."""
    mass, longest = particle
    v = velocity_of(flights, i, space)
    w, number, p = come_to_rest_again(flights, i, longest, space, gravity, support)
    if number == 0 or dot(normal, w) <= _INTO * sqrt(dot(v, v)):
        return False
    part = 0.0
    x, y, z = (
        p[1] * normal[2] - p[2] * normal[1],
        p[2] * normal[0] - p[0] * normal[2],
        p[0] * normal[1] - p[1] * normal[0],
    )
    if number == 1 and len(space.lengths) == 3:
        part = (v[0] * x + v[1] * y + v[2] * z) / (x * x + y * y + z * z)
    lost = dot(v, v)
    for k in range(len(space.lengths)):
        flights[i].velocity[k] = part * (x if k == 0 else y if k == 1 else z)
        lost -= flights[i].velocity[k] * flights[i].velocity[k]
    add(tally.sums, LOSS, 0.5 * mass * lost)
    return True
