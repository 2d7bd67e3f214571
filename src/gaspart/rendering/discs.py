"""Pictures of discs, walls and paths in the plane, by area coverage of pixels."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise, product

import numpy as np

from gaspart.kernels.drawing.ray_tracing import draw_discs, draw_segments
from gaspart.rendering.surfaces import INK, DrawnSurface, arrow_lines

_MARGIN = 0.02  # fraction of the picture's shorter side
PAPER = (1.0, 1.0, 1.0)
_SHADE = (0.88, 0.88, 0.88)


def scale_of(lengths: np.ndarray, size: tuple[int, int]) -> tuple[float, np.ndarray]:
    """Return the pixels per length of a container, and the pixel (2,) of its corner. The container of
    `lengths` (2,) is in the middle of a picture of `size` (W, H).
    """
    width, height = size
    margin = max(2.0, _MARGIN * min(size))
    scale = float(min((width - 2 * margin) / lengths[0], (height - 2 * margin) / lengths[1]))
    return scale, 0.5 * (np.array([width, height]) - scale * np.asarray(lengths))


class Canvas:
    """White picture with `size` (W, H) pixels, and a centred container of `lengths` (2,)."""

    def __init__(self, lengths: np.ndarray, size: tuple[int, int]) -> None:
        width, height = size
        self.lengths, (self.scale, self.corner) = lengths, scale_of(lengths, size)
        self.image = np.ones((height, width, 3))
        self._height = height

    def _pixels(self, points: np.ndarray) -> np.ndarray:
        """Convert points (N, 2) in the container to columns and rows of pixels."""
        pixels = self.corner + self.scale * np.asarray(points, dtype=float)
        return np.column_stack([pixels[:, 0], self._height - pixels[:, 1]])

    def discs(self, positions: np.ndarray, radii: np.ndarray, colours: np.ndarray) -> None:
        """Draw discs, later discs over earlier ones. The radius is at least half a pixel."""
        draw_discs(self.image, self._pixels(positions), np.maximum(self.scale * radii, 0.5), colours)

    def cut(self, periodic: Sequence[bool]) -> None:
        """Clear the pixels outside the container along periodic axes."""
        width, height = self.lengths
        low, high = np.rint(self._pixels(np.array([[0.0, height], [width, 0.0]]))).astype(int)
        if periodic[0]:
            self.image[:, : low[0]] = self.image[:, high[0] :] = 1.0
        if periodic[1]:
            self.image[: low[1]] = self.image[high[1] :] = 1.0

    def line(self, points: np.ndarray, colour: tuple[float, ...] = INK, width: int = 1) -> None:
        """Draw a line through points."""
        half = width // 2
        for shift in product(range(-half, half + 1), repeat=2):
            corners = self._pixels(points) + np.array(shift)
            draw_segments(self.image, corners[:-1], corners[1:], np.array(colour, dtype=float))

    def outline(self, surfaces: Sequence[DrawnSurface]) -> None:
        """Draw the sides of the container, except sides with a surface of their own."""
        x, y = self.lengths
        corners = np.array([[0.0, 0.0], [x, 0.0], [x, y], [0.0, y], [0.0, 0.0]])
        for side in pairwise(corners):
            ends = np.array(sorted(side, key=tuple))
            if not any(np.allclose(sorted(surface.ends, key=tuple), ends) for surface in surfaces):
                self.line(ends)

    def shade_behind(self, surface: DrawnSurface) -> None:
        """Shade the region of the container behind a surface that has moved in."""
        if surface.depth > 0.0:
            corners = np.vstack([surface.ends, surface.ends - surface.depth * surface.inward])
            (first, right), (top, bottom) = (
                (int(np.rint(ends.min())), int(np.rint(ends.max()))) for ends in self._pixels(corners).T
            )
            self.image[max(top, 0) : bottom, max(first, 0) : right] = _SHADE

    def surface(self, surface: DrawnSurface) -> None:
        """Draw a surface: its line, dashes, hatching, arrows and the edge of its well."""
        start, end = surface.ends
        along = (end - start) / np.linalg.norm(end - start)
        unit = self._thickness / self.scale  # thickness of the line as a length
        points = np.linspace(start, end, len(surface.colours) + 1)
        for n, colour in enumerate(surface.colours):
            self._stroke(points[n : n + 2], tuple(colour), 4.0 * unit if surface.dashed else 0.0)
        colour = tuple(surface.colours[len(surface.colours) // 2])
        if surface.band:
            self._stroke(surface.ends + surface.band * surface.inward, colour, unit)
        if surface.hatched:
            has_one_side = surface.inward.any()  # a wall between two gases is hatched on both sides
            normal = surface.inward if has_one_side else np.array([-along[1], along[0]])
            count = max(2, int(np.linalg.norm(end - start) / (4.0 * unit)))
            for part in np.linspace(0.0, 1.0, count):
                foot = start + part * (end - start)
                tick = 2.5 * unit * (normal + along)
                self.line(np.array([foot if has_one_side else foot + tick, foot - tick]), INK)
        arrows = [(0.5, surface.motion)] if surface.motion is not None else []
        fractions = np.linspace(0.0, 1.0, 2 * len(surface.through) + 3)[1:-1]
        arrows += [
            (p, sign * surface.inward) for p, sign in zip(fractions, 2 * surface.through, strict=False)
        ]
        for part, direction in arrows:
            middle = start + part * (end - start) + 5.0 * unit * surface.inward  # the margin is narrow
            ends = middle - 8.0 * unit * direction, middle + 8.0 * unit * direction
            self._arrow(*ends, colour, surface.to_and_fro)

    @property
    def _thickness(self) -> int:
        """Width of the line of a surface in pixels, an odd number."""
        return max(3, round(0.004 * min(self.image.shape[:2])) // 2 * 2 + 1)

    def _stroke(self, points: np.ndarray, colour: tuple[float, ...], dash: float) -> None:
        """Draw a thick line; if `dash` is not 0, in dashes of this length."""
        if not dash:
            self.line(points, colour, self._thickness)
            return
        length = float(np.linalg.norm(points[1] - points[0]))
        count = max(1, round(length / dash) // 2 * 2 + 1)
        marks = np.linspace(points[0], points[1], count + 1)
        for n in range(0, count, 2):
            self.line(marks[n : n + 2], colour, self._thickness)

    def _arrow(self, tail: np.ndarray, head: np.ndarray, colour: tuple[float, ...], two_heads: bool) -> None:
        """Draw an arrow with a bright border, which is visible on discs of any colour."""
        lines = arrow_lines(tail, head, two_heads)
        for shade, width in ((PAPER, self._thickness + 2), (colour, self._thickness)):
            for line in lines:
                self.line(line, shade, width)

    def path(self, points: np.ndarray) -> None:
        """Draw a dark line with a bright border, which is visible on discs of any colour."""
        self.line(points, PAPER, 5)
        self.line(points, INK, 3)
