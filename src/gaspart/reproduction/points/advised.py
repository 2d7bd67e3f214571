"""The engine that `engine: auto` of a config stands for."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gaspart.accuracy import speed
from gaspart.engines import DSMC, TimeStepped
from gaspart.errors import SceneError
from gaspart.reproduction.points import point_keys

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene


def chosen(settings: dict, scene: Scene, where: str) -> dict:
    """The settings of a point with `engine: auto`, with those of the engine that it stands for.

    The choice is that of the table's machine, so that a config means the same everywhere. A length is set
    only if none is given. Raises SceneError.
    """
    from gaspart.accuracy.advice import EQUILIBRATION, advise

    if "accuracy" not in settings:
        raise SceneError(f"{where}.accuracy", None, "is required with engine: auto")
    try:
        advice = advise(
            scene, settings.get("observable", "Z"), settings["accuracy"], speed_of=speed.as_measured
        )
    except SceneError as error:
        raise error.inside(where) from None
    engine = advice.setting.engine
    made = {key: value for key, value in settings.items() if key not in point_keys.ENGINE_KEYS["auto"]} | {
        "engine": engine.name
    }
    if isinstance(engine, TimeStepped):
        made |= {"time_step": engine.time_step, "precision": engine.precision}
    if isinstance(engine, DSMC):
        made |= {"model": engine.model}
    if not point_keys.LENGTHS.keys() & settings.keys():
        made["collisions_per_particle"] = math.ceil(advice.collisions_per_particle)
        made.setdefault("replicas", advice.replicas)
        made.setdefault("equilibration", EQUILIBRATION)
    return made
