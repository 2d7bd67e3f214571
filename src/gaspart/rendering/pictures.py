"""One picture of bodies, as an array of pixels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gaspart.errors import SceneError
from gaspart.files import Kind, begins_with
from gaspart.rendering.bodies import Bodies, bodies_of, colours_of
from gaspart.validation import count_of

if TYPE_CHECKING:
    import xarray as xr

    from gaspart.state import State

PICTURE = Kind("a PNG picture", begins_with(b"\x89PNG\r\n\x1a\n"))
SIZE = (1000, 750)
LARGEST_SIDE = 20_000


def render(
    source: State | xr.Dataset,
    frame: int = -1,
    size: tuple[int, int] = SIZE,
    colour: str | np.ndarray = "speed",
    fastest: float | None = None,
) -> np.ndarray:
    """A picture of a `State`, or of a frame of an open trajectory (the last one): uint8, (H, W, 3).

    Spheres are seen in perspective, with light and shadow, over the container's floor (z = 0); discs from
    above, with all walls. size: (W, H) pixels. colour: "speed", from dark at rest to bright at the speed
    `fastest` (twice the root-mean-square one) and above; "species"; or an array (N, 3) of red, green and
    blue from 0 to 1. The same bodies give the same pixels.

    Raises SceneError for a frame that is not there, an impossible size or an unknown colouring.
    """
    bodies = bodies_of(source, frame)
    return picture(bodies, checked_size(size), colours_of(bodies, colour, fastest))


def checked_size(size: tuple[int, int]) -> tuple[int, int]:
    """(W, H), or a SceneError."""
    if not isinstance(size, (tuple, list)) or len(size) != 2:
        raise SceneError("size", size, "must be a width and a height in pixels")
    for side in size:
        if count_of("size", side, least=16) > LARGEST_SIDE:
            raise SceneError("size", size, f"must not be above {LARGEST_SIDE}")
    return int(size[0]), int(size[1])


def picture(
    bodies: Bodies, size: tuple[int, int], colours: np.ndarray, lines: Sequence[np.ndarray] = ()
) -> np.ndarray:
    """The pixels, uint8 (H, W, 3), of bodies in these colours (N, 3); lines, (M, 2) each, lie over discs."""
    if bodies.dimension == 3:
        from gaspart.rendering.camera import camera_for
        from gaspart.rendering.tracer import trace

        camera = camera_for(bodies.lengths, *size)
        image, _ = trace(bodies.positions, bodies.radii, colours, bodies.lengths, camera, size)
    else:
        image = _plane(bodies, size, colours, lines)
    return np.rint(255.0 * image).astype(np.uint8)


def _plane(
    bodies: Bodies, size: tuple[int, int], colours: np.ndarray, lines: Sequence[np.ndarray]
) -> np.ndarray:
    from gaspart.rendering.discs import Canvas

    canvas = Canvas(bodies.lengths, size)
    canvas.discs(bodies.positions, bodies.radii, colours)
    x, y = bodies.lengths
    canvas.line(np.array([[0.0, 0.0], [x, 0.0], [x, y], [0.0, y], [0.0, 0.0]]))
    for line in (*bodies.walls, *lines):
        canvas.line(line)
    return canvas.image
