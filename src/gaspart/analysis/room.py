"""The container of the moment: faces that move, and the areas and volumes between them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaspart.errors import SceneError
from gaspart.scene.faces import Vibrating

if TYPE_CHECKING:
    from gaspart.analysis.run import Run

_POINTS = 2**14
_RATIOS = {2: 1.32471795724474602596, 3: 1.22074408460575947536}
"""Whose powers give evenly spread points: x^(d + 1) = x + 1 (Roberts 2018)."""
_INSTANTS = 64, 1024  # of an interval between frames, over which a mean is taken: the least and the most
_GOLDEN = 0.6180339887498949
_NUMBERS = 2_000_000  # of all intervals together


def sides(run: Run, times: np.ndarray) -> np.ndarray:
    """(S, d, 2) the lower and the upper end of the container along each axis at times (S,) of the run. A
    piston moves evenly between frames. Raises SceneError for frames without its place."""
    scene = run.scene
    found = np.zeros((len(times), run.dimension, 2))
    found[:, :, 1] = scene.container.lengths
    for number, face in scene.faces_of(Vibrating):
        inwards = face.places(times)
        found[:, number // 2, number % 2] += -inwards if number % 2 else inwards
    for number, _ in scene.pistons:
        if "piston_position" not in run.data:
            raise SceneError("source", "frames", "lack the place of the piston")
        place = np.interp(times, run.time, run.data["piston_position"].values)
        found[:, number // 2, number % 2] = place
    return found


def touched(run: Run, times: np.ndarray) -> np.ndarray:
    """(S, d) sides of the box that centres of the largest moving particles can reach, at times (S,)."""
    lower, upper = run.scene.reach(run.scene.largest_moving_radius)
    margins = np.array(run.scene.container.lengths) - np.subtract(upper, lower)
    return np.diff(sides(run, times), axis=2)[:, :, 0] - margins


def face_areas(run: Run) -> np.ndarray:
    """Compute the area that a pressure or a flux on each face is divided by, its mean over each interval
    between frames, (T - 1, 2d): the area that centres can reach.

    Across the axis of a piston with a load it is the area of the container, by which the load is defined. If
    particles of several sizes reach other areas, it is NaN: what faces are given is tallied per area then.
    Faces move where no fixed particle or interior wall is.
    """
    scene, intervals = run.scene, len(run.time) - 1
    if scene.has_unequal_areas:
        found = np.full((1, 2 * run.dimension), np.nan)
    else:
        found = run.accessible.areas(np.array([scene.largest_moving_radius]))
    if not scene.has_unequal_areas and scene.moving_axes:
        lower, upper = scene.reach(scene.largest_moving_radius)
        found = found + _mean_areas(run) - _across(np.subtract(upper, lower)[None]).repeat(2, axis=1)
    found = np.array(np.broadcast_to(found, (intervals, 2 * run.dimension)))
    if scene.load_axis is not None:
        loaded = slice(2 * scene.load_axis, 2 * scene.load_axis + 2)
        found[:, loaded] = np.delete(scene.container.lengths, scene.load_axis).prod()
    return found


def _mean_areas(run: Run) -> np.ndarray:
    """(T - 1, 2d) areas without obstacles, their means over each interval between frames: of a face that
    moves, over instants that are spread evenly, but not at its period."""
    intervals = len(run.time) - 1
    number = int(np.clip(_NUMBERS // intervals, *_INSTANTS))
    parts = (np.arange(number) + np.arange(1, number + 1) * _GOLDEN % 1.0) / number
    times = run.time[:-1, None] + np.diff(run.time)[:, None] * parts
    areas = _across(touched(run, times.ravel()))
    return areas.reshape(intervals, number, run.dimension).mean(axis=1).repeat(2, axis=1)


def per_area(run: Run, given: np.ndarray, tallied: str) -> np.ndarray:
    """Divide what each face is given in each interval between frames, (T - 1, 2d, ...), by the area that
    centres can reach.

    If particles of several sizes reach other areas, it is the sum over sizes of what particles of each give
    divided by their area, by the tally of this name, with the component along the normal where `given` has
    none. NaN of faces whose area then changes with time. Raises SceneError for a file without that tally.
    """
    areas = face_areas(run)
    found = given / areas.reshape(*areas.shape, *[1] * (given.ndim - 2))
    if not run.scene.has_unequal_areas:
        return np.asarray(found)
    if tallied not in run.data:
        rule = (
            "particles of several sizes reach other areas of the faces; make the run again, or measure force"
        )
        raise SceneError(tallied, "missing", rule)
    faces = np.arange(2 * run.dimension)
    weighted = run.increments(tallied)[:, faces].astype(float)
    if weighted.ndim > given.ndim:
        weighted = weighted[:, faces, faces // 2]
    moved = {number // 2 for number, face in run.scene.numbered_faces if face.moves}
    weighted[:, [bool(moved - {face // 2}) for face in faces]] = np.nan
    known = np.isfinite(areas)  # of a piston with a load
    return np.asarray(np.where(known.reshape(*known.shape, *[1] * (given.ndim - 2)), found, weighted))


def _across(lengths: np.ndarray) -> np.ndarray:
    """(..., d) the product of the other sides (..., d)."""
    axes = range(lengths.shape[-1])
    return np.stack([np.delete(lengths, axis, axis=-1).prod(axis=-1) for axis in axes], axis=-1)


def left_by_obstacles(run: Run, radius: float, axis: int, edges: np.ndarray) -> np.ndarray:
    """(bins,) the part of each bin along an axis that fixed particles leave to centres of particles of this
    radius: that of `_POINTS` points, spread evenly over the bin."""
    container, fixed = run.scene.container, ~np.isfinite(run.masses)
    lengths, widths = np.array(container.lengths), np.diff(edges)
    shares = np.empty(len(widths))
    from scipy.spatial import cKDTree

    ratio = _RATIOS[run.dimension] ** -np.arange(1.0, run.dimension + 1)
    points = np.outer(np.arange(_POINTS), ratio) % 1.0 * lengths
    across = points[:, axis] / lengths[axis]
    centres = np.where(run.periodic, run.positions[0] % lengths, run.positions[0])
    period = np.where(run.periodic, lengths, 0.0)
    sizes = np.unique(run.radii[fixed])
    trees = [cKDTree(centres[fixed & (run.radii == size)], boxsize=period) for size in sizes]
    for n, width in enumerate(widths):
        points[:, axis] = edges[n] + width * across
        left = np.ones(_POINTS, dtype=bool)
        for size, tree in zip(sizes, trees, strict=True):
            left &= ~np.isfinite(tree.query(points, distance_upper_bound=size + radius)[0])
        shares[n] = left.mean()
    return shares
