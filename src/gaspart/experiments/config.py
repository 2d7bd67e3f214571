"""Is this config one that can be run? Refused before any job starts, in one line: file, key, value, rule."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from gaspart.errors import SceneError
from gaspart.experiments.registry import families
from gaspart.files import read_yaml
from gaspart.planning import grid
from gaspart.planning.point_scene import PREFIX
from gaspart.planning.points import figure_points, points


def check(config: dict, schema_path: str, files: list[str]) -> None:
    """Validate a merged config against the schema, then every point's scene and engine.

    files: the YAML files that were merged, in that order; an error names the last one that holds the key.
    Raises SceneError.
    """
    try:
        _finite(config)
        schema = read_yaml(schema_path)
        _against(schema, config, schema, "")
        for experiment in config["experiments"]:
            _experiment(config, experiment, schema)
        for figure in config["figures"]:
            if figure not in families():
                raise SceneError(
                    f"figures.{figure}", figure, f"no such figure; known are {', '.join(sorted(families()))}"
                )
            figure_points(config, figure)
        for animation, block in config.get("animations", {}).items():
            _animation(config, animation, block)
    except SceneError as error:
        raise error.inside("", error.file or _file_of(error.key, files)) from None


def _animation(config: dict, animation: str, block: dict | None) -> None:
    """A film is of trajectories, which an experiment of the config makes."""
    experiment = block["experiment"] if block else None
    kinds = {name: made.get("job", "simulate") for name, made in config["experiments"].items()}
    if block and kinds.get(experiment) != "simulate":
        rule = "must be the name of an experiment that makes trajectories"
        raise SceneError(f"animations.{animation}.experiment", experiment, rule)


def _experiment(config: dict, experiment: str, schema: dict) -> None:
    """The values of the grid, one by one, then every point as the scene and the engine it makes."""
    rules = schema["$defs"]["point"]["properties"]
    where = f"experiments.{experiment}"
    for key, value in _grid_values(config["experiments"][experiment].get("grid")):
        if key.startswith(PREFIX):  # a value of a scene file, which the scene judges
            continue
        if key not in rules:
            raise SceneError(f"{where}.grid.{key}", value, f"unknown key; known are {', '.join(rules)}")
        _against(rules[key], value, schema, f"{where}.grid.{key}")
    for point in points(config, experiment):
        grid.check(point)
        try:
            grid.recipe(point)
        except SceneError as error:
            told = error.file or error.key.startswith(where)
            raise error if told else error.inside(f"{where}[{point.name}]") from None


def _against(rule: dict, value: object, schema: dict, where: str) -> None:
    """Raise SceneError for the most telling way in which ``value`` breaks ``rule``."""
    from jsonschema import Draft202012Validator
    from jsonschema.exceptions import best_match

    error = best_match(Draft202012Validator({**rule, "$defs": schema["$defs"]}).iter_errors(value))
    if error is None:
        return
    key = ".".join(part for part in (where, *(str(part) for part in error.absolute_path)) if part)
    if error.validator == "additionalProperties":
        known = error.schema.get("properties", {})
        unknown = next(name for name in error.instance if name not in known)
        rule_text = f"unknown key; known are {', '.join(known)}"
        raise SceneError(f"{key}.{unknown}".lstrip("."), error.instance[unknown], rule_text)
    if error.validator == "required":
        missing = next(name for name in error.validator_value if name not in error.instance)
        raise SceneError(f"{key}.{missing}".lstrip("."), None, "is required")
    raise SceneError(key or "config", error.instance, _rule(error.validator, error.validator_value))


def _rule(validator: str, wanted: Any) -> str:
    """A JSON schema's keyword in words."""
    if validator == "type":
        names = [wanted] if isinstance(wanted, str) else wanted
        return f"must be of type {' or '.join(names)}"
    words = {
        "exclusiveMinimum": "must be greater than",
        "minimum": "must be at least",
        "exclusiveMaximum": "must be less than",
        "maximum": "must be at most",
        "enum": "must be one of",
        "minItems": "must have this many items at least:",
        "maxItems": "must have this many items at most:",
        "minProperties": "must have this many entries at least:",
        "uniqueItems": "must not name anything twice",
        "pattern": "must match",
    }
    told = "" if validator == "uniqueItems" else f" {wanted}"
    return words.get(validator, f"breaks the schema's {validator}:") + told


def _grid_values(block: Any) -> Iterator[tuple[str, object]]:
    """Every (key, value) that a grid holds; an empty list is left to gaspart.planning to refuse."""
    if isinstance(block, list):
        for part in block:
            yield from _grid_values(part)
        return
    for key, values in (block or {}).items():
        for value in values if isinstance(values, list) else [values]:
            yield key, value


def _finite(value: object, where: str = "") -> None:
    """JSON schema lets a NaN pass every comparison, so it is refused here."""
    if isinstance(value, dict):
        for key, item in value.items():
            _finite(item, f"{where}.{key}".lstrip("."))
    elif isinstance(value, list):
        for item in value:
            _finite(item, where)
    elif isinstance(value, float) and not math.isfinite(value):
        raise SceneError(where, value, "must be a finite number")


def _file_of(key: str, files: list[str]) -> str | None:
    """The last of the files that holds the longest part of ``key``."""
    parts = key.replace("[", ".").split(".")
    dotted = parts.index("scene") if "scene" in parts else len(parts)  # `scene.` and what follows is one key
    parts[dotted:] = [".".join(parts[dotted:])]

    def depth(path: str) -> int:
        block, reached = read_yaml(path), 0
        for part in parts:
            if not isinstance(block, dict) or part not in block:
                break
            block, reached = block[part], reached + 1
        return reached

    return max(reversed(files), key=depth) if files else None
