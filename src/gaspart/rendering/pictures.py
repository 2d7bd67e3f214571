"""A picture of particles in given colours, as an array of pixels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from gaspart.errors import SceneError
from gaspart.files import FileKind, begins_with
from gaspart.kernels.drawing.ray_tracing import (
    EDGE,
    FLOOR,
    NOTHING,
    SPHERE,
    draw_discs,
    draw_segments,
    list_spheres,
    refine,
    render_once,
)
from gaspart.keys.values import count_of, number
from gaspart.rendering.particles import DrawnParticles
from gaspart.rendering.surfaces import INK, DrawnSurface

# The camera of a picture of spheres: outside the container, which is completely in the picture.


CAMERA = (298.0, 24.0)
"""Azimuth and elevation of the camera in degrees: from the x axis about the z axis, and above the horizon."""
HALF_WIDTH = 0.26
"""Tangent of half the angle of view across the picture's longer side."""
MARGIN = 1.04


@dataclass(frozen=True)
class Camera:
    """Camera of the ray tracer.

    eye : (3,), position.
    forward, right, up : (3,), unit vectors.
    half_width, half_height : tangents of half the angles of view.
    near, far : distances along `forward` between which the container is.
    light : (3,), unit vector to the lamp, at the upper left behind the camera.
    """

    eye: np.ndarray
    forward: np.ndarray
    right: np.ndarray
    up: np.ndarray
    half_width: float
    half_height: float
    near: float
    far: float
    light: np.ndarray

    def pixels_per_length(self, point: np.ndarray, width: int) -> float:
        """Return the pixels per length at a point (3,), in a picture `width` pixels wide.

        The length is measured across the view.
        """
        return 0.5 * width / (self.half_width * float((point - self.eye) @ self.forward))

    def pixels(self, points: np.ndarray, size: tuple[int, int]) -> np.ndarray:
        """Return the columns and rows (M, 2) of points (M, 3) in a picture.

        The picture has the size (W, H).
        """
        away = points - self.eye
        slopes = np.column_stack([away @ self.right, -(away @ self.up)]) / (away @ self.forward)[:, None]
        return 0.5 * np.array(size) * (1.0 + slopes / np.array([self.half_width, self.half_height]))


def camera_for(
    lengths: np.ndarray,
    width: int,
    height: int,
    direction: tuple[float, float] = CAMERA,
    reach: float = 0.0,
) -> Camera:
    """Return the camera for which a container just fills a picture.

    The container has `lengths` (3,); objects within `reach` around it are included. The direction is
    (azimuth, elevation).
    """
    azimuth, elevation = np.radians(direction)
    outward = np.array(
        [np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)]
    )
    forward, right = -outward, np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    up = np.cross(right, forward)
    half = HALF_WIDTH * np.array([width, height]) / max(width, height)
    corners = (np.array(list(product((0.0, 1.0), repeat=3))) - 0.5) * (np.asarray(lengths) + 2.0 * reach)
    depth = corners @ forward

    def seen(distance: float) -> np.ndarray:
        """Return the lowest and highest slope of the corners, to the right and upwards."""
        slopes = np.array([corners @ right, corners @ up]) / (distance + depth)
        return np.array([slopes.min(axis=1), slopes.max(axis=1)])

    near, far = -depth.min() * 1.001, 1e3 * float(np.linalg.norm(lengths))
    for _ in range(60):
        distance = 0.5 * (near + far)
        fits = (0.5 * MARGIN * np.ptp(seen(distance), axis=0) <= half).all()
        near, far = (near, distance) if fits else (distance, far)
    aside, above = seen(far).mean(axis=0) * far  # the container in the middle, whatever the perspective
    light = 0.9 * outward - 0.55 * right + np.array([0.0, 0.0, 1.2])
    return Camera(
        eye=0.5 * np.asarray(lengths) - far * forward + aside * right + above * up,
        forward=forward,
        right=right,
        up=up,
        half_width=float(half[0]),
        half_height=float(half[1]),
        near=float(far + depth.min()),
        far=float(far + depth.max()),
        light=light / np.linalg.norm(light),
    )


def edges_of(lengths: np.ndarray) -> np.ndarray:
    """Return the edges (12, 7) of the container: a corner, the unit vector along, the length."""
    return np.array(
        [
            [*np.insert(ends, axis, 0.0) * lengths, *np.eye(3)[axis], lengths[axis]]
            for axis in range(3)
            for ends in product((0.0, 1.0), repeat=2)
        ]
    )


def segments(lines: np.ndarray) -> np.ndarray:
    """Convert lines (M, 2, 3), from end to end, to the form (M, 7) of edges."""
    along = lines[:, 1] - lines[:, 0]
    lengths = np.linalg.norm(along, axis=1, keepdims=True)
    return np.hstack([lines[:, 0], along / lengths, lengths])


PICTURE = FileKind("a PNG picture", begins_with(b"\x89PNG\r\n\x1a\n"))
SIZE = (1000, 750)
LARGEST_SIDE = 20_000


def checked_size(size: tuple[int, int]) -> tuple[int, int]:
    """Return a valid size (W, H), or raise SceneError."""
    if not isinstance(size, (tuple, list)) or len(size) != 2:
        raise SceneError("size", size, "must be a width and a height in pixels")
    for side in size:
        if count_of("size", side, least=16) > LARGEST_SIDE:
            raise SceneError("size", size, f"must not be above {LARGEST_SIDE}")
    return int(size[0]), int(size[1])


def checked_camera(camera: tuple[float, float] | None, dimension: int) -> tuple[float, float]:
    """Return azimuth and elevation in degrees, by default for None, or raise SceneError."""
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
    """Return the scale of a picture; of spheres, in the middle of the container."""
    lengths = particles.lengths
    if len(lengths) == 2:
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
    """Draw particles in these colours (N, 3), as pixels, uint8 (H, W, 3).

    paths : arrays (M, 2), drawn over discs.
    direction : azimuth and elevation of the camera for spheres, in degrees.
    """
    if particles.dimension == 3:
        camera = camera_for(particles.lengths, *size, direction, particles.reach)
        lengths, walls = particles.lengths, particles.walls
        image, _ = trace(particles.positions, particles.radii, colours, lengths, camera, size, walls)
        return _with_surfaces(np.rint(255.0 * image).astype(np.uint8), particles, camera)
    return np.rint(255.0 * _plane(particles, size, colours, paths)).astype(np.uint8)


def _with_surfaces(image: np.ndarray, particles: DrawnParticles, camera: Camera) -> np.ndarray:
    """Return a picture of spheres with the outlines of the surfaces over it, in their colours."""
    if not particles.surfaces:
        return image
    from PIL import Image, ImageDraw

    height, width = image.shape[:2]
    paper = Image.fromarray(image)
    draw = ImageDraw.Draw(paper)
    for surface in particles.surfaces:
        middle = surface.ends.mean(axis=0)
        around = middle + 0.985 * (surface.ends - middle)  # beside the edges that other faces share
        parts = 15 if surface.dashed else len(surface.colours)
        for start, end in pairwise([*around, around[0]]):
            marks = camera.pixels(np.linspace(start, end, parts + 1), (width, height))
            for n in range(0, parts, 2 if surface.dashed else 1):
                shade = surface.colours[n * len(surface.colours) // parts]
                fill = tuple(np.rint(255.0 * shade).astype(int).tolist())
                draw.line([tuple(marks[n]), tuple(marks[n + 1])], fill, max(2, min(width, height) // 250))
    return np.asarray(paper)


def _plane(
    particles: DrawnParticles, size: tuple[int, int], colours: np.ndarray, paths: Sequence[np.ndarray]
) -> np.ndarray:

    canvas = Canvas(particles.lengths, size)
    for surface in particles.surfaces:
        canvas.shade_behind(surface)
    shown, shifts = _images(particles)
    canvas.discs(particles.positions[shown] + shifts, particles.radii[shown], colours[shown])
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
    """Return indices (M,) of particles and shifts (M, d) of their images.

    These are all discs, then the periodic images of discs that cross a periodic face.
    """
    radii, lengths = particles.radii[:, None], particles.lengths
    steps = [(0, -1, 1) if periodic else (0,) for periodic in particles.periodic[: particles.dimension]]
    indices, shifts = [], []
    for step in product(*steps):
        shift = np.array(step) * lengths
        places = particles.positions + shift
        inside = ((places > -radii) & (places < lengths + radii)).all(axis=1)
        chosen = np.flatnonzero(inside) if any(step) else np.arange(len(radii))
        indices.append(chosen)
        shifts.append(np.broadcast_to(shift, (len(chosen), len(lengths))))
    return np.concatenate(indices), np.concatenate(shifts)


# Discs, walls and paths in the plane, drawn by the fraction of each pixel that they cover.


_MARGIN = 0.02  # of the picture's shorter side
PAPER = (1.0, 1.0, 1.0)
_SHADE = (0.88, 0.88, 0.88)


def scale_of(lengths: np.ndarray, size: tuple[int, int]) -> tuple[float, np.ndarray]:
    """Return the pixels per length of a container, and the pixel (2,) of its corner.

    The container of `lengths` (2,) is in the middle of a picture of `size` (W, H).
    """
    width, height = size
    margin = max(2.0, _MARGIN * min(size))
    scale = float(min((width - 2 * margin) / lengths[0], (height - 2 * margin) / lengths[1]))
    return scale, 0.5 * (np.array([width, height]) - scale * np.asarray(lengths))


class Canvas:
    """White picture of `size` (W, H) pixels, with a container of `lengths` (2,) in the middle."""

    def __init__(self, lengths: np.ndarray, size: tuple[int, int]) -> None:
        width, height = size
        self.lengths, (self.scale, self.corner) = lengths, scale_of(lengths, size)
        self.image = np.ones((height, width, 3))
        self._height = height

    def _pixels(self, points: np.ndarray) -> np.ndarray:
        """Convert points (N, 2) of the container to columns and rows of pixels."""
        places = self.corner + self.scale * np.asarray(points, dtype=float)
        return np.column_stack([places[:, 0], self._height - places[:, 1]])

    def discs(self, positions: np.ndarray, radii: np.ndarray, colours: np.ndarray) -> None:
        """Draw discs, later ones over earlier ones; none smaller than half a pixel in radius."""
        draw_discs(self.image, self._pixels(positions), np.maximum(self.scale * radii, 0.5), colours)

    def cut(self, periodic: Sequence[bool]) -> None:
        """Clear the pixels beyond the container along the axes that are periodic."""
        width, height = self.lengths
        low, high = np.rint(self._pixels(np.array([[0.0, height], [width, 0.0]]))).astype(int)
        if periodic[0]:
            self.image[:, : low[0]] = self.image[:, high[0] :] = 1.0
        if periodic[1]:
            self.image[: low[1]] = self.image[high[1] :] = 1.0

    def line(self, points: np.ndarray, colour: tuple[float, ...] = INK, width: int = 1) -> None:
        """Draw a line through points (N, 2), `width` pixels wide (odd)."""
        half = width // 2
        for shift in product(range(-half, half + 1), repeat=2):
            places = self._pixels(points) + np.array(shift)
            draw_segments(self.image, places[:-1], places[1:], np.array(colour, dtype=float))

    def outline(self, surfaces: Sequence[DrawnSurface]) -> None:
        """Draw the sides of the container, without those on which a surface lies."""
        x, y = self.lengths
        corners = np.array([[0.0, 0.0], [x, 0.0], [x, y], [0.0, y], [0.0, 0.0]])
        for side in pairwise(corners):
            ends = np.array(sorted(side, key=tuple))
            if not any(np.allclose(sorted(one.ends, key=tuple), ends) for one in surfaces):
                self.line(ends)

    def shade_behind(self, surface: DrawnSurface) -> None:
        """Shade the part of the container behind a surface that has moved in."""
        if surface.depth > 0.0:
            corners = np.vstack([surface.ends, surface.ends - surface.depth * surface.inward])
            (left, right), (top, bottom) = (
                (int(np.rint(ends.min())), int(np.rint(ends.max()))) for ends in self._pixels(corners).T
            )
            self.image[max(top, 0) : bottom, max(left, 0) : right] = _SHADE

    def surface(self, surface: DrawnSurface) -> None:
        """Draw a surface: its line, dashes, hatching, arrows and the edge of its well."""
        start, end = surface.ends
        along = (end - start) / np.linalg.norm(end - start)
        unit = self._thickness / self.scale  # the thickness of the line as a length
        points = np.linspace(start, end, len(surface.colours) + 1)
        for n, colour in enumerate(surface.colours):
            self._stroke(points[n : n + 2], tuple(colour), 4.0 * unit if surface.dashed else 0.0)
        colour = tuple(surface.colours[len(surface.colours) // 2])
        if surface.band:
            self._stroke(surface.ends + surface.band * surface.inward, colour, unit)
        if surface.hatched:
            count = max(2, int(np.linalg.norm(end - start) / (4.0 * unit)))
            for part in np.linspace(0.0, 1.0, count):
                foot = start + part * (end - start)
                self.line(np.array([foot, foot - 2.5 * unit * (surface.inward + along)]), INK)
        arrows = [(0.5, surface.motion)] if surface.motion is not None else []
        places = np.linspace(0.0, 1.0, 2 * len(surface.through) + 3)[1:-1]
        arrows += [(p, sign * surface.inward) for p, sign in zip(places, 2 * surface.through, strict=False)]
        for part, direction in arrows:
            middle = start + part * (end - start) + 5.0 * unit * surface.inward  # the margin is narrow
            self._arrow(middle - 8.0 * unit * direction, middle + 8.0 * unit * direction, colour)

    @property
    def _thickness(self) -> int:
        """Width of the line of a surface in pixels, odd."""
        return max(3, round(0.004 * min(self.image.shape[:2])) // 2 * 2 + 1)

    def _stroke(self, points: np.ndarray, colour: tuple[float, ...], dash: float) -> None:
        """Draw a thick line, in dashes of this length unless it is 0."""
        if not dash:
            self.line(points, colour, self._thickness)
            return
        length = float(np.linalg.norm(points[1] - points[0]))
        count = max(1, round(length / dash) // 2 * 2 + 1)
        marks = np.linspace(points[0], points[1], count + 1)
        for n in range(0, count, 2):
            self.line(marks[n : n + 2], colour, self._thickness)

    def _arrow(self, tail: np.ndarray, head: np.ndarray, colour: tuple[float, ...]) -> None:
        """Draw an arrow with a bright border, which is visible on discs of any colour."""
        back = 0.25 * (tail - head)
        barbs = [head + back + sign * 0.6 * np.array([-back[1], back[0]]) for sign in (-1.0, 1.0)]
        lines = [np.array([tail, head]), *(np.array([barb, head]) for barb in barbs)]
        for shade, width in ((PAPER, self._thickness + 2), (colour, self._thickness)):
            for line in lines:
                self.line(line, shade, width)

    def path(self, points: np.ndarray) -> None:
        """Draw a dark line with a bright border through points (N, 2).

        It is visible on discs of any colour.
        """
        self.line(points, PAPER, 5)
        self.line(points, INK, 3)


# A small ray tracer for spheres on the floor of a container: one lamp, its shadows, and ambient light.
#
# Rays find spheres through a grid of cells. Ambient light is dimmed by each near sphere by the part of the
# sky that it covers, in closed form, without random rays and without noise. One ray goes through
# the middle of each pixel; where neighbours show different objects, SUBRAYS x SUBRAYS take its place.


__all__ = ["EDGE", "FLOOR", "NOTHING", "SPHERE", "cells", "trace"]
_GAMMA = 2.2


def trace(
    positions: np.ndarray,
    radii: np.ndarray,
    colours: np.ndarray,
    lengths: np.ndarray,
    camera: Camera,
    size: tuple[int, int],
    lines: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Trace a picture (H, W, 3), from 0 to 1, and the objects in its pixels.

    positions, radii, colours : (N, 3), (N,), (N, 3).
    lengths : (3,), sides of the container, whose lower face is the floor.
    size : (W, H) in pixels.
    lines : (M, 2, 3), drawn like the edges of the container.

    Returned are the picture and the kind of object in the middle of each pixel (H, W).
    """
    spheres = np.column_stack([positions, radii]).astype(float)
    grid = cells(spheres, np.asarray(lengths, dtype=float))
    width, height = size
    image, shown = np.empty((height, width, 3)), np.empty((height, width), dtype=np.int64)
    view = np.array([camera.eye, camera.forward, camera.right, camera.up, camera.light])
    scales = (camera.half_width, camera.half_height, camera.near, camera.far)
    edges = edges_of(lengths)
    if lines is not None and len(lines):
        edges = np.vstack([edges, segments(lines)])
    scene = (spheres, np.asarray(colours, dtype=float) ** _GAMMA, edges, np.array(lengths, float))
    render_once(image, shown, view, scales, scene, grid)
    around = sliding_window_view(np.pad(shown, 1, mode="edge"), (3, 3))
    mixed = (around != shown[..., None, None]).any(axis=(2, 3))
    refine(image, np.argwhere(mixed), view, scales, scene, grid)
    return np.clip(image, 0.0, 1.0) ** (1.0 / _GAMMA), shown


def cells(spheres: np.ndarray, lengths: np.ndarray) -> tuple:
    """Divide container and spheres into cubic cells, and list the spheres in each cell.

    Returned are the lowest corner (3,), the side, the numbers (3,), the lists of the spheres that reach into
    each cell (listed[first[c] : first[c + 1]]), and each sphere's lowest cell (N, 3).
    """
    low, high = np.zeros(3), lengths.copy()
    side = float(lengths.max())
    if len(spheres):
        low = np.minimum(low, (spheres[:, :3] - spheres[:, 3:]).min(axis=0))
        high = np.maximum(high, (spheres[:, :3] + spheres[:, 3:]).max(axis=0))
        side = max(((high - low).prod() / len(spheres)) ** (1 / 3), 2.5 * float(np.median(spheres[:, 3])))
    numbers = np.maximum(1, np.ceil((high - low) / side)).astype(np.int64)
    lowest, highest = (
        np.clip(((spheres[:, :3] + sign * spheres[:, 3:] - low) / side).astype(np.int64), 0, numbers - 1)
        for sign in (-1.0, 1.0)
    )
    first = np.zeros(numbers.prod() + 1, dtype=np.int64)
    list_spheres(lowest, highest, numbers, first[1:], np.empty(0, dtype=np.int64))
    listed = np.empty(first.sum(), dtype=np.int64)
    first = np.cumsum(first)
    list_spheres(lowest, highest, numbers, first[:-1].copy(), listed)
    return low, side, numbers, first, listed, lowest
