"""The space partition: equal boxes on a grid, each axis divided on its own, down to one box.

Box coordinates are kept for three axes whatever the dimension; a missing axis has one box and no
neighbours. Which boxes neighbour one another is a table per axis, so that walls, periodic faces and
axes of one or two boxes need no code of their own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gaspart.errors import SceneError
from gaspart.keys.values import partition
from gaspart.scene.scene import Scene

NOWHERE = -1


@dataclass(frozen=True)
class Boxes:
    """A grid of boxes.

    per_side: (3,) boxes along each axis; widths: (3,) their sides; strides: (3,) of the linear index;
    neighbour: (3, most, 3) what a step of -1, 0, +1 from a box coordinate adds to the linear index, or
    NOWHERE; shift: (3, most, 3) the container lengths that this step crosses on a periodic axis.
    """

    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray
    shift: np.ndarray

    @property
    def count(self) -> int:
        """The number of boxes."""
        return int(self.per_side.prod())

    def coordinates(self, positions: np.ndarray) -> np.ndarray:
        """(N, 3) box coordinates of positions (N, d); the outermost box for a position outside, and the first
        for none (NaN)."""
        boxes, positions = np.zeros((len(positions), 3), dtype=np.int64), np.nan_to_num(positions)
        for k in range(positions.shape[1]):
            along = (positions[:, k] / self.widths[k]).astype(np.int64)
            boxes[:, k] = np.clip(along, 0, self.per_side[k] - 1)
        return boxes

    def cut(self, axis: int) -> Boxes:
        """The same, but along an axis the first and the last boxes are not neighbours."""
        neighbour, last = self.neighbour.copy(), self.per_side[axis] - 1
        neighbour[axis, 0, 0] = neighbour[axis, last, 2] = NOWHERE
        return replace(self, neighbour=neighbour)

    def index_of(self, position: np.ndarray) -> int:
        """The linear index of the box that holds a position (d,)."""
        return int(self.coordinates(position[None])[0] @ self.strides)


def narrowest_box(scene: Scene) -> float:
    """The smallest side a box may have: the largest diameter, so that no contact is missed."""
    return 2.0 * scene.largest_radius


def sides_for(scene: Scene, narrowest: float | None = None, per_particle: float = 1.0) -> tuple[int, ...]:
    """Boxes per side (d,) for about so many boxes per particle, none narrower than the largest diameter, or
    than `narrowest` if larger particles are kept outside the boxes."""
    lengths = scene.container.lengths
    narrowest = narrowest_box(scene) if narrowest is None else narrowest
    width = max(cube_side(lengths, per_particle * scene.capacity), narrowest)
    return tuple(max(1, int(length / width)) for length in lengths)


def cube_side(lengths: tuple[float, ...], number: float) -> float:
    """The side of cubes of which about `number`, but at least one, fill a container with sides `lengths`
    (d,). An axis shorter than that side has one cube, and the others share the number."""
    sides = lengths
    while True:
        width = (math.prod(sides) / max(1.0, number)) ** (1.0 / len(sides))
        longer = tuple(side for side in sides if side >= width)
        if not longer or len(longer) == len(sides):
            return width
        sides = longer


def make_boxes(
    scene: Scene, boxes_per_side: int | tuple[int, ...], images: bool, narrowest: float | None = None
) -> Boxes:
    """The grid of `boxes_per_side` (one number, or one per axis) for a scene. narrowest: the smallest side a
    box may have, the largest diameter unless some particles are kept outside the boxes.

    On a periodic axis of fewer than three boxes the same box is a neighbour on both sides: with `images`
    the table has both, each with its own shift; without, it has each box once.

    Raises SceneError if a box would be narrower than the largest diameter.
    """
    lengths = scene.container.lengths
    partition("boxes_per_side", boxes_per_side)
    given = boxes_per_side
    if not isinstance(given, (tuple, list)):
        given = (given,) * len(lengths)
    if len(given) != len(lengths):
        raise SceneError("boxes_per_side", boxes_per_side, "must be one number, or one per axis")
    sides = [int(n) for n in given]
    narrowest = narrowest_box(scene) if narrowest is None else narrowest
    for length, n in zip(lengths, sides, strict=True):
        if n > 1 and length / n < narrowest:
            rule = f"boxes must not be narrower than the largest diameter, {narrowest:g}"
            raise SceneError("boxes_per_side", boxes_per_side, rule)
    periodic = scene.container.periodic + (False,) * (3 - len(lengths))
    per_side = np.array(sides + [1] * (3 - len(sides)), dtype=np.int64)
    widths = np.array(
        [length / n for length, n in zip(lengths, sides, strict=True)] + [1.0] * (3 - len(sides))
    )
    strides = np.array([1, per_side[0], per_side[0] * per_side[1]], dtype=np.int64)
    largest = int(per_side.max())
    neighbour = np.full((3, largest, 3), NOWHERE, dtype=np.int64)
    shift = np.zeros((3, largest, 3), dtype=np.int64)
    for axis in range(3):
        n = int(per_side[axis])
        for step in (0, 1, -1)[: n if periodic[axis] and not images else 3]:
            images_crossed, target = np.divmod(np.arange(n) + step, n)
            there = (images_crossed == 0) | periodic[axis]
            neighbour[axis, :n, step + 1][there] = target[there] * strides[axis]
            shift[axis, :n, step + 1][there] = images_crossed[there]
    return Boxes(per_side, widths, strides, neighbour, shift)
