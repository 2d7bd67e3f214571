"""Engines that advance a state, with one interface: see `engine`."""

from __future__ import annotations

from gaspart.engines.engine import (
    ENGINES,
    Dynamics,
    Engine,
    engine_from_dict,
    engine_to_dict,
    register,
)
from gaspart.engines.event.event_driven import EventDriven
from gaspart.engines.step.time_stepped import TimeStepped

# isort: split
from gaspart.engines.dsmc.dsmc import DSMC

__all__ = [
    "DSMC",
    "ENGINES",
    "Dynamics",
    "Engine",
    "EventDriven",
    "TimeStepped",
    "engine_from_dict",
    "engine_to_dict",
    "register",
]
