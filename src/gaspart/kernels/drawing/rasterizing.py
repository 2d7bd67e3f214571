"""Discs and lines drawn into an image by the part of each pixel that they cover."""

import math

from gaspart.kernels.compile.policy import inner_kernel, kernel

_LINE = 0.75  # half the width of lines, in pixels


@inner_kernel
def _blend(image, row, column, cover, red, green, blue):
    image[row, column, 0] += cover * (red - image[row, column, 0])
    image[row, column, 1] += cover * (green - image[row, column, 1])
    image[row, column, 2] += cover * (blue - image[row, column, 2])


@kernel
def draw_discs(image, centres, radii, colours):
    """Draw discs, later ones over earlier ones, into an image (H, W, 3)."""
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
def draw_segments(image, starts, ends, colour):
    """Draw lines between points (M, 2) into an image (H, W, 3)."""
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
