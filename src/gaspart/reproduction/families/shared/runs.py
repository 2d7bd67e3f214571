"""The measured part of the replicas of a point, and their time correlations."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gaspart.analysis.motion import Curves, average_correlations
from gaspart.analysis.run import Run
from gaspart.errors import SceneError
from gaspart.reproduction.points.point import Point
from gaspart.scene.gas import plain_gas
from gaspart.trajectory.reading import open_trajectory


def runs(point: Point, first: int | None = None) -> Iterator[Run]:
    """Yield the frames of each replica after its equilibration or from frame `first` on.

    Each run is open until the next one is requested. Raises OSError for a file that cannot be read and
    ValueError for one of another point.
    """
    scene, schedule = point.scene, point.schedule
    before = schedule.equilibration_frames
    more = scene.gravity, scene.faces, scene.walls, scene.particles, scene.thermostat, scene.rough
    centred = not any(more) and all(kind.exact_temperature for kind in scene.species)
    kept = slice(before if first is None else first, None)
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            if trajectory.sizes["frame"] != before + schedule.samples + 1:
                raise ValueError(f"{path}: {trajectory.sizes['frame']} frames are not those of {point.path}")
            yield Run(scene, trajectory["time"].values[kept], trajectory.isel(frame=kept), centred)


# The time correlations that a point's runs have accumulated, in reduced units.


def reduced_curves(point: Point, path: str, longest: float) -> Curves:
    """Return the curves of one replica, to the lag `longest` or to its last one.

    `longest` is in reduced time.

    Units are the particles' diameter, mass and temperature. The temperature 2 E' / (d (N - 1)) is computed
    for each replica, where E' is the energy relative to the centre of mass. One species. Raises SceneError
    for a point without `lags`.
    """
    if "lags" not in point.settings:
        raise SceneError(f"experiments.{point.experiment}.lags", None, "is required")
    gas = plain_gas(point.scene)
    with open_trajectory(path) as trajectory:
        curves = average_correlations(trajectory)
    thermal_speed = math.sqrt(curves.correlation[0] * gas.count / (gas.count - 1))
    interval = curves.time[1] * thermal_speed / gas.diameter
    lags = min(len(curves.time), math.ceil(longest / interval) + 1)
    return Curves(
        interval * np.arange(lags),
        curves.msd[:lags] / gas.diameter**2,
        curves.correlation[:lags] / thermal_speed**2,
        curves.running[:lags] / (gas.diameter * thermal_speed),
    )
