"""Engines that advance a state, with a common interface (module `engine`)."""

from __future__ import annotations

from gaspart.engines.engine import (
    ENGINES,
    Engine,
    engine_from_dict,
    engine_to_dict,
    reference_engine,
    register,
    resolve_engine,
)
from gaspart.engines.event.settings import EventDriven
from gaspart.engines.step.engine import TimeStepped

from gaspart.engines.dsmc.engine import DSMC  # isort: skip

__all__ = [
    "DSMC",
    "ENGINES",
    "Engine",
    "EventDriven",
    "TimeStepped",
    "engine_from_dict",
    "engine_to_dict",
    "reference_engine",
    "register",
    "resolve_engine",
]
