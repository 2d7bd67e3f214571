"""Picture of particles with prescribed colours, as an array of pixels."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise, product

import numpy as np

from gaspart.errors import SceneError
from gaspart.files import FileKind, begins_with
from gaspart.keys.values import count_of, number
from gaspart.rendering.camera import CAMERA, Camera, camera_for
from gaspart.rendering.particles import DrawnParticles
from gaspart.rendering.surfaces import arrow_lines

PICTURE = FileKind("a PNG picture", begins_with(b"\x89PNG\r\n\x1a\n"))
SIZE = (1000, 750)
LARGEST_SIDE = 20_000


def checked_size(size: tuple[int, int]) -> tuple[int, int]:
    """Return a valid size (W, H). Raises SceneError for other values."""
    if not isinstance(size, (tuple, list)) or len(size) != 2:
        raise SceneError("size", size, "must be a width and a height in pixels")
    for side in size:
        if count_of("size", side, least=16) > LARGEST_SIDE:
            raise SceneError("size", size, f"must not be above {LARGEST_SIDE}")
    return int(size[0]), int(size[1])


def checked_camera(camera: tuple[float, float] | None, dimension: int) -> tuple[float, float]:
    """Return azimuth and elevation in degrees, with a default for None. Raises SceneError for other
    values.
    """
    if camera is None:
        return CAMERA
    if dimension == 2:
        raise SceneError("camera", camera, "is for spheres: discs are seen from above")
    if not isinstance(camera, (tuple, list)) or len(camera) != 2:
        raise SceneError("camera", camera, "must be an azimuth and an elevation in degrees")
    rule = "an azimuth must be from -360 to 360, an elevation from 0 to 90 degrees"
    azimuth = number("camera", camera[0], rule, least=-360.0, most=360.0)
    return azimuth, number("camera", camera[1], rule, least=0.0, most=90.0)


def pixels_per_length(particles: DrawnParticles, size: tuple[int, int], camera: tuple[float, float]) -> float:
    """Return the scale of a picture; for spheres, the scale in the middle of the container."""
    lengths = particles.lengths
    if len(lengths) == 2:
        from gaspart.rendering.discs import scale_of

        return scale_of(lengths, size)[0]
    view = camera_for(lengths, *size, camera, particles.reach)
    return view.pixels_per_length(0.5 * lengths, size[0])


def picture(
    particles: DrawnParticles,
    size: tuple[int, int],
    colours: np.ndarray,
    paths: Sequence[np.ndarray] = (),
    direction: tuple[float, float] = CAMERA,
) -> np.ndarray:
    """Draw particles with colours (N, 3), and return pixels, uint8 (H, W, 3). `paths`: arrays (M, 2), drawn
    over discs. `direction`: azimuth and elevation of the camera for spheres, in degrees.
    """
    if particles.dimension == 3:
        from gaspart.rendering.tracer import trace

        camera = camera_for(particles.lengths, *size, direction, particles.reach)
        lengths, walls = particles.lengths, particles.walls
        image, _ = trace(particles.positions, particles.radii, colours, lengths, camera, size, walls)
        return _with_surfaces(np.rint(255.0 * image).astype(np.uint8), particles, camera)
    return np.rint(255.0 * _plane(particles, size, colours, paths)).astype(np.uint8)


def _with_surfaces(image: np.ndarray, particles: DrawnParticles, camera: Camera) -> np.ndarray:
    """Draw outlines of surfaces, and arrows of their motion, over a picture of spheres."""
    if not particles.surfaces:
        return image
    from PIL import Image, ImageDraw

    height, width = image.shape[:2]
    paper = Image.fromarray(image)
    draw = ImageDraw.Draw(paper)
    thick = max(2, min(width, height) // 250)
    for surface in particles.surfaces:
        middle = surface.ends.mean(axis=0)
        around = middle + 0.985 * (surface.ends - middle)  # next to the edges that other faces share
        parts = 15 if surface.dashed else len(surface.colours)
        for start, end in pairwise([*around, around[0]]):
            marks = camera.pixels(np.linspace(start, end, parts + 1), (width, height))
            for n in range(0, parts, 2 if surface.dashed else 1):
                shade = surface.colours[n * len(surface.colours) // parts]
                fill = tuple(np.rint(255.0 * shade).astype(int).tolist())
                draw.line([tuple(marks[n]), tuple(marks[n + 1])], fill, thick)
        if surface.motion is not None:
            half = 0.12 * min(particles.lengths) * surface.motion
            tail, head = camera.pixels(np.array([middle - half, middle + half]), (width, height))
            lines = arrow_lines(tail, head, surface.to_and_fro)
            for ink, wide in (((255, 255, 255), thick + 2), (fill, thick)):  # visible on any colour
                for line in lines:
                    draw.line([tuple(line[0]), tuple(line[1])], ink, wide)
    return np.asarray(paper)


def _plane(
    particles: DrawnParticles, size: tuple[int, int], colours: np.ndarray, paths: Sequence[np.ndarray]
) -> np.ndarray:
    from gaspart.rendering.discs import Canvas

    canvas = Canvas(particles.lengths, size)
    for surface in particles.surfaces:
        canvas.shade_behind(surface)
    indices, shifts = _images(particles)
    canvas.discs(particles.positions[indices] + shifts, particles.radii[indices], colours[indices])
    canvas.cut(particles.periodic[:2])
    canvas.outline(particles.surfaces)
    for wall in particles.walls:
        canvas.line(wall)
    for surface in particles.surfaces:
        canvas.surface(surface)
    for path in paths:
        canvas.path(path)
    return canvas.image


def _images(particles: DrawnParticles) -> tuple[np.ndarray, np.ndarray]:
    """Return the indices (M,) of the drawn discs, and the shifts (M, d) of their images. First are all discs,
    then the periodic images of discs that cross a periodic face.
    """
    radii, lengths = particles.radii[:, None], particles.lengths
    steps = [(0, -1, 1) if periodic else (0,) for periodic in particles.periodic[: particles.dimension]]
    indices, shifts = [], []
    for step in product(*steps):
        shift = np.array(step) * lengths
        positions = particles.positions + shift
        inside = ((positions > -radii) & (positions < lengths + radii)).all(axis=1)
        chosen = np.flatnonzero(inside) if any(step) else np.arange(len(radii))
        indices.append(chosen)
        shifts.append(np.broadcast_to(shift, (len(chosen), len(lengths))))
    return np.concatenate(indices), np.concatenate(shifts)
