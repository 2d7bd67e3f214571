"""Discs, walls and paths in the plane, drawn by the part of each pixel that they cover."""

from __future__ import annotations

import math

import numpy as np

from gaspart.kernel import kernel

_MARGIN = 0.02  # of the picture's shorter side
_LINE = 0.75  # half the width of lines, in pixels
INK = (0.16, 0.16, 0.16)


class Canvas:
    """A white picture of `size` (W, H) pixels, in the middle of which lies a container of `lengths` (2,)."""

    def __init__(self, lengths: np.ndarray, size: tuple[int, int]) -> None:
        width, height = size
        margin = max(2.0, _MARGIN * min(size))
        self.scale = float(min((width - 2 * margin) / lengths[0], (height - 2 * margin) / lengths[1]))
        self.corner = 0.5 * (np.array([width, height]) - self.scale * np.asarray(lengths))
        self.image = np.ones((height, width, 3))
        self._height = height

    def _pixels(self, points: np.ndarray) -> np.ndarray:
        """Points (N, 2) of the container as columns and rows of pixels."""
        places = self.corner + self.scale * np.asarray(points, dtype=float)
        return np.column_stack([places[:, 0], self._height - places[:, 1]])

    def discs(self, positions: np.ndarray, radii: np.ndarray, colours: np.ndarray) -> None:
        """Discs, later ones over earlier ones; none smaller than half a pixel in radius."""
        _discs(self.image, self._pixels(positions), np.maximum(self.scale * radii, 0.5), colours)

    def line(self, points: np.ndarray, colour: tuple[float, float, float] = INK) -> None:
        """A line through points (N, 2)."""
        places = self._pixels(points)
        _segments(self.image, places[:-1], places[1:], np.array(colour, dtype=float))


@kernel
def _blend(image, row, column, cover, red, green, blue):
    image[row, column, 0] += cover * (red - image[row, column, 0])
    image[row, column, 1] += cover * (green - image[row, column, 1])
    image[row, column, 2] += cover * (blue - image[row, column, 2])


@kernel
def _discs(image, centres, radii, colours):
    height, width = image.shape[0], image.shape[1]
    for i in range(len(centres)):
        x, y, r = centres[i, 0], centres[i, 1], radii[i]
        for row in range(max(int(y - r - 1.0), 0), min(int(y + r + 2.0), height)):
            for column in range(max(int(x - r - 1.0), 0), min(int(x + r + 2.0), width)):
                cover = r + 0.5 - math.sqrt((column + 0.5 - x) ** 2 + (row + 0.5 - y) ** 2)
                if cover > 0.0:
                    c = colours[i]
                    _blend(image, row, column, min(cover, 1.0), c[0], c[1], c[2])


@kernel
def _segments(image, starts, ends, colour):
    height, width = image.shape[0], image.shape[1]
    for m in range(len(starts)):
        ax, ay = starts[m, 0], starts[m, 1]
        ux, uy = ends[m, 0] - ax, ends[m, 1] - ay
        square = ux * ux + uy * uy
        low_x, high_x = min(ax, ends[m, 0]) - _LINE - 1.0, max(ax, ends[m, 0]) + _LINE + 2.0
        low_y, high_y = min(ay, ends[m, 1]) - _LINE - 1.0, max(ay, ends[m, 1]) + _LINE + 2.0
        for row in range(max(int(low_y), 0), min(int(high_y), height)):
            for column in range(max(int(low_x), 0), min(int(high_x), width)):
                x, y = column + 0.5 - ax, row + 0.5 - ay
                s = min(max((x * ux + y * uy) / square, 0.0), 1.0) if square > 0.0 else 0.0
                cover = _LINE + 0.5 - math.sqrt((x - s * ux) ** 2 + (y - s * uy) ** 2)
                if cover > 0.0:
                    _blend(image, row, column, min(cover, 1.0), colour[0], colour[1], colour[2])
