"""How far a point is from an interior wall (rows as in `segment` and `plate`)."""

from gaspart.kernels.compilation import helper


@helper
def square_from_segment(segments, m, x, y):
    """Square of the distance of a point from a segment, its ends included."""
    dx = x - segments[m, 0]
    dy = y - segments[m, 1]
    s = min(max(dx * segments[m, 2] + dy * segments[m, 3], 0.0), segments[m, 4])
    dx -= s * segments[m, 2]
    dy -= s * segments[m, 3]
    return dx * dx + dy * dy


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
