"""From a config to the points of its grids.

An *experiment* of the config holds ``point`` (defaults) and ``grid`` (a mapping from a key to the list of
its values, whose product is taken, or a list of such mappings, which are concatenated). A key that is null
counts as absent, so that a config merged over another can remove a key.

Measurements do not import this module, so that none depends on the trade-off's table.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from gaspart.errors import SceneError
from gaspart.reproduction.points import config_keys, point_keys
from gaspart.reproduction.points.lengths import scaled
from gaspart.reproduction.points.point import Point, name_of

MOST_POINTS = 100_000


def points(config: dict, experiment: str) -> list[Point]:
    """All points of an experiment. Raises SceneError for an empty grid, or two points of one name."""
    block = config["experiments"][experiment]
    where = f"experiments.{experiment}"
    multiples = (config.get("lengths") or {}).get(experiment) or {}
    made: dict[str, Point] = {}
    varied = block.get("grid")
    for varying in _combinations({} if varied is None else varied, f"{where}.grid"):
        given = {**block.get("point", {}), **varying}
        name, job = name_of(varying, f"{where}.grid"), block.get("job", "simulate")
        settings = {key: _plain(key, value) for key, value in given.items() if value is not None}
        if name in multiples:
            settings = scaled(job, settings, multiples[name])
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
        if point.name in made:
            raise SceneError(f"{where}.grid", point.name, "every point of a grid must be different")
        made[point.name] = point
    return list(made.values())


def _plain(key: str, value: Any) -> Any:
    whole = key in config_keys.WHOLE and isinstance(value, float) and value.is_integer()
    return int(value) if whole else value


def _chosen(point: Point) -> Point:
    """With the engine that `engine: auto` stands for. Raises SceneError."""
    where = f"experiments.{point.experiment}"
    if point.settings.get("engine") == "auto":
        from gaspart.reproduction.points.advised import chosen

        return replace(point, settings=chosen(point.settings, point.scene, where))
    for key in point_keys.ENGINE_KEYS["auto"]:
        if key in point.settings:
            raise SceneError(f"{where}.{key}", point.settings[key], "needs engine: auto")
    return point


def all_points(config: dict) -> dict[str, dict[str, Point]]:
    """The points of all experiments, by experiment and name. Raises SceneError as `points` does."""
    return {
        experiment: {point.name: point for point in points(config, experiment)}
        for experiment in config["experiments"]
    }


def figure_points(config: dict, figure: str, planned: Mapping[str, Mapping[str, Point]]) -> list[Point]:
    """The points of all experiments that a figure names, in its order. planned: as from `all_points`.

    Raises SceneError for an unknown experiment.
    """
    chosen: list[Point] = []
    for experiment in config["figures"][figure]["experiments"]:
        if experiment not in planned:
            raise SceneError(f"figures.{figure}.experiments", experiment, "must be the name of an experiment")
        chosen += planned[experiment].values()
    return chosen


def _combinations(grid: Any, where: str) -> list[dict]:
    """The product of a mapping's lists; of a list of mappings, one after the other."""
    if isinstance(grid, list):
        if not grid:
            raise SceneError(where, grid, "must not be empty")
        return [combination for block in grid for combination in _combinations(block, where)]
    axes = {key: values if isinstance(values, list) else [values] for key, values in grid.items()}
    for key, values in axes.items():
        if not values:
            raise SceneError(f"{where}.{key}", values, "must not be empty")
    count = math.prod(map(len, axes.values()))
    if count > MOST_POINTS:
        raise SceneError(where, count, f"a grid may have {MOST_POINTS} points")
    return [dict(zip(axes, chosen, strict=True)) for chosen in itertools.product(*axes.values())]
