"""Particles that come to rest on walls, or leave them, under gravity.

A bounce too low for positions, or too short for clocks, to resolve is taken for rest: the velocity across the
wall becomes zero. The particle is released by the next contact that moves it, and where it leaves the wall.
"""

from math import inf

from gaspart.kernels.compile.policy import inner_helper, inner_kernel
from gaspart.kernels.model import LOSS
from gaspart.kernels.obstacles.support import add_floors, add_plane, dot, find_pull, pressing, release, within
from gaspart.kernels.obstacles.wedge import rest_in_wedge
from gaspart.kernels.physics.ballistic import time_to_side
from gaspart.kernels.physics.collision import velocity_of
from gaspart.kernels.physics.running_sum import add

_HOP = (
    2.0**20
)  # times `shortest_bounce`: the shortest bounce where a particle cannot rest, as at the end of a wall


@inner_kernel
def come_to_rest(flights, i, normal, place, mass, space, tally, gravity):
    """After a bounce on a wall in the direction of a unit vector (3,): let the particle rest there if the
    bounce cannot be resolved, or else make it as long as can be. place: the row of the wall, whether it
    is touched at an end, where only what is balanced can rest, and the longest bounce taken for rest."""
    row, at_end, longest = place
    support = gravity.support
    press = pressing(flights, i, normal, space, gravity, longest)
    v = velocity_of(flights, i, space)
    speed = -dot(normal, v)
    highest = 2.0 * press * support.height
    if not (press > 0.0 and (speed * speed <= highest or speed < press * longest)):
        if not rest_in_wedge(flights, i, normal, (mass, longest), space, tally, gravity, support):
            release(flights, i, space, support)
        return
    if support.number[i] == 0:
        add_floors(flights, i, space, gravity, longest)
    add_plane(flights, i, normal, row, space, support)
    dimension = len(space.lengths)
    find_pull(gravity, i, dimension)
    last = support.number[i] - 1
    wx, wy, wz = within(support, i, (last, last - 1 if last > 0 else -1), v, dimension)
    if last == 2:
        wx = wy = wz = 0.0
    lost = (v[0] - wx) * (v[0] - wx) + (v[1] - wy) * (v[1] - wy) + (v[2] - wz) * (v[2] - wz)
    pull = support.pull[i]
    moves = wx != 0.0 or wy != 0.0 or wz != 0.0 or pull[0] != 0.0 or pull[1] != 0.0 or pull[2] != 0.0
    if lost <= 4.0 * max(highest, speed * speed) and not (at_end and moves):
        lost = dot(v, v) - (wx * wx + wy * wy + wz * wz)
    else:
        release(flights, i, space, support)
        more = max(0.0, press * gravity.shortest_bounce * _HOP - speed)
        wx, wy, wz = v[0] - more * normal[0], v[1] - more * normal[1], v[2] - more * normal[2]
        lost = -more * (2.0 * speed + more)
    flights[i].velocity[0], flights[i].velocity[1] = wx, wy
    if dimension == 3:
        flights[i].velocity[2] = wz
    add(tally.sums, LOSS, 0.5 * mass * lost)


@inner_helper
def time_to_leave(at, speed, pull, length):
    """Time until a coordinate along a wall is outside of [0, length]; inf if it never is."""
    time = inf
    if at <= length:
        time = time_to_side(length - at, speed, pull)
    if at >= 0.0:
        time = min(time, time_to_side(at, -speed, -pull))
    return time


@inner_helper
def leave(flights, i, edge, at, length, space):
    """Move a particle that is at the end of a wall beyond it, in the direction of a unit vector (3,) along
    which its coordinate is `at`, by more than that is rounded by."""
    beyond = length
    for k in range(len(space.lengths)):
        beyond += abs(flights[i].position[k])
    beyond *= 2.0**-46
    more = 0.0
    if at > 0.5 * length and at < length + beyond and at > length - beyond:
        more = length + beyond - at
    if at < 0.5 * length and at > -beyond and at < beyond:
        more = -beyond - at
    for k in range(len(space.lengths)):
        flights[i].position[k] += more * edge[k]
