"""Volume of a particle and closest packing: one definition for discs and spheres."""

import math

CLOSE_PACKING = {2: math.pi / math.sqrt(12.0), 3: math.pi / math.sqrt(18.0)}
"""Packing fraction of the densest arrangement: triangular lattice (2D), face-centred cubic (3D); exact."""
_UNIT_BALL = {2: math.pi, 3: 4.0 / 3.0 * math.pi}


def ball_volume(dimension: int, radius: float = 1.0) -> float:
    """Return the area of a disc or the volume of a sphere.

    These are pi r^2 and 4 pi r^3 / 3.
    """
    return _UNIT_BALL[dimension] * radius**dimension
