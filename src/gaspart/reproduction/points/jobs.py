"""The kinds of jobs: what each makes, what it requires of a point, and the parameters that it is given.

What a job does is the module of its name in `reproduction.jobs`. The workflow runs it again when that or its
parameters change.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from gaspart.engines import ENGINES, engine_to_dict
from gaspart.errors import SceneError
from gaspart.reproduction.points import grid
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.points.point_scene import check_scene, extents, scene

if TYPE_CHECKING:
    from gaspart.engines import Engine


@dataclass(frozen=True)
class Job:
    """A kind of job.

    check(point) refuses settings that contradict each other, with SceneError, without making a scene;
    parameters(point) are those of its work beside scene and seeds; engines(point), those whose kernels it
    compiles, are empty where particles are only placed.
    """

    check: Callable[[Point], None]
    parameters: Callable[[Point], dict]
    engines: Callable[[Point], list[Engine]]


def check(point: Point) -> None:
    """Refuse settings that contradict each other, with SceneError; the cheap part, without a scene."""
    check_scene(point)
    for key, job in (("record_events", "measure_cost"), ("without", "measure_cost")):
        if point.settings.get(key) and point.job != job:
            raise _error(point, key, f"has a meaning with job: {job} only")
    JOBS[point.job].check(point)


def recipe(point: Point) -> dict:
    """The parameters of the point's job, in plain values: all that its result depends on, and nothing
    else."""
    check(point)
    seeds = [list(point.seed(k)) for k in range(point.replicas)]
    return {"scene": scene(point).to_dict(), "seeds": seeds, **JOBS[point.job].parameters(point)}


def engines_of(point: Point) -> list[Engine]:
    """The engines whose kernels the point's job compiles."""
    return JOBS[point.job].engines(point)


def _error(point: Point, key: str, rule: str) -> SceneError:
    return SceneError(f"experiments.{point.experiment}.{key}", point.settings.get(key), rule)


def _nothing(point: Point) -> None:
    """A job of which only the scene matters."""


def _check_fill(point: Point) -> None:
    if "attempts" not in point.settings:
        raise _error(point, "attempts", "is required with job: fill")


def _check_pack(point: Point) -> None:
    if ("attempts" in point.settings) == (point.settings.get("arrangement") == "compressed"):
        raise _error(point, "attempts", "is required with job: pack, unless the arrangement is compressed")


def _check_compare(point: Point) -> None:
    grid.check_run(point)
    if point.settings.get("engine", "event") != "step":
        name = point.settings.get("engine", "event")
        raise SceneError(f"experiments.{point.experiment}.engine", name, "must be step with job: compare")


def _check_cost(point: Point) -> None:
    grid.check_run(point)
    records = ENGINES[point.settings.get("engine", "event")].records_events
    if point.settings.get("record_events") and not records:
        raise _error(point, "record_events", "has a meaning with job: measure_cost and engine: event only")


def _one_engine(point: Point) -> list[Engine]:
    return [grid.engine(point)]


def _simulation(point: Point) -> dict:
    times, follow, count = grid.schedule(point), point.settings.get("follow"), extents(point)[0]
    if follow is not None and follow > count:
        raise _error(point, "follow", f"there are {count} particles")
    correlations = None
    if "lags" in point.settings:
        lags = min(point.settings["lags"], (times.samples + 1) // 2)
        correlations = {"interval": times.sample_interval, "lags": lags, "start": times.equilibration}
    return {
        "engine": engine_to_dict(grid.engine(point)),
        "duration": times.duration,
        "sample_interval": times.duration if correlations else times.sample_interval,
        "displacements": point.settings.get("displacements", False),
        "follow": follow,
        "correlations": correlations,
    }


def _comparison(point: Point) -> dict:
    times = grid.schedule(point)
    return {
        "engines": [engine_to_dict(chosen) for chosen in grid.engines(point)],
        "equilibration": times.equilibration,
        "stretch": times.sample_interval,
        "repeats": times.samples,
    }


def _cost(point: Point) -> dict:
    recorded = {"record": point.settings.get("record_events", False), "rival": rival(point)}
    return {**recorded, **_comparison(point)}


def rival(point: Point) -> dict | None:
    """The scene and the engines that are timed in turn with a point's own, which lack its keys `without`;
    None if it has none."""
    if "without" not in point.settings:
        return None
    left = {key: value for key, value in point.settings.items() if key not in point.settings["without"]}
    beside = replace(point, settings=left)
    made = [engine_to_dict(chosen) for chosen in grid.engines(beside)]
    return {"scene": scene(beside).to_dict(), "engines": made}


def _echo(point: Point) -> dict:
    times = grid.schedule(point)
    return {
        "engine": engine_to_dict(grid.engine(point)),
        "equilibration": times.equilibration,
        "interval": times.sample_interval,
        "samples": times.samples,
    }


def _event_driven(_: Point) -> list[Engine]:
    return [ENGINES["event"]()]


JOBS = {
    "simulate": Job(grid.check_run, _simulation, _one_engine),
    "measure_cost": Job(_check_cost, _cost, grid.engines),
    "compare": Job(_check_compare, _comparison, grid.engines),
    "echo": Job(grid.check_run, _echo, _one_engine),
    "fill": Job(_check_fill, lambda point: {"attempts": point.settings["attempts"]}, lambda _: []),
    "pack": Job(_check_pack, lambda point: {"attempts": point.settings.get("attempts")}, lambda _: []),
    "count_instructions": Job(_nothing, lambda _: {}, _event_driven),
}
"""What each makes is stated in `keys.JOBS`, with the keys of a config."""
