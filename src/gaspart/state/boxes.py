"""Partition of space into equal boxes on a grid.

Each axis is divided on its own, down to one box. Box coordinates are kept for three axes whatever the
dimension; a missing axis has one box and no neighbours. A table for each axis states which boxes are
neighbours, so that walls, periodic faces and axes of one or two boxes need no code of their own.
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
    """Grid of boxes.

    Parameters
    ----------
    per_side : ndarray of int, shape (3,)
        Boxes along each axis.
    widths : ndarray, shape (3,), [length]
        Sides of a box.
    strides : ndarray of int, shape (3,)
        Strides of the linear index.
    neighbour : ndarray of int, shape (3, most, 3)
        Change of the linear index by a step of -1, 0, +1 from a box coordinate, or NOWHERE.
    shift : ndarray of int, shape (3, most, 3)
        Container lengths that this step crosses on a periodic axis.
    """

    per_side: np.ndarray
    widths: np.ndarray
    strides: np.ndarray
    neighbour: np.ndarray
    shift: np.ndarray

    @property
    def count(self) -> int:
        """Number of boxes."""
        return int(self.per_side.prod())

    def coordinates(self, positions: np.ndarray) -> np.ndarray:
        """Return the box coordinates of positions.

        Parameters
        ----------
        positions : ndarray, shape (N, d), [length]
            Positions. NaN means no position.

        Returns
        -------
        ndarray of int, shape (N, 3)
            Coordinates: the outermost box for a position outside, and the first box for no position.
        """
        boxes, positions = np.zeros((len(positions), 3), dtype=np.int64), np.nan_to_num(positions)
        for k in range(positions.shape[1]):
            along = (positions[:, k] / self.widths[k]).astype(np.int64)
            boxes[:, k] = np.clip(along, 0, self.per_side[k] - 1)
        return boxes

    def cut(self, axis: int) -> Boxes:
        """Return a grid whose first and last boxes along an axis are not neighbours.

        Parameters
        ----------
        axis : int
            Index of the axis.

        Returns
        -------
        Boxes
            Grid that is otherwise equal.
        """
        neighbour, last = self.neighbour.copy(), self.per_side[axis] - 1
        neighbour[axis, 0, 0] = neighbour[axis, last, 2] = NOWHERE
        return replace(self, neighbour=neighbour)

    def index_of(self, position: np.ndarray) -> int:
        """Return the linear index of the box that holds a position.

        Parameters
        ----------
        position : ndarray, shape (d,), [length]
            Position.

        Returns
        -------
        int
            Linear index.
        """
        return int(self.coordinates(position[None])[0] @ self.strides)


def narrowest_box(scene: Scene) -> float:
    """Return the smallest side of a box: the largest diameter, so that no contact is missed.

    Parameters
    ----------
    scene : Scene
        Scene of the particles.

    Returns
    -------
    float, [length]
        Smallest side.
    """
    return 2.0 * scene.largest_radius


def sides_for(scene: Scene, narrowest: float | None = None, per_particle: float = 1.0) -> tuple[int, ...]:
    """Return the numbers of boxes per side for a number of boxes per particle.

    Parameters
    ----------
    scene : Scene
        Scene of the particles.
    narrowest : float, optional, [length]
        Smallest side of a box, if larger particles are kept outside the boxes. Default: the largest diameter.
    per_particle : float, default 1.0
        Number of boxes per particle, which is reached approximately.

    Returns
    -------
    tuple of int, shape (d,)
        Boxes along each axis.
    """
    lengths = scene.container.lengths
    narrowest = narrowest_box(scene) if narrowest is None else narrowest
    width = max(cube_side(lengths, per_particle * scene.capacity), narrowest)
    return tuple(max(1, int(length / width)) for length in lengths)


def cube_side(lengths: tuple[float, ...], number: float) -> float:
    """Return the side of cubes of which about `number` fill a container.

    Parameters
    ----------
    lengths : tuple of float, shape (d,), [length]
        Sides of the container. A side shorter than the cube has one cube, and the others share the number.
    number : float
        Number of cubes; at least 1 is used.

    Returns
    -------
    float, [length]
        Side of a cube.
    """
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
    """Return the grid of boxes for a scene.

    Parameters
    ----------
    scene : Scene
        Scene of the particles.
    boxes_per_side : int or tuple of int, shape (d,)
        Boxes per side: one number, or one for each axis.
    images : bool
        On a periodic axis of fewer than three boxes the same box is a neighbour on both sides. If True, the
        table has both, each with its own shift; if False, it has each box once.
    narrowest : float, optional, [length]
        Smallest side of a box, if some particles are kept outside the boxes. Default: the largest diameter.

    Returns
    -------
    Boxes
        Grid.

    Raises
    ------
    SceneError
        If a box would be narrower than `narrowest`, or if `boxes_per_side` is invalid.
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
