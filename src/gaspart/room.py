"""Whether a container has room for a body: size limits, and which bodies are near a position."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

from gaspart.errors import SceneError

if TYPE_CHECKING:
    from gaspart.scene import Container

_RESOLVED = 1e12  # diameters in the longest side, at most: contacts are then right to a thousandth
_ROOM = 1e-6  # of a radius: what a body between two walls must have at least


def check_room(container: Container, centres_to_walls: bool, key: str, radius: float, fixed: bool) -> None:
    """Raise SceneError, with `key`, if a body of this radius does not fit into the container, cannot move in
    it though it is not `fixed`, or is so small that its contacts are lost in rounding."""
    shortest, longest = min(container.lengths), max(container.lengths)
    if not centres_to_walls:
        if 2 * radius > shortest:
            rule = f"a body must fit into the container, whose shortest side is {shortest:g}"
            raise SceneError(key, radius, rule)
        walled = zip(container.lengths, container.periodic, strict=True)
        narrow = any(2 * radius * (1.0 + _ROOM) > length for length, periodic in walled if not periodic)
        if narrow and not fixed:
            rule = "leaves no room between two walls, which it would hit for ever in no time"
            raise SceneError(key, radius, rule)
    if 2 * radius * _RESOLVED < longest:
        rule = f"too small to tell where it touches, in a container whose longest side is {longest:g}"
        raise SceneError(key, radius, rule)


class Nearby:
    """Positions in cells at least `reach` wide, so that those within `reach` of a point are found without a
    look at all of them."""

    def __init__(self, container: Container, reach: float) -> None:
        self._container = container
        self._sides = [max(1, int(length / reach)) if reach else 1 for length in container.lengths]
        self._members: dict[tuple[int, ...], list[int]] = {}

    def _cell(self, position: tuple[float, ...]) -> tuple[int, ...]:
        axes = zip(position, self._container.lengths, self._sides, strict=True)
        return tuple(min(int(x / length * side), side - 1) for x, length, side in axes)

    def add(self, n: int, position: tuple[float, ...]) -> None:
        """Put number `n` at a position (d,) inside the container."""
        self._members.setdefault(self._cell(position), []).append(n)

    def around(self, position: tuple[float, ...]) -> list[int]:
        """All numbers within the reach of a position, and some others, in ascending order."""
        axes = []
        for at, side, periodic in zip(
            self._cell(position), self._sides, self._container.periodic, strict=True
        ):
            steps = (at - 1, at, at + 1)
            axes.append({step % side for step in steps} if periodic else {n for n in steps if 0 <= n < side})
        return sorted(n for cell in product(*axes) for n in self._members.get(cell, ()))
