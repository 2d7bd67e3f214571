"""Common to jobs that run a scene: keys, and the division of a run into intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaspart.keys import NOT_NEGATIVE, POSITIVE, described, listed

if TYPE_CHECKING:
    from gaspart.reproduction.points.point import Point

SLACK = 1e-6
"""Part of a time step by which a run is longer, so that rounding of its duration loses no step."""
EQUILIBRATION_KEY = described(
    NOT_NEGATIVE,
    "time before the length, in the same unit; rounded up to whole samples, which are not measured",
    default=0,
)
SCAN_TIME_STEPS = listed(
    POSITIVE,
    "time steps that one job runs in turn; the length of the run is in multiples of `time_step`",
    default=None,
)


def intervals(point: Point) -> dict:
    """The arguments of a job that divides its run after the equilibration into `samples` intervals."""
    times = point.schedule
    return {
        "equilibration": times.equilibration,
        "interval": times.sample_interval,
        "samples": times.samples,
    }
