"""Discs, walls and paths in the plane, drawn by the fraction of each pixel that they cover."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from gaspart.kernels.drawing.rasterizing import draw_discs, draw_segments

_MARGIN = 0.02  # of the picture's shorter side
INK, PAPER = (0.16, 0.16, 0.16), (1.0, 1.0, 1.0)


def scale_of(lengths: np.ndarray, size: tuple[int, int]) -> tuple[float, np.ndarray]:
    """Pixels per length of a container of `lengths` (2,) in the middle of a picture of `size` (W, H), and
    where its corner is (2,)."""
    width, height = size
    margin = max(2.0, _MARGIN * min(size))
    scale = float(min((width - 2 * margin) / lengths[0], (height - 2 * margin) / lengths[1]))
    return scale, 0.5 * (np.array([width, height]) - scale * np.asarray(lengths))


class Canvas:
    """A white picture of `size` (W, H) pixels, with a container of `lengths` (2,) in the middle."""

    def __init__(self, lengths: np.ndarray, size: tuple[int, int]) -> None:
        width, height = size
        self.lengths, (self.scale, self.corner) = lengths, scale_of(lengths, size)
        self.image = np.ones((height, width, 3))
        self._height = height

    def _pixels(self, points: np.ndarray) -> np.ndarray:
        """Points (N, 2) of the container as columns and rows of pixels."""
        places = self.corner + self.scale * np.asarray(points, dtype=float)
        return np.column_stack([places[:, 0], self._height - places[:, 1]])

    def discs(self, positions: np.ndarray, radii: np.ndarray, colours: np.ndarray) -> None:
        """Discs, later ones over earlier ones; none smaller than half a pixel in radius."""
        draw_discs(self.image, self._pixels(positions), np.maximum(self.scale * radii, 0.5), colours)

    def cut(self, periodic: Sequence[bool]) -> None:
        """Leave white what lies beyond the container along the axes that are periodic."""
        width, height = self.lengths
        low, high = np.rint(self._pixels(np.array([[0.0, height], [width, 0.0]]))).astype(int)
        if periodic[0]:
            self.image[:, : low[0]] = self.image[:, high[0] :] = 1.0
        if periodic[1]:
            self.image[: low[1]] = self.image[high[1] :] = 1.0

    def line(self, points: np.ndarray, colour: tuple[float, float, float] = INK, width: int = 1) -> None:
        """A line through points (N, 2), `width` pixels wide (odd)."""
        half = width // 2
        for shift in product(range(-half, half + 1), repeat=2):
            places = self._pixels(points) + np.array(shift)
            draw_segments(self.image, places[:-1], places[1:], np.array(colour, dtype=float))

    def path(self, points: np.ndarray) -> None:
        """A line through points (N, 2) that is seen on discs of any colour: dark, with a bright border."""
        self.line(points, PAPER, 5)
        self.line(points, INK, 3)
