"""gaspart: hard-sphere and hard-disc gases, simulated, measured, and compared with theory.

The names below are loaded when first used, so that planning a workflow starts no compiler.
"""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False
if TYPE_CHECKING:  # it takes longer to import than all else here
    from typing import Any

__version__ = "0.1.0"

_HOMES = {
    "Body": "matter",
    "Container": "scene",
    "EventDriven": "engines",
    "Plate": "matter",
    "Restitution": "matter",
    "Scene": "scene",
    "SceneError": "errors",
    "Simulation": "simulation",
    "SimulationError": "errors",
    "Species": "matter",
    "State": "state",
    "Sticky": "surfaces",
    "Tally": "tally",
    "Thermal": "surfaces",
    "TimeStepped": "engines",
    "Wall": "matter",
    "Well": "surfaces",
    "collision_data": "collisions",
    "compress": "compression",
    "contact_value": "collisions",
    "engine_from_dict": "engines",
    "engine_to_dict": "engines",
    "export": "exports",
    "film": "rendering.films",
    "open_trajectory": "trajectory",
    "render": "rendering.pictures",
    "resume": "trajectory",
    "run": "trajectory",
}

__all__ = ["__version__", *_HOMES]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f"gaspart.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'gaspart' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
