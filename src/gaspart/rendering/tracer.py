"""Small ray tracer for spheres on the floor of a container, with one lamp and shadows.

Ambient light is added.

Rays find spheres through a grid of cells. Each near sphere dims the ambient light by the fraction of the sky
that it covers. This is computed in closed form, without random rays, and therefore without noise. One ray
passes through the middle of each pixel. If neighbouring pixels show different objects, SUBRAYS x SUBRAYS rays
are used instead.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from gaspart.kernels.drawing.ray_tracing import (
    EDGE,
    FLOOR,
    NOTHING,
    SPHERE,
    list_spheres,
    refine,
    render_once,
)
from gaspart.rendering.camera import Camera, edges_of, segments

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
    """Trace a picture (H, W, 3), from 0 to 1, and the objects in its pixels. `positions` and `radii` and
    `colours`: shapes (N, 3), (N,), (N, 3). `lengths`: (3,), sides of the container, whose face at z = 0 is
    drawn as the floor. `size`: (W, H) in pixels. `lines`: (M, 2, 3), drawn like the edges of the container.
    The function returns the picture, and the kind of object in the middle of each pixel (H, W).
    """
    spheres = np.column_stack([positions, radii]).astype(float)
    grid = cells(spheres, np.asarray(lengths, dtype=float))
    width, height = size
    image, objects = np.empty((height, width, 3)), np.empty((height, width), dtype=np.int64)
    view = np.array([camera.eye, camera.forward, camera.right, camera.up, camera.light])
    scales = (camera.half_width, camera.half_height, camera.near, camera.far)
    edges = edges_of(lengths)
    if lines is not None and len(lines):
        edges = np.vstack([edges, segments(lines)])
    scene = (spheres, np.asarray(colours, dtype=float) ** _GAMMA, edges, np.array(lengths, float))
    skies = np.empty((height, width))
    render_once(image, objects, skies, view, scales, scene, grid)
    around = sliding_window_view(np.pad(objects, 1, mode="edge"), (3, 3))
    mixed = (around != objects[..., None, None]).any(axis=(2, 3))
    refine(image, objects, skies, np.argwhere(mixed), view, scales, scene, grid)
    return np.clip(image, 0.0, 1.0) ** (1.0 / _GAMMA), objects


def cells(spheres: np.ndarray, lengths: np.ndarray) -> tuple:
    """Divide container and spheres into cubic cells, and list the spheres in each cell. The function returns
    the lowest corner (3,), the side of a cell, the numbers of cells (3,), the lists of the spheres that reach
    into each cell c (listed[first[c] : first[c + 1]]), and each sphere's lowest cell (N, 3).
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
