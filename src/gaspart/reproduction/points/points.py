"""Points of the grids of a config.

An *experiment* of the config has ``point`` (defaults) and ``grid``. The grid maps each key to the list of its
values. The points are all combinations of these values. The grid may also be a list of such mappings, whose
points are concatenated. A key with the value null counts as absent, so that a config merged over another
config can remove a key.

Measurements do not import this module, so that they do not depend on the trade-off's table.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from gaspart.errors import SceneError
from gaspart.keys import TEXT, Kind, choice, count, describe, flag, list_of, nullable, positive, record
from gaspart.reproduction.jobs.data import DIVIDED
from gaspart.reproduction.points import point_keys
from gaspart.reproduction.points.jobs import JOBS
from gaspart.reproduction.points.point import Point, name_of
from gaspart.reproduction.points.point_keys import (
    ENGINE,
    ENGINE_KEYS,
    EXTENTS,
    GAS,
    LENGTHS,
    SCENE_FILE,
)

# Settings of a point for the effort of a config. An uncertainty falls as the inverse root of the effort.


_LEAST_REPLICAS = 6
"""Minimum number of replicas whose scatter measures the uncertainty."""
_LEAST_SAMPLES = 32
"""Minimum number of samples of a run, because blocks are made from them."""
_LEAST_TIMINGS = 3
_OF_SEEDS = ("echo", "fill", "pack")
"""Jobs whose work is the same for each replica, for any length."""


def scale_length(
    job: str, settings: Mapping[str, Any], multiple: float, least: int = _LEAST_SAMPLES
) -> dict[str, Any]:
    """Return the settings with `multiple` times as many replicas, and then longer runs. The intervals between
    samples are kept, so that a run of less effort is the beginning of one of more. It has at least `least`
    samples, and twice as many as lags, unless there are fewer at effort 1. The length of two kinds of runs is
    not changed: those without equilibration, which describe a process in time, and those with displacements
    but no lags, whose figures follow paths to their end.
    """
    result = dict(settings)
    replicas = result.get("replicas", 1)
    if replicas > 1 and job in ("simulate", *_OF_SEEDS):
        result["replicas"] = max(math.ceil(replicas * multiple - 1e-9), min(replicas, _LEAST_REPLICAS))
        multiple *= replicas / result["replicas"]
    in_time = not result.get("equilibration") or (result.get("displacements") and "lags" not in result)
    if job in _OF_SEEDS or (job == "simulate" and in_time) or "until" in result:
        return result
    samples = result.get("samples", 1)
    each = samples // result["frames"] if "frames" in result else 1  # samples per frame
    least = max(least, 2 * result.get("lags", 0)) if job == "simulate" else _LEAST_TIMINGS
    frames = math.ceil(samples / each * multiple - 1e-9)
    frames = max(frames, min(samples // each, math.ceil(least / each)))
    changes: dict[str, Any] = {"frames": frames} if "frames" in result else {}
    if job == "simulate":
        return result | changes | {"samples": frames * each, DIVIDED: samples}
    if "samples" in result:
        changes["samples"] = frames * each
    for unit in LENGTHS.keys() & result.keys():
        changes[unit] = result[unit] * (frames * each / samples)
    if "steps" in changes:
        changes["steps"] = max(1, round(changes["steps"]))
    return result | changes


def _least_samples(config: Mapping[str, Any], experiment: str) -> int:
    """Return the least number of samples of a run: those of its figures' blocks."""
    blocks = [
        figure.get(key, 0)
        for figure in (config.get("figures") or {}).values()
        if experiment in figure.get("experiments", ())
        for key in ("blocks", "layer_blocks")
    ]
    return max(_LEAST_SAMPLES, *blocks, 0)


# Keys of a config, of an experiment and of its points, with kind, default and meaning. Validation, the JSON
# schema and the reference page are derived from these tables. The settings of a figure are declared in the
# `FIGURES` of its module.


_WORD = r"[a-z][a-z0-9_]*$(?!\n)"  # $ also matches before a final line break
_NAME = {"pattern": rf"^{_WORD}", "maxLength": 100}

_TAKEN = (
    *("animations", "benchmarks", "claims", "coverage", "docs", "figures", "kernels", "logs"),
    *("measurements", "points", "tables"),
)
"""Folders of `results`, which cannot be names of a run."""


def _of_any_engine() -> dict[str, Kind]:
    """Return the keys of all engines. If a key has different meanings for engines, the description lists
    them.
    """
    merged: dict[str, Kind] = {}
    for engine, keys in ENGINE_KEYS.items():
        for name, kind in keys.items():
            meaning = kind["description"]
            text = merged.setdefault(name, kind.stating(default=None))["description"]
            if meaning not in text:
                merged[name] = describe(merged[name], f"{text}; {engine}: {meaning}")
    return merged


def _of_any_job() -> dict[str, Kind]:
    """Return the keys of all jobs, with their meaning for every job."""
    kinds: dict[str, Kind] = {}
    meanings: dict[str, dict[str, list[str]]] = {}  # for each key: meaning, and jobs
    for job, module in JOBS.items():
        for name, kind in module.KEYS.items():
            kinds.setdefault(name, kind)
            meanings.setdefault(name, {}).setdefault(kind["description"], []).append(f"`{job}`")
    return {name: describe(kind, _in_words(meanings[name])) for name, kind in kinds.items()}


def _in_words(meanings: Mapping[str, list[str]]) -> str:
    return "; ".join(f"{', '.join(jobs)}: {meaning}" for meaning, jobs in meanings.items())


RUN: dict[str, Kind] = {
    **_of_any_job(),
    "replicas": count("independent runs within the point's job", maximum=10_000, default=1),
}

POINT: dict[str, Kind] = {
    name: kind if name == "dimension" else nullable(kind)
    for name, kind in (EXTENTS | GAS | SCENE_FILE | ENGINE | _of_any_engine() | LENGTHS | RUN).items()
}
"""All keys of a point; null removes a key."""

WHOLE = frozenset(
    name
    for name, kind in POINT.items()
    if kind.get("type") == ["integer", "null"] or all(isinstance(item, int) for item in kind.get("enum", "-"))
)
"""Keys whose values are integers, which may be written as 1e3."""

_BLOCK = {"type": "object"}  # each value is checked by the kind of its key
_JOBS = "; ".join(f"`{name}`: {module.RESULT}" for name, module in JOBS.items())
EXPERIMENT: dict[str, Kind] = {
    "job": choice(_JOBS, *JOBS, default="simulate"),
    "point": record(POINT, "the settings that all points share", patternProperties={r"^scene[.]": {}}),
    "grid": describe(
        {"anyOf": [_BLOCK, list_of(_BLOCK)]},
        "the settings that vary: a mapping from a key to the list of its values, of which the product is "
        "taken, or a list of such mappings, one after the other; a single value counts as a list of one",
        default=None,
    ),
    "effort": positive(
        "the effort of this experiment, instead of that of the config", maximum=100, default=None
    ),
    "least_effort": positive(
        "below it runs would be short beside the memory of what they measure, and their uncertainties too "
        "small: such an experiment has this effort at least",
        maximum=1,
        default=None,
    ),
}

ANIMATION: dict[str, Kind] = {
    "experiment": describe(TEXT, "the experiment whose first point's first replica is filmed"),
    "size": list_of(
        {"type": "integer", "minimum": 16}, "width and height in pixels", 2, 2, default=[1000, 750]
    ),
    "colour": choice("what the colour of a particle shows", "speed", "species", default="speed"),
    "frames_per_second": positive("pictures per second", default=25.0),
    "trail": count("number of a disc whose path is drawn", 0, default=None),
    "clock": flag(
        "write parameters, the meaning of the colours, time and scale above and below the pictures",
        default=False,
    ),
    "figure": describe(TEXT, "the figure beside which the report shows the film", default=None),
}


def config(figures: dict[str, Kind], own: Kind) -> dict[str, Kind]:
    """Return the top level of a config from the entries of its figures by name. Figures with other names have
    the entry `own`.
    """
    named = {"type": "object", "propertyNames": _NAME}
    return {
        "title": describe({**TEXT, "minLength": 1}, "stands in the report and in each figure's data"),
        "seed": count(
            "with the names of experiment, point and replica it gives every random stream", minimum=0
        ),
        "points": describe(
            {**TEXT, "pattern": r"^results(/[A-Za-z0-9_.-]*[A-Za-z0-9_-])+$(?!\n)", "maxLength": 200},
            "the folder of the simulations, which several runs may share",
        ),
        "run": nullable(
            describe(
                {**TEXT, "pattern": rf"^(?!({'|'.join(_TAKEN)})$){_WORD}", "maxLength": 100},
                "a name: figures, claims, tables, logs and report are then in `results/<run>`, instead of "
                "`results`, where they replace those of no other run",
                default=None,
            )
        ),
        "families": describe(
            {"anyOf": [{"const": "all"}, {"type": "array", "items": _NAME}]},
            "files of the folder `figures` beside the config, over which it is merged: names without .yaml, "
            "or `all`; each has `experiments`, `figures`, `animations` and blocks of `sizes`",
            default=[],
        ),
        "sizes": describe(
            {**TEXT, **_NAME},
            "the block in the files of the families that is merged over the rest",
            default="",
        ),
        "experiments": describe(
            {**named, "minProperties": 1, "additionalProperties": record(EXPERIMENT)}, "what is simulated"
        ),
        "effort": positive(
            "multiple of the replicas of every point, or else of the length of its runs; uncertainties fall "
            "as the inverse root of the effort",
            maximum=100,
            default=1.0,
        ),
        "figures": describe(
            {**named, "properties": figures, "additionalProperties": own},
            "what is drawn, and the settings of its measurement; a figure with another name has a `kind`",
        ),
        "animations": describe(
            {**named, "additionalProperties": record(ANIMATION)},
            "films",
            default={},
        ),
        "opening": describe(
            {**TEXT, **_NAME},
            "the scene of `gaspart new`, of two dimensions, that runs on the first screen of the report",
            default="",
        ),
    }


def effort_of(config: Mapping[str, Any], experiment: str) -> float:
    """Return the effort of an experiment; inf if the config does not state it as a number."""
    experiments = config.get("experiments")
    block = experiments.get(experiment) if isinstance(experiments, dict) else None
    if not isinstance(block, dict):
        return math.inf
    efforts = block.get("effort", config.get("effort", 1.0)), block.get("least_effort") or 0.0
    return max(efforts) if all(isinstance(effort, int | float) for effort in efforts) else math.inf


MOST_POINTS = 100_000
"""Maximum number of points of a config. Planning takes half a millisecond a point."""


def points(config: dict, experiment: str) -> list[Point]:
    """Return all points of an experiment. Raises SceneError for an empty grid, or for two points of equal
    name.
    """
    block = config["experiments"][experiment]
    where = f"experiments.{experiment}"
    _check_size(config, experiment)
    effort = effort_of(config, experiment)
    by_name: dict[str, Point] = {}
    varied = block.get("grid")
    for varying in _combinations({} if varied is None else varied, f"{where}.grid"):
        combined = {**block.get("point", {}), **varying}
        name, job = name_of(varying, f"{where}.grid"), block.get("job", "simulate")
        settings = {key: _plain(key, value) for key, value in combined.items() if value is not None}
        if effort != 1.0:
            settings = scale_length(job, settings, effort, _least_samples(config, experiment))
        point = _chosen(
            Point(
                experiment=experiment,
                name=name,
                job=job,
                settings=settings,
                root=config.get("points", "results/points"),
                config_seed=config["seed"],
            )
        )
        if point.name in by_name:
            raise SceneError(f"{where}.grid", point.name, "every point of a grid must be different")
        by_name[point.name] = point
    return list(by_name.values())


def _plain(key: str, value: Any) -> Any:
    is_integer = key in WHOLE and isinstance(value, float) and value.is_integer()
    return int(value) if is_integer else value


def _chosen(point: Point) -> Point:
    """Return a point with the engine that `engine: auto` selects."""
    where = f"experiments.{point.experiment}"
    if point.settings.get("engine") == "auto":
        from gaspart.reproduction.points.engine import chosen

        return replace(point, settings=chosen(point.settings, point.scene, where))
    for key in point_keys.ENGINE_KEYS["auto"]:
        if key in point.settings:
            raise SceneError(f"{where}.{key}", point.settings[key], "needs engine: auto")
    return point


def all_points(config: dict) -> dict[str, dict[str, Point]]:
    """Return the points of all experiments, by experiment and name. Raises SceneError as in `points`."""
    return {
        experiment: {point.name: point for point in points(config, experiment)}
        for experiment in config["experiments"]
    }


def figure_points(config: dict, figure: str, planned: Mapping[str, Mapping[str, Point]]) -> list[Point]:
    """Return the points of all experiments that a figure lists, in the figure's order. `planned` is a result
    of `all_points`. Raises SceneError for an unknown experiment.
    """
    chosen: list[Point] = []
    for experiment in config["figures"][figure]["experiments"]:
        if experiment not in planned:
            raise SceneError(f"figures.{figure}.experiments", experiment, "must be the name of an experiment")
        chosen += planned[experiment].values()
    return chosen


def _check_size(config: dict, experiment: str) -> None:
    """Raise SceneError if the grids of an experiment and of those before it have too many points."""
    total = 0
    for name, block in config["experiments"].items():
        grid = block.get("grid") if isinstance(block, dict) else None
        for axes in grid if isinstance(grid, list) else [grid]:
            values = axes.values() if isinstance(axes, dict) else ()
            total += math.prod(len(each) if isinstance(each, list) else 1 for each in values)
        if total > MOST_POINTS:
            rule = f"are the points up to this grid: a config may have {MOST_POINTS}"
            raise SceneError(f"experiments.{name}.grid", total, rule)
        if name == experiment:
            return


def _combinations(grid: Any, where: str) -> list[dict]:
    """Return all combinations of the values in a mapping of lists. For several mappings, their combinations
    are concatenated.
    """
    if isinstance(grid, list):
        if not grid:
            raise SceneError(where, grid, "must not be empty")
        return [combination for block in grid for combination in _combinations(block, where)]
    axes = {key: values if isinstance(values, list) else [values] for key, values in grid.items()}
    for key, values in axes.items():
        if not values:
            raise SceneError(f"{where}.{key}", values, "must not be empty")
    return [dict(zip(axes, chosen, strict=True)) for chosen in itertools.product(*axes.values())]
