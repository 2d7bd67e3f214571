"""Moving wall across the container: a piston between two gases."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from gaspart.errors import SceneError

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene
    from gaspart.scene.walls import Plate, Wall


class MovingWall(NamedTuple):
    """Axis along which a wall moves, its position there at time 0, and its mass."""

    axis: int
    position: float
    mass: float


MOVING_WALL = "walls[0]"
"""Key of a moving wall, which is the only interior wall."""


def moving_wall_among(walls: Sequence[Wall | Plate], lengths: tuple[float, ...]) -> MovingWall | None:
    """Return the interior wall that moves, or None without one."""
    for wall in walls:
        if wall.mass is not None:
            axis = crossed_axis(wall, lengths)
            return MovingWall(axis, next(iter(wall.corners.values()))[axis], wall.mass)
    return None


def crossed_axis(wall: Wall | Plate, lengths: tuple[float, ...]) -> int:
    """Return the axis perpendicular to a wall that spans a container, or -1."""
    for axis, _ in enumerate(lengths):
        coordinates = [{corner[k] for corner in wall.corners.values()} for k in range(len(lengths))]
        is_spanning = all(coordinates[k] == {0.0, length} for k, length in enumerate(lengths) if k != axis)
        if is_spanning and len(coordinates[axis]) == 1:
            return axis
    return -1


def check_moving_wall(scene: Scene) -> None:
    """Raise SceneError for a moving wall with other walls, or not across the whole container."""
    for n, wall in enumerate(scene.walls):
        if wall.mass is None:
            continue
        key, lengths = f"walls[{n}].mass", scene.container.lengths
        if len(scene.walls) > 1:
            raise SceneError(key, wall.mass, "must be the only interior wall, since it moves")
        if wall.temperature is not None:
            raise SceneError(
                key, wall.mass, "excludes a temperature; a wall that moves is smooth and elastic"
            )
        axis = crossed_axis(wall, lengths)
        if axis < 0:
            rule = "a wall that moves must reach across the whole container, at right angles to an axis"
            raise SceneError(key, wall.mass, rule)
        if scene.container.periodic[axis]:
            rule = f"a wall that moves needs walls across {'xyz'[axis]}, along which it does"
            raise SceneError(key, wall.mass, rule)
