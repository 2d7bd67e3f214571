"""gaspart: hard-sphere and hard-disc gases, simulated, measured, and compared with theory.

The names below are loaded when first used, so that planning a workflow starts no compiler.
"""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False
if TYPE_CHECKING:  # it takes longer to import than all else here
    from typing import Any

__version__ = "0.2.0"

_HOMES = {
    "Body": "scene.species",
    "Container": "scene.container",
    "Correlations": "trajectory.correlator",
    "DSMC": "engines",
    "EventDriven": "engines",
    "Plate": "scene.walls",
    "Restitution": "scene.restitution",
    "Scene": "scene.scene",
    "SceneError": "errors",
    "Simulation": "simulation",
    "SimulationError": "errors",
    "Species": "scene.species",
    "State": "state.state",
    "Tally": "state.tally",
    "Thermostat": "scene.thermostat",
    "TimeStepped": "engines",
    "Wall": "scene.walls",
    "collision_data": "analysis.collisions",
    "compress": "state.compression",
    "contact_value": "analysis.collisions",
    "engine_from_dict": "engines",
    "engine_to_dict": "engines",
    "export": "trajectory.export",
    "film": "rendering.films",
    "open_trajectory": "trajectory.run",
    "render": "rendering.frames",
    "resume": "trajectory.run",
    "run": "trajectory.run",
    "view": "rendering.view",
}

_PACKAGES = ("analysis", "theory")


def _homes() -> dict[str, str]:
    """The modules of all public names. A kind of face is public once it is declared."""
    faces = import_module("gaspart.scene.faces")
    return {**_HOMES, **{kind.__name__: "scene.faces" for kind in faces.KINDS.values()}}


def __getattr__(name: str) -> Any:
    if name in _PACKAGES:
        return import_module(f"gaspart.{name}")
    if name == "__all__":
        return ["__version__", *_PACKAGES, *_homes()]
    home = _HOMES.get(name)
    if home is None and name[0].isupper():  # no module: `scene.faces` imports some by this function
        home = _homes().get(name)
    if home is None:
        raise AttributeError(f"module 'gaspart' has no attribute {name!r}")
    return getattr(import_module(f"gaspart.{home}"), name)


def __dir__() -> list[str]:
    return sorted(__getattr__("__all__"))
