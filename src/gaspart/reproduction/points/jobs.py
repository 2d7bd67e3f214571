"""Kinds of jobs. A kind is a module of `reproduction.jobs`.

A job runs again when its module changes, or its arguments as plain values.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

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
    from gaspart.reproduction.points.point import Job, Point


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
    """Make the arguments of a point's job, to validate them. Keys of other jobs are not allowed. Raises
    SceneError.
    """
    others = {key for job in JOBS.values() for key in job.KEYS} - JOBS[point.job].KEYS.keys()
    for key in others & point.settings.keys():
        if point.settings[key]:
            names = [name for name, job in JOBS.items() if key in job.KEYS]
            raise point.make_error(key, f"has a meaning with job: {' or '.join(names)} only")
    _ = point.arguments
