"""Interior walls as segments: rows (ax, ay, ux, uy, length), the start, the unit vector along, the length.

A wall near a periodic face is met across it too, so it has an image wherever one comes within a radius of the
container.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from gaspart.boxes import Boxes
from gaspart.kernel import helper
from gaspart.matter import Wall
from gaspart.scene import Scene

_SLACK = 1e-9  # by which neighbourhoods are drawn wider, lest rounding leave a wall out of a box's list


def segments_of(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """(M, 5) segments, and (M,) the number of the wall that each stands for."""
    lengths, reach = np.array(scene.container.lengths), scene.largest_radius * (1 + _SLACK)
    rows, walls = [], []
    for n, wall in enumerate(wall for wall in scene.walls if isinstance(wall, Wall)):
        start, end = np.array(wall.start), np.array(wall.end)
        length = float(np.hypot(*(end - start)))
        for lap in product(*((0, -1, 1) if periodic else (0,) for periodic in scene.container.periodic)):
            ends = np.array([start, end]) + np.array(lap) * lengths
            if any(lap) and ((ends.max(axis=0) < -reach) | (ends.min(axis=0) > lengths + reach)).any():
                continue
            rows.append([*ends[0], *((end - start) / length), length])
            walls.append(n)
    return np.array(rows).reshape(-1, 5), np.array(walls, dtype=np.int64)


def segments_near(segments: np.ndarray, boxes: Boxes, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """The segments within `reach` of each box: those of box b are listed[first[b] : first[b + 1]]. All of
    them follow the last box, for bodies that reach further."""
    reach *= 1 + _SLACK
    half = boxes.widths[:2] / 2
    found = []
    for m, (ax, ay, ux, uy, length) in enumerate(segments):
        ends = np.array([[ax, ay], [ax + ux * length, ay + uy * length]])
        low = np.floor((ends.min(axis=0) - reach) / boxes.widths[:2] - _SLACK).astype(int)
        high = np.floor((ends.max(axis=0) + reach) / boxes.widths[:2] + _SLACK).astype(int)
        low, high = (np.clip(c, 0, boxes.per_side[:2] - 1) for c in (low, high))
        x, y = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
        # a box is near if the line passes its centre within reach and half its extent across the line
        off = abs(ux * ((y + 0.5) * boxes.widths[1] - ay) - uy * ((x + 0.5) * boxes.widths[0] - ax))
        near = off <= (reach + half[0] * abs(uy) + half[1] * abs(ux)) * (1 + _SLACK)
        found += [(box, m) for box in (x * boxes.strides[0] + y * boxes.strides[1])[near]]
    found = np.array(sorted(found), dtype=np.int64).reshape(-1, 2)
    first = np.searchsorted(found[:, 0], np.arange(boxes.count + 1))
    listed = np.concatenate([found[:, 1], np.arange(len(segments))])
    return np.append(first, len(listed)).astype(np.int64), listed


@helper
def square_from_segment(segments, m, x, y):
    """Square of the distance of a point from a segment, its ends included."""
    dx = x - segments[m, 0]
    dy = y - segments[m, 1]
    s = min(max(dx * segments[m, 2] + dy * segments[m, 3], 0.0), segments[m, 4])
    dx -= s * segments[m, 2]
    dy -= s * segments[m, 3]
    return dx * dx + dy * dy
