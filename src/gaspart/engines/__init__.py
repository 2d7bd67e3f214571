"""Two engines that advance a state, with one interface.

An engine's settings are a frozen dataclass with a `name`; `start(scene, state)` gives its dynamics, which
can `advance`, has `time`, `state` and `tally`, and can write and `restore` a `checkpoint`.
"""

from __future__ import annotations

from dataclasses import asdict

from gaspart.engines.event.event_driven import EventDriven
from gaspart.engines.step.time_stepped import TimeStepped
from gaspart.errors import SceneError
from gaspart.scene.validation import choice, from_mapping

ENGINES: dict[str, type[EventDriven | TimeStepped]] = {
    engine.name: engine for engine in (EventDriven, TimeStepped)
}


def engine_from_dict(mapping: dict) -> EventDriven | TimeStepped:
    """The engine described by {"name": "event" | "step", setting: value, ...}. Raises SceneError."""
    if not isinstance(mapping, dict):
        raise SceneError("engine", mapping, "must be a mapping with a name")
    settings = dict(mapping)
    name = choice("engine.name", settings.pop("name", None), ENGINES)
    if isinstance(settings.get("boxes_per_side"), list):
        settings["boxes_per_side"] = tuple(settings["boxes_per_side"])
    return from_mapping(ENGINES[name], settings, "engine")


def engine_to_dict(engine: EventDriven | TimeStepped) -> dict:
    """The mapping that `engine_from_dict` accepts."""
    return {"name": engine.name, **{key: value for key, value in asdict(engine).items() if value is not None}}
