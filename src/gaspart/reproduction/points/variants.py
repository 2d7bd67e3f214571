"""The name of the compiled kernels that a point needs, and a tiny run that compiles them."""

from __future__ import annotations

import hashlib
import json
from contextlib import suppress
from typing import TYPE_CHECKING

from gaspart.engines import engine_from_dict, engine_to_dict
from gaspart.errors import SimulationError
from gaspart.reproduction.points.point import Point
from gaspart.scene.species import LATTICES

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene

_FEW = 8  # particles and walls that a tiny run has of each kind
_LAW = {"restitution", "roughness"}  # which the kernels have in one law of contacts
_NUMBERS = {"centres_to_walls", "polydispersity"}  # which change no kernel


def variant(point: Point) -> str:
    """The kernels of a point: engine, search or precision, dimension, and a digest of the features of its
    scene.

    Kernels are compiled for features, not for numbers. Raises SceneError.
    """
    scene = point.scene
    parts = ["fill", "random", f"{scene.dimension}d"]
    if engines := point.kind_of_job.engines(point):
        engine = engines[0]  # which differ in numbers only
        parts = [engine.name, engine.variant(scene), f"{scene.dimension}d"]
    present = sorted(compiled_features(scene))
    if point.settings.get("stress"):
        present.append("stress")
    if point.settings.get("pairs"):
        present.append("events")
    if present:
        parts.append(hashlib.sha256(" ".join(present).encode()).hexdigest()[:8])
    return "-".join(parts)


def compiled_features(scene: Scene) -> set[str]:
    """The names of what changes the kernels of a scene: features, and what every engine models but compiles
    for scenes that have it."""
    names = scene.features - _NUMBERS - {"contact_duration"}
    if names & _LAW:
        names = (names - _LAW) | {"law"}
    extra = {
        "contact_duration": scene.contact_duration > 0.0,  # by default under gravity
        "masses": len({kind.mass for kind in scene.kinds}) > 1,
        "dragged": scene.drags_faces,
        "compressed": any(kind.arrangement == "compressed" for kind in scene.species),
        "oversized": _has_oversized(scene),
    }
    return set(names) | {name for name, present in extra.items() if present}


def _has_oversized(scene: Scene) -> bool:
    """Whether a particle is too large for the boxes of the others."""
    if scene.largest_radius == scene.smallest_radius:
        return False
    from gaspart.state.oversized import largest_in_boxes

    return largest_in_boxes(scene) < scene.largest_radius


def compile_task(point: Point) -> str:
    """The task of `compile_kernels` for a point, as JSON: its engine, its scene, with only a few particles if
    these have all of its features, whether it tallies the stress, and whether it records events."""
    from gaspart.scene.scene import Scene

    full, engine = point.scene, None
    scene = {key: value[:_FEW] if isinstance(value, list) else value for key, value in full.to_dict().items()}
    for kind in scene.get("species", ()):
        kind["count"] = min(kind["count"], _FEW)
        if kind["arrangement"] in LATTICES:  # which need fewer kernels
            kind["arrangement"] = "random"
    if compiled_features(Scene.from_dict(scene)) != compiled_features(full):
        scene = full.to_dict()
    if engines := point.kind_of_job.engines(point):
        engine = engine_to_dict(engines[0].for_small_scene(full))
    asked = {"stress": "stress", "events": "pairs"}  # of the task, by a key of the point
    extra = {name: True for name, key in asked.items() if point.settings.get(key)}
    return json.dumps({"scene": scene, "engine": engine, **extra})


def compile_kernels(job: str) -> None:
    """Compile and cache all kernels of a `compile_task` by a tiny run."""
    from gaspart.scene.scene import Scene
    from gaspart.simulation import Simulation
    from gaspart.state.initial import initial_state

    given = json.loads(job)
    scene = Scene.from_dict(given["scene"])
    if given["engine"] is None:
        initial_state(scene, seed=1)
        return
    engine = engine_from_dict(given["engine"]).resolved(scene)
    simulation = Simulation(scene, engine, 1, given.get("stress", False))
    if given.get("events"):
        simulation.record_events = True
    step = engine.quantum
    limits: dict = {"duration": 4 * step} if step else {"duration": 1.0, "max_work": 1000}
    with suppress(SimulationError):  # a collapse; everything has been compiled before
        simulation.advance(**limits)
        simulation.restore(simulation.checkpoint())
        simulation.advance(**limits)
