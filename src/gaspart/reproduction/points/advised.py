"""The engine that `engine: auto` of a config stands for."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gaspart.errors import SceneError
from gaspart.reproduction.points import point_keys

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene


def chosen(settings: dict, scene: Scene, where: str) -> dict:
    """The settings of a point with `engine: auto`, with those of the engine that it stands for.

    The choice is that of the table's machine, so that a config means the same everywhere. A length is set
    only if none is given. Raises SceneError.
    """
    from gaspart.accuracy.plan import tabulated
    from gaspart.accuracy.table import EQUILIBRATION

    if "accuracy" not in settings:
        raise SceneError(f"{where}.accuracy", None, "is required with engine: auto")
    observable, accuracy = settings.get("observable", "Z"), settings["accuracy"]
    try:
        advice = tabulated(scene, observable, accuracy)
    except SceneError as error:
        raise error.inside(where) from None
    made = {key: value for key, value in settings.items() if key not in point_keys.ENGINE_KEYS["auto"]}
    engine = advice.best.engine
    made |= {"engine": engine.name, **engine.advised_settings()}
    if not point_keys.LENGTHS.keys() & settings.keys():
        made["collisions_per_particle"] = math.ceil(advice.collisions_per_particle)
        made.setdefault("replicas", advice.replicas)
        made.setdefault("equilibration", EQUILIBRATION)
    return made
