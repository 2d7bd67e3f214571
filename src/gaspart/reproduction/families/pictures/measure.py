"""Scenes to be rendered, and counts of their particles and overlaps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from scipy.spatial import cKDTree

from gaspart.analysis.statistics import means_of
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import entries

ROUNDING = 1e-5
"""Largest overlap, in diameters, that is attributed to the single precision of frames."""


def gas_render(points: list[Point], settings: dict) -> xr.Dataset:
    """Return the last frame of the first replica, and counts over all replicas.

    The counts are from the last frames; see `_scene`.
    """
    return _scene(points[0])


def brownian_render(points: list[Point], settings: dict) -> xr.Dataset:
    """Return the last frame of the large sphere in its gas, and counts.

    See `_scene`.
    """
    return _scene(points[0])


def _scene(point: Point) -> xr.Dataset:
    """Return the particles of one frame, and counts over replicas.

    `overlaps` is the number of pairs that overlap by more than rounding. `resolved` is the number of overlaps
    that the time-stepped engine detected and removed in the step before each frame; it is 0 for other
    engines. `mean_speed` is the mean speed of the last species, with the standard error over particles.
    """
    scene, lengths = point.scene, np.array(point.scene.container.lengths)
    frames, overlaps, collisions = [], 0, 0.0
    for run in runs(point):
        last = run.data[["coordinates", "velocities", "radius", "type"]].isel(frame=-1).load().astype(float)
        positions, radii = last["coordinates"].values, last["radius"].values
        overlaps += overlapping(positions, radii, lengths, scene.container.periodic)
        collisions += run.increments("collisions")[-1] / np.diff(run.time)[-1]
        frames.append(last)
    speeds = [np.sqrt((last["velocities"].values ** 2).sum(axis=1)) for last in frames]
    first, kind = frames[0], frames[0]["type"].values.astype(int)
    of_gas = np.concatenate([frame[kind == len(scene.species) - 1] for frame in speeds])
    step = point.settings["time_step"] if point.settings.get("engine") == "step" else 0.0
    return xr.Dataset(
        {
            "position": (("particle", "axis"), first["coordinates"].values, {"units": "length"}),
            "radius": ("particle", first["radius"].values, {"units": "length"}),
            "species": ("particle", kind),
            "speed": ("particle", speeds[0], {"units": "length/time"}),
            "length": ("axis", lengths, {"units": "length"}),
            "overlaps": float(overlaps),
            "resolved": step * collisions,
            **entries({"mean_speed": means_of(of_gas)}),
            "mean_square_speed": (of_gas**2).mean(),
        },
        attrs={"count": scene.count, "packing_fraction": scene.packing_fraction},
    )


def overlapping(
    positions: np.ndarray, radii: np.ndarray, lengths: np.ndarray, periodic: Sequence[bool]
) -> int:
    """Count the pairs of particles (N, d) that overlap by more than rounding.

    Particles larger than twice the median radius are few. They are compared with all others.
    """
    box = np.where(periodic, lengths, 0.0)

    def deep(i: int | np.ndarray, j: np.ndarray) -> int:
        gap = np.abs(positions[i] - positions[j])
        gap = np.where(box > 0.0, np.minimum(gap, np.abs(box - gap)), gap)
        touch = radii[i] + radii[j]
        return int(
            (np.sqrt((gap**2).sum(axis=-1)) < touch - 2.0 * ROUNDING * np.minimum(radii[i], radii[j])).sum()
        )

    is_large = radii > 2.0 * np.median(radii)
    small, large = np.flatnonzero(~is_large), np.flatnonzero(is_large)
    wrapped = np.where(box > 0.0, positions % np.where(box > 0.0, box, 1.0), positions)
    tree = cKDTree(wrapped[small], boxsize=np.where(box > 0.0, box, 0.0))
    pairs = tree.query_pairs(2.0 * radii[small].max(), output_type="ndarray")
    number = deep(small[pairs[:, 0]], small[pairs[:, 1]])
    for n, i in enumerate(large):
        others = np.concatenate([small, large[n + 1 :]])
        number += deep(np.full(len(others), i), others)
    return number
