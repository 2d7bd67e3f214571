"""Along one axis of the container: the box that holds a coordinate, the nearest image of a difference."""

from gaspart.kernels.compile.policy import inner_helper


@inner_helper
def box_coordinate(x, width, per_side):
    """Which box along an axis holds coordinate x; the outermost one for x outside."""
    c = int(x / width)
    return min(max(c, 0), per_side - 1)


@inner_helper
def nearest(gap, length, periodic):
    """A difference of two coordinates of the container, by the nearest image on a periodic axis."""
    if periodic:
        if gap + gap > length:
            return gap - length
        if gap + gap < -length:
            return gap + length
    return gap
