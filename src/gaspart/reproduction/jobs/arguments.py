"""Arguments of a job's function as plain values, which determine if the job must run again.

A job receives only its arguments. Therefore its result cannot depend on other properties of a point, such as
its name, or on the modules that make scene, engine and schedule from its settings. This module loads engines.
It is separate from `data`, so that jobs without contacts do not depend on the physics of engines.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from gaspart.engines import engine_from_dict, engine_to_dict
from gaspart.scene.scene import Scene
from gaspart.trajectory.run_options import Until

_FORMS: dict[str, tuple[Callable[[Any], Any], Callable[[Any], Any]]] = {
    "scene": (Scene.to_dict, Scene.from_dict),
    "engine": (engine_to_dict, engine_from_dict),
    "engines": (
        lambda engines: [engine_to_dict(engine) for engine in engines],
        lambda values: [engine_from_dict(value) for value in values],
    ),
    "seed": (list, tuple),
    "seeds": (
        lambda seeds: [list(seed) for seed in seeds],
        lambda values: [tuple(value) for value in values],
    ),
    "until": (asdict, Until.from_dict),
    "rival": (lambda rival: to_plain(rival), lambda values: from_plain(values)),
}
"""Conversions to plain values and back, by the name of an argument; other arguments are plain already."""


def to_plain(arguments: dict[str, Any]) -> dict[str, Any]:
    """Convert scenes, engines, tuples and endings to numbers, text, lists and mappings."""
    return _convert(arguments, 0)


def from_plain(values: dict[str, Any]) -> dict[str, Any]:
    """Convert the result of `to_plain` back. Raises SceneError for a scene or an engine of another
    version.
    """
    return _convert(values, 1)


def _convert(arguments: dict[str, Any], direction: int) -> dict[str, Any]:
    return {
        name: _FORMS[name][direction](value) if name in _FORMS and value is not None else value
        for name, value in arguments.items()
    }
