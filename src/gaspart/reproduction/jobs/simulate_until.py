"""Trajectories that end when observables are accurate, one for each replica of a point.

The analysis decides when they end, so that they are simulated again when it changes. Planning reads this
module, so slow imports are made inside functions.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from gaspart.engines import engine_from_dict, engine_to_dict
from gaspart.kinds import Kind, count, described, flag, positive
from gaspart.reproduction.jobs.replicas import write_replicas
from gaspart.reproduction.jobs.stretches import EQUILIBRATION

if TYPE_CHECKING:
    from gaspart.engines import Engine
    from gaspart.reproduction.points.point import Point

RESULT = "trajectories that end when the observables of `until` are accurate"
KEYS: dict[str, Kind] = {
    "until": described(
        {
            "type": "object",
            "minProperties": 1,
            "additionalProperties": positive("", exclusiveMaximum=1),
        },
        "observables and the relative standard error that each is to reach, such as `{Z: 1e-3}` or "
        "`{'pressure:x low': 0.01}`; the length of the run is then the largest; required",
        default=None,
    ),
    "equilibration": described(
        EQUILIBRATION, "time before frames count, in the unit of the length", default=None
    ),
    "samples": count(
        "frames of the longest run; by default one for each collision of a particle", default=None
    ),
    "displacements": flag("keep displacements in float64, for mean-squared displacements", default=False),
}


def engines(point: Point) -> list[Engine]:
    """The engine of the trajectories."""
    return [point.engine]


def parameters(point: Point) -> dict:
    """The arguments of `gaspart.run`, in plain values. Raises SceneError."""
    from gaspart.runs import Accuracy, default_sample_interval, require_measurable

    settings, times = point.settings, point.schedule
    if not settings.get("until"):
        raise point.refused("until", "must be given with job: simulate_until")
    start = times.equilibration if "equilibration" in settings else None
    for name, accuracy in settings["until"].items():
        require_measurable(Accuracy.named(name, accuracy, start), point.scene, point.engine)
    interval = (
        times.sample_interval
        if "samples" in settings
        else default_sample_interval(point.scene, point.engine, None)
    )
    return {
        "engine": engine_to_dict(point.engine),
        "until": settings["until"],
        "start": start,
        "at_most": times.duration,
        "sample_interval": interval,
        "displacements": settings.get("displacements", False),
    }


def run(parameters: dict, folder: Path) -> None:
    """Write a trajectory for each seed; see `write_replicas`."""
    write_replicas(record, parameters, folder, print)


def record(parameters: dict, seed: tuple[int, ...], path: Path, overwrite: bool) -> None:
    """Make one trajectory, or continue it, or find it complete."""
    from gaspart.runs import Accuracy
    from gaspart.runs import run as run_until
    from gaspart.scene.scene import Scene

    until, start = parameters["until"], parameters["start"]
    run_until(
        Scene.from_dict(parameters["scene"]),
        engine_from_dict(parameters["engine"]),
        seed=seed,
        sample_interval=parameters["sample_interval"],
        path=path,
        until=[Accuracy.named(name, value, start) for name, value in until.items()],
        at_most=parameters["at_most"],
        displacements=parameters["displacements"],
        overwrite=overwrite,
    )
