"""Exact numbers of contacts: answers that need no simulation."""

from __future__ import annotations

import math
from collections.abc import Sequence


def galperin(ratio: float, heavy: float, light: float, time: float) -> int:
    """Compute the contacts, up to `time`, of a wall, a light particle and a heavy one.

    The light particle is at rest; the heavy one, `ratio` times as heavy, arrives with speed 1 (Galperin,
    Regul. Chaotic Dyn. 8, 375 (2003)); for ever, the numbers are the digits of pi. `heavy` and `light` are
    the distances that each can move until it, pressed against what is between, touches the wall. In the plane
    of distances times the root of the mass the motion is a straight line across a fan of mirrors, each turned
    by arctan sqrt(1/ratio) from the last.
    """
    narrow = math.sqrt(1.0 / ratio)
    return int(math.atan2(narrow * light, heavy - time) / math.atan(narrow))


def hits_in_box(
    starts: Sequence[float], velocities: Sequence[float], rooms: Sequence[float], time: float
) -> int:
    """Count the hits at the walls of a box by one particle.

    For each axis its start, its velocity and its free length are given.
    """
    total = 0
    for start, velocity, room in zip(starts, velocities, rooms, strict=True):
        ahead = start if velocity > 0.0 else room - start
        total += int((ahead + abs(velocity) * time) / room)
    return total


def contacts_on_line(starts: Sequence[float], velocities: Sequence[float], room: float, time: float) -> int:
    """Count the contacts of like particles on a line between two walls.

    They are contacts with walls and with each other. `starts` are positions minus the diameters on their
    left; `room` is the length minus all diameters. Equal particles exchange velocities, so points that pass
    through each other do as well; a point between walls is a point on a circle of twice the free length, and
    two meet when the sum or the difference of their phases is a multiple of the circle.
    """
    phases = [(x if v > 0.0 else 2.0 * room - x, abs(v)) for x, v in zip(starts, velocities, strict=True)]
    count = 0
    for n, (phase, fast) in enumerate(phases):
        count += math.floor((phase + fast * time) / room) - math.floor(phase / room)
        for other, slow in phases[:n]:
            for sign in (1.0, -1.0):
                first, rate = phase + sign * other, fast + sign * slow
                turns = math.floor((first + rate * time) / (2.0 * room)) - math.floor(first / (2.0 * room))
                count += abs(turns)
    return count
