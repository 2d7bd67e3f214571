"""Interior walls as arrays, with images of walls near periodic faces.

An array has a row for each wall, and for each periodic image of a wall that particles can touch. The numbers
in the rows of segments and plates are described in `kernels.obstacles.distance`. Particles near a periodic
face can touch a wall beyond this face. Therefore the array includes all images whose distance from the
container is at most a particle radius.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from gaspart.scene.scene import Scene
from gaspart.scene.walls import Plate, Wall
from gaspart.state.boxes import Boxes

_SLACK = 1e-9  # relative extension of neighbourhoods, so that rounding removes no wall from a box's list


def wall_rows(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return interior walls and their images near periodic faces as rows of an array."""
    from gaspart.kernels.obstacles.distance import PLATE, SEGMENT

    lengths, reach = np.array(scene.container.lengths), scene.largest_radius * (1 + _SLACK)
    rows, walls = [], []
    for n, wall in enumerate(scene.walls):
        row = _segment(wall) if isinstance(wall, Wall) else _plate(wall)
        for image in product(*((0, -1, 1) if periodic else (0,) for periodic in scene.container.periodic)):
            moved = row.copy()
            moved[: scene.dimension] += np.array(image) * lengths
            corners = _corners(moved)
            if (
                any(image)
                and ((corners.max(axis=0) < -reach) | (corners.min(axis=0) > lengths + reach)).any()
            ):
                continue
            rows.append(moved)
            walls.append(n)
    row = SEGMENT if scene.dimension == 2 else PLATE
    return np.array(rows).reshape(-1).view(row), np.array(walls, dtype=np.int64)


def _segment(wall: Wall) -> np.ndarray:
    """Return the row of a segment."""
    start, end = np.array(wall.start), np.array(wall.end)
    length = float(np.hypot(*(end - start)))
    return np.array([*start, *((end - start) / length), length])


def _plate(wall: Plate) -> np.ndarray:
    """Return the row of a plate."""
    edges = np.array(wall.edges)
    sizes = np.sqrt((edges**2).sum(axis=1, keepdims=True))
    return np.concatenate([np.array(wall.corner), np.hstack([edges / sizes, sizes]).ravel()])


def _corners(row: np.ndarray) -> np.ndarray:
    """Return the ends (2, 2) of a segment, or the corners (4, 3) of a plate."""
    if len(row) == 5:
        return np.array([row[:2], row[:2] + row[2:4] * row[4]])
    along, across = row[3:6] * row[6], row[7:10] * row[10]
    return row[:3] + np.array([0 * along, along, across, along + across])


def _normal(row: np.ndarray) -> np.ndarray:
    """Return the unit normal (d,) of a segment or plate."""
    return np.array([-row[3], row[2]]) if len(row) == 5 else np.cross(row[3:6], row[7:10])


def walls_near(rows: np.ndarray, boxes: Boxes, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the walls within a distance of each box."""
    reach *= 1 + _SLACK
    numbers = rows.view(float).reshape(len(rows), rows.itemsize // 8)
    d = 2 if numbers.shape[1] == 5 else 3
    widths, per_side, strides = boxes.widths[:d], boxes.per_side[:d], boxes.strides[:d]
    pairs = []
    for m, row in enumerate(numbers):
        corners = _corners(row)
        low = np.floor((corners.min(axis=0) - reach) / widths - _SLACK).astype(int)
        high = np.floor((corners.max(axis=0) + reach) / widths + _SLACK).astype(int)
        low, high = (np.clip(c, 0, per_side - 1) for c in (low, high))
        at = np.stack(np.meshgrid(*map(np.arange, low, high + 1), indexing="ij"), axis=-1).reshape(-1, d)
        # the line or plane of the wall is near if its distance from the centre of the box is at most reach
        # plus half of the box's extent along the wall's normal
        normal = _normal(row)
        off = abs((((at + 0.5) * widths - row[:d]) * normal).sum(axis=1))
        near = off <= (reach + (0.5 * widths * abs(normal)).sum()) * (1 + _SLACK)
        pairs += [(box, m) for box in (at * strides).sum(axis=1)[near]]
    listed = np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2)
    first = np.searchsorted(listed[:, 0], np.arange(boxes.count + 1))
    walls = np.concatenate([listed[:, 1], np.arange(len(rows))])
    return np.append(first, len(walls)).astype(np.int64), walls
