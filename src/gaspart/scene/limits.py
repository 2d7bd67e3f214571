"""Limits of sizes and positions: particles that fit into a container and next to each other.

The module contains the limits of sizes, the tolerance of prescribed positions, the volume of a particle, the
closest packing, and the search for particles near a position.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import product
from typing import TYPE_CHECKING

from gaspart.errors import SceneError
from gaspart.keys.values import finite_vector

if TYPE_CHECKING:
    from gaspart.scene.container import Container
    from gaspart.scene.species import Particle, Species


# Volume of a particle and closest packing: one definition for discs and spheres.


CLOSE_PACKING = {2: math.pi / math.sqrt(12.0), 3: math.pi / math.sqrt(18.0)}
"""Packing fraction of the densest arrangement: triangular lattice (2D), face-centred cubic (3D); exact."""
_UNIT_BALL = {2: math.pi, 3: 4.0 / 3.0 * math.pi}


def ball_volume(dimension: int, radius: float = 1.0) -> float:
    """Return the area of a disc or the volume of a sphere. The area is pi r^2, and the volume is 4 pi r^3 /
    3.
    """
    return _UNIT_BALL[dimension] * radius**dimension


# maximum length of the longest side, in diameters: contacts are then accurate to a thousandth of a diameter
_RESOLVED = 1e12
_ROOM = 1e-6  # minimum clearance of a particle between two walls, in radii
_UNITS = 8.0 * 2.0**-52  # tolerance, in units in the last place


def rounding(position: Iterable[float], *lengths: float) -> float:
    """Return the tolerance of prescribed positions. Particles and walls that touch in decimal numbers may
    overlap in binary numbers, because 0.6 - 0.5 < 0.1 after rounding. The tolerance is a few units in the
    last place of the largest coordinate.
    """
    return _UNITS * max(*map(abs, position), *lengths)


def check_room(container: Container, centres_to_walls: bool, key: str, particle: Particle | Species) -> None:
    """Raise SceneError, with `key`, if a particle does not fit into the container. SceneError is also raised
    for a particle that is not fixed but has no room to move, and for a particle so small that rounding would
    hide its contacts.
    """
    radius = particle.largest_radius
    shortest, longest = min(container.lengths), max(container.lengths)
    if not centres_to_walls:
        if 2 * radius > shortest:
            rule = f"is too large for the container, whose shortest side is {shortest:g}"
            raise SceneError(key, radius, rule)
        walled = zip(container.lengths, container.periodic, strict=True)
        narrow = any(2 * radius * (1.0 + _ROOM) > length for length, periodic in walled if not periodic)
        if narrow and not particle.fixed:
            rule = "leaves no room between two walls, which it would hit infinitely often in no time"
            raise SceneError(key, radius, rule)
    if 2 * particle.smallest_radius * _RESOLVED < longest:
        radius = particle.smallest_radius
        rule = f"is too small to resolve contacts in a container whose longest side is {longest:g}"
        raise SceneError(key, radius, rule)


def check_region(container: Container, key: str, kind: Species) -> None:
    """Raise SceneError, with `key`, for an invalid region of a species. The region must be a box inside the
    container that is large enough for one of its particles.
    """
    if kind.region is None:
        return
    lower, upper = (
        finite_vector(f"{key}[{n}]", corner, container.dimension) for n, corner in enumerate(kind.region)
    )
    for low, high, length in zip(lower, upper, container.lengths, strict=True):
        if low < 0.0 or high > length:
            raise SceneError(key, kind.region, "must lie inside the container")
        if not high - low > 2.0 * kind.largest_radius:
            raise SceneError(
                key, kind.region, f"has no room for a particle of radius {kind.largest_radius:g}"
            )


class Nearby:
    """Cells of width `reach` or more, to find positions near a point quickly. Positions are near if their
    distance is at most `reach`.
    """

    def __init__(self, container: Container, reach: float) -> None:
        self._container = container
        self._sides = [max(1, int(length / reach)) if reach else 1 for length in container.lengths]
        self._members: dict[tuple[int, ...], list[int]] = {}

    def _cell(self, position: tuple[float, ...]) -> tuple[int, ...]:
        axes = zip(position, self._container.lengths, self._sides, strict=True)
        return tuple(min(int(x / length * side), side - 1) for x, length, side in axes)

    def add(self, n: int, position: tuple[float, ...]) -> None:
        """Add index `n` at a position (d,) inside the container."""
        self._members.setdefault(self._cell(position), []).append(n)

    def neighbours(self, position: tuple[float, ...]) -> list[int]:
        """Return the indices of all positions within `reach`, and of some others, in ascending order."""
        axes = []
        for at, side, periodic in zip(
            self._cell(position), self._sides, self._container.periodic, strict=True
        ):
            steps = (at - 1, at, at + 1)
            axes.append({step % side for step in steps} if periodic else {n for n in steps if 0 <= n < side})
        return sorted(n for cell in product(*axes) for n in self._members.get(cell, ()))
