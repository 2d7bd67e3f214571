"""Interior walls of three dimensions as rows of 11: a corner (3), then the unit vector along each of two
edges (3) and the edge's length. Like `segments`, with images wherever one comes near a periodic face.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from gaspart.boxes import Boxes
from gaspart.kernel import helper
from gaspart.matter import Plate
from gaspart.scene import Scene

_SLACK = 1e-9  # as in `segments`


def _corners(row: np.ndarray) -> np.ndarray:
    """(4, 3) the corners of a plate."""
    along, across = row[3:6] * row[6], row[7:10] * row[10]
    return row[:3] + np.array([0 * along, along, across, along + across])


def plates_of(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """(M, 11) plates, and (M,) the number of the wall that each stands for."""
    lengths, reach = np.array(scene.container.lengths), scene.largest_radius * (1 + _SLACK)
    rows, walls = [], []
    for n, wall in enumerate(wall for wall in scene.walls if isinstance(wall, Plate)):
        edges = np.array(wall.edges)
        sizes = np.sqrt((edges**2).sum(axis=1, keepdims=True))
        units = np.hstack([edges / sizes, sizes]).ravel()
        for lap in product(*((0, -1, 1) if periodic else (0,) for periodic in scene.container.periodic)):
            row = np.concatenate([np.array(wall.corner) + np.array(lap) * lengths, units])
            corners = _corners(row)
            if any(lap) and ((corners.max(axis=0) < -reach) | (corners.min(axis=0) > lengths + reach)).any():
                continue
            rows.append(row)
            walls.append(n)
    return np.array(rows).reshape(-1, 11), np.array(walls, dtype=np.int64)


def plates_near(plates: np.ndarray, boxes: Boxes, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """The plates within `reach` of each box: those of box b are listed[first[b] : first[b + 1]]. All of them
    follow the last box, for bodies that reach further."""
    reach *= 1 + _SLACK
    half = boxes.widths / 2
    found = []
    for m, row in enumerate(plates):
        corners = _corners(row)
        low = np.floor((corners.min(axis=0) - reach) / boxes.widths - _SLACK).astype(int)
        high = np.floor((corners.max(axis=0) + reach) / boxes.widths + _SLACK).astype(int)
        low, high = (np.clip(c, 0, boxes.per_side - 1) for c in (low, high))
        at = np.stack(np.meshgrid(*map(np.arange, low, high + 1), indexing="ij"), axis=-1).reshape(-1, 3)
        # a box is near if the plane passes its centre within reach and half its extent across the plane
        normal = np.cross(row[3:6], row[7:10])
        off = abs((((at + 0.5) * boxes.widths - row[:3]) * normal).sum(axis=1))
        near = off <= (reach + (half * abs(normal)).sum()) * (1 + _SLACK)
        found += [(box, m) for box in (at * boxes.strides).sum(axis=1)[near]]
    found = np.array(sorted(found), dtype=np.int64).reshape(-1, 2)
    first = np.searchsorted(found[:, 0], np.arange(boxes.count + 1))
    listed = np.concatenate([found[:, 1], np.arange(len(plates))])
    return np.append(first, len(listed)).astype(np.int64), listed


@helper
def gap_to_plate(plates, m, x, y, z):
    """The vector from a point to the nearest point of a plate."""
    dx, dy, dz = x - plates[m, 0], y - plates[m, 1], z - plates[m, 2]
    s = min(max(dx * plates[m, 3] + dy * plates[m, 4] + dz * plates[m, 5], 0.0), plates[m, 6])
    t = min(max(dx * plates[m, 7] + dy * plates[m, 8] + dz * plates[m, 9], 0.0), plates[m, 10])
    return (
        s * plates[m, 3] + t * plates[m, 7] - dx,
        s * plates[m, 4] + t * plates[m, 8] - dy,
        s * plates[m, 5] + t * plates[m, 9] - dz,
    )
