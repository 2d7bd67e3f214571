"""Whether a container has room for a body: to be in it at all, to move, and to be told from a point."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaspart.errors import SceneError

if TYPE_CHECKING:
    from gaspart.scene.scene import Container

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
