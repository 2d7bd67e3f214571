"""The measured part of the replicas of a point."""

from __future__ import annotations

from collections.abc import Iterator

from gaspart.analysis.run import Run
from gaspart.reproduction.points.point import Point
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
