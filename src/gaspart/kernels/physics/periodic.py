"""Coordinates along an axis: the box of a coordinate, and differences for the nearest image."""

from gaspart.kernels.compile.policy import inner_helper


@inner_helper
def box_coordinate(x, width, per_side):
    """Return the index along an axis of the box that contains or is nearest to x."""
    c = int(x / width)
    return min(max(c, 0), per_side - 1)


@inner_helper
def nearest(gap, length, periodic):
    """Return a difference of two coordinates, by the nearest image on a periodic axis."""
    if periodic:
        if gap + gap > length:
            return gap - length
        if gap + gap < -length:
            return gap + length
    return gap
