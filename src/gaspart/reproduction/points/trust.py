"""Comparison of the file of a point with the point: a name alone says nothing about the content."""

from __future__ import annotations

from importlib import import_module

from gaspart.errors import SceneError
from gaspart.reproduction.jobs.data import digest_of, made_by
from gaspart.reproduction.points.point import TRAJECTORIES, Point


def require_own(point: Point) -> None:
    """Raise SceneError if a file of a point was made with other arguments than the point has."""
    if point.job == TRAJECTORIES:
        # by name, as in `Point.kind_of_job`: measurements do not depend on what makes trajectories
        recipes = point.kind_of_job.recipes(**point.arguments)  # type: ignore[attr-defined]
        read = import_module("gaspart.trajectory.recipe").read_recipe
        other = [path for path, one in zip(point.replica_paths, recipes, strict=True) if read(path) != one]
    else:
        other = [point.path] if made_by(point.path) != digest_of(point.parameters) else []
    if other:
        name = f"{point.experiment}/{point.name}"
        rule = f"was not made by the point {name} of this config: delete {point.path}"
        raise SceneError("points", other[0], rule)
