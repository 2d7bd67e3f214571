"""How many contacts there must be: answers that need no simulation."""

from __future__ import annotations

import math
from collections.abc import Sequence


def galperin(ratio: float, heavy: float, light: float, time: float) -> int:
    """Contacts, up to `time`, of a wall, a light particle at rest and one `ratio` times as heavy that arrives
    with speed 1 (Galperin, Regul. Chaotic Dyn. 8, 375 (2003)); for ever, they are the digits of pi.

    heavy, light: the ways that each can go until it, pressed against what is between, touches the wall.
    In the plane of ways times the root of the mass the motion is a straight line across a fan of mirrors,
    each turned by arctan sqrt(1/ratio) from the last.
    """
    narrow = math.sqrt(1.0 / ratio)
    return int(math.atan2(narrow * light, heavy - time) / math.atan(narrow))


def hits_in_box(
    starts: Sequence[float], velocities: Sequence[float], rooms: Sequence[float], time: float
) -> int:
    """Hits at the walls of a box by one particle: by axis, where it starts, its velocity, and its room."""
    total = 0
    for start, velocity, room in zip(starts, velocities, rooms, strict=True):
        ahead = start if velocity > 0.0 else room - start
        total += int((ahead + abs(velocity) * time) / room)
    return total


def contacts_on_line(starts: Sequence[float], velocities: Sequence[float], room: float, time: float) -> int:
    """Contacts of like particles on a line between two walls, with walls and with each other.

    starts: their positions minus the diameters on their left; room: the length minus all diameters. Equal
    particles exchange velocities, so points that pass through each other do as well; a point between walls is
    one on a circle of twice the room, and two meet when the sum or the difference of their phases is a
    multiple of the circle.
    """
    phases = [(x if v > 0.0 else 2.0 * room - x, abs(v)) for x, v in zip(starts, velocities, strict=True)]
    count = 0
    for n, (one, fast) in enumerate(phases):
        count += math.floor((one + fast * time) / room) - math.floor(one / room)
        for other, slow in phases[:n]:
            for sign in (1.0, -1.0):
                first, rate = one + sign * other, fast + sign * slow
                turns = math.floor((first + rate * time) / (2.0 * room)) - math.floor(first / (2.0 * room))
                count += abs(turns)
    return count
