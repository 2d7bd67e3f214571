"""Vectors from a point to the nearest point of an interior wall, and its data types."""

import numpy as np

from gaspart.kernels.compile.policy import inner_helper

SEGMENT = np.dtype([("start", "f8", 2), ("direction", "f8", 2), ("length", "f8")])
"""Data type of a segment: start, unit vector along it, and length."""
PLATE = np.dtype(
    [("corner", "f8", 3), ("along", "f8", 3), ("length", "f8"), ("across", "f8", 3), ("width", "f8")]
)
"""Data type of a plate: a corner, the unit vectors along its two edges, and their lengths."""


@inner_helper
def to_segment(rows, m, point):
    """Return the vector from a point (2,) to the nearest point of a segment, ends included."""
    ux, uy = rows[m].direction[0], rows[m].direction[1]
    dx, dy = point[0] - rows[m].start[0], point[1] - rows[m].start[1]
    s = min(max(ux * dx + uy * dy, 0.0), rows[m].length)
    return s * ux - dx, s * uy - dy, 0.0


@inner_helper
def _dot(a, x, y, z):
    return x * a[0] + y * a[1] + z * a[2]


@inner_helper
def to_plate(rows, m, point):
    """Return the vector from a point (3,) to the nearest point of a plate, rim included."""
    along, across, corner = rows[m].along, rows[m].across, rows[m].corner
    dx, dy, dz = point[0] - corner[0], point[1] - corner[1], point[2] - corner[2]
    s = min(max(_dot(along, dx, dy, dz), 0.0), rows[m].length)
    t = min(max(_dot(across, dx, dy, dz), 0.0), rows[m].width)
    return (
        s * along[0] + t * across[0] - dx,
        s * along[1] + t * across[1] - dy,
        s * along[2] + t * across[2] - dz,
    )


@inner_helper
def to_wall(rows, m, point, lengths):
    """Return the vector from a point to the nearest point of an interior wall. `lengths`: (d,), side lengths
    of the container; their number determines the kind of wall.
    """
    if len(lengths) == 2:
        return to_segment(rows, m, point)
    return to_plate(rows, m, point)
