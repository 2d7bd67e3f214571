"""Camera for pictures of spheres, outside the container, which is completely visible."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

CAMERA = (298.0, 24.0)
"""Azimuth and elevation of the camera in degrees: angle from the x axis about the z axis, and angle above the
horizon."""
HALF_WIDTH = 0.26
"""Tangent of half the angle of view along the longer side of the picture."""
MARGIN = 1.04


@dataclass(frozen=True)
class Camera:
    """Camera of the ray tracer.

    eye : (3,), position.
    forward, right, up : (3,), unit vectors.
    half_width, half_height : tangents of half the angles of view.
    near, far : smallest and largest distance of the container along `forward`.
    light : (3,), unit vector to the lamp, which is at the upper left behind the camera.
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
        """Return the pixels per length at a point (3,), in a picture `width` pixels wide. The length is
        measured across the view.
        """
        return 0.5 * width / (self.half_width * float((point - self.eye) @ self.forward))

    def pixels(self, points: np.ndarray, size: tuple[int, int]) -> np.ndarray:
        """Return the columns and rows of points in a picture."""
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
    """Return the camera with which a container just fills a picture. The container has `lengths` (3,);
    objects within `reach` around it are included. The direction is (azimuth, elevation).
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

    def slope_range(distance: float) -> np.ndarray:
        """Return the lowest and highest slope of the corners, to the right and upwards."""
        slopes = np.array([corners @ right, corners @ up]) / (distance + depth)
        return np.array([slopes.min(axis=1), slopes.max(axis=1)])

    near, far = -depth.min() * 1.001, 1e3 * float(np.linalg.norm(lengths))
    for _ in range(60):
        distance = 0.5 * (near + far)
        fits = (0.5 * MARGIN * np.ptp(slope_range(distance), axis=0) <= half).all()
        near, far = (near, distance) if fits else (distance, far)
    aside, above = slope_range(far).mean(axis=0) * far  # centres the container, for any perspective
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
    """Return the edges (12, 7) of the container: a corner, unit vector along the edge, length."""
    return np.array(
        [
            [*np.insert(ends, axis, 0.0) * lengths, *np.eye(3)[axis], lengths[axis]]
            for axis in range(3)
            for ends in product((0.0, 1.0), repeat=2)
        ]
    )


def segments(lines: np.ndarray) -> np.ndarray:
    """Convert lines (M, 2, 3), given by their ends, to the form (M, 7) of edges."""
    along = lines[:, 1] - lines[:, 0]
    lengths = np.linalg.norm(along, axis=1, keepdims=True)
    return np.hstack([lines[:, 0], along / lengths, lengths])
