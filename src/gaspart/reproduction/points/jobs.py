"""The kinds of jobs, each a module of `reproduction.jobs`.

A job runs again when its module, or its arguments in plain values, change.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

from gaspart.reproduction.jobs import (
    compare,
    count_instructions,
    echo,
    fill,
    measure_cost,
    pack,
    simulate,
)

if TYPE_CHECKING:
    from gaspart.engines import Engine
    from gaspart.keys import Kind
    from gaspart.reproduction.points.point import Point


class Job(Protocol):
    """Declarations of a job for planning, in addition to the function that does its work."""

    RESULT: str
    """Result of the job, in words."""
    KEYS: dict[str, Kind]
    """Keys that have a meaning for the job, in addition to the scene, the engine and the length."""

    def engines(self, point: Point) -> list[Engine]:
        """Return the engines whose kernels it compiles, if particles are not only placed."""

    def arguments(self, point: Point) -> dict:
        """Return the arguments of its function; raise SceneError."""


JOBS: Mapping[str, Job] = {
    "simulate": simulate,
    "measure_cost": measure_cost,
    "compare": compare,
    "echo": echo,
    "fill": fill,
    "pack": pack,
    "count_instructions": count_instructions,
}


def validate(point: Point) -> None:
    """Make the arguments of a point's job, which may have no keys of other jobs.

    Raises SceneError.
    """
    others = {key for job in JOBS.values() for key in job.KEYS} - JOBS[point.job].KEYS.keys()
    for key in others & point.settings.keys():
        if point.settings[key]:
            names = [name for name, job in JOBS.items() if key in job.KEYS]
            raise point.make_error(key, f"has a meaning with job: {' or '.join(names)} only")
    _ = point.arguments
