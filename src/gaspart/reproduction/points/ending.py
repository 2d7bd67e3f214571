"""The end of the runs of a point with `until`.

It is made here, and not by the job, whose module must not depend on the analysis.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gaspart.reproduction.points.point import Point


def ending(point: Point) -> dict[str, Any]:
    """The fields of `Recipe` that follow from `until`. Raises SceneError for what no run can reach."""
    from gaspart.analysis.observables import OBSERVABLES
    from gaspart.runs.ending import Accuracy, default_sample_interval, require_end, require_measurable
    from gaspart.trajectory.until import Until

    settings, times = point.settings, point.schedule
    start = times.equilibration if "equilibration" in settings else None
    accuracies = tuple(Accuracy.named(name, value, start) for name, value in settings["until"].items())
    for asked in accuracies:
        require_measurable(asked, point.scene, point.engine)
        require_end(asked, point.scene, times.duration, given=False)
    interval = times.sample_interval
    if "samples" not in settings:
        interval = default_sample_interval(point.scene, point.engine, None)
    paths = any(OBSERVABLES[asked.observable].needs == "paths" for asked in accuracies)
    return {
        "duration": None,
        "sample_interval": interval,
        "until": Until(accuracies, times.duration),
        "displacements": paths or settings.get("displacements", False),
    }
