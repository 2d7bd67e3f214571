"""The name of the compiled kernels that a point needs, and a tiny run that compiles them."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any

from gaspart.engines import engine_from_dict, engine_to_dict
from gaspart.errors import SimulationError
from gaspart.reproduction.points.point import Point
from gaspart.scene.driving import driven_axes, has_dragged_faces
from gaspart.scene.species import LATTICES

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene

_FEW = 8  # particles and walls that a tiny run has of each kind
_MATTER = {
    "species.Species",
    "particles.Particle",
    "restitution.Restitution",
}  # whose properties are features
# in every kernel, or in none
_NO_FEATURE = ("container", "count", "radius", "speed", "temperature", "centres_to_walls", "region")
_NO_FEATURE += ("exact_temperature", "polydispersity", "radius_distribution")
_NO_FEATURE += ("components", "waveform")  # of faces: numbers to the kernels, as the boundary is
# All that makes kernels have a law of contacts, as an entry of `Model`.
_LAW = {"restitution.normal", "restitution.tangential", "species.moment_of_inertia"}


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
    present = sorted(features(scene))
    if point.settings.get("stress"):
        present.append("stress")
    if point.settings.get("pairs"):
        present.append("events")
    if present:
        parts.append(hashlib.sha256(" ".join(present).encode()).hexdigest()[:8])
    return "-".join(parts)


def features(scene: Scene) -> set[str]:
    """Dotted names of all that differs from its default in a scene and changes its kernels, with its value
    where that is a word."""
    names = set(_differing(scene)) - _MATTER
    if len({kind.mass for kind in scene.kinds}) <= 1:
        names -= {"species.mass", "particles.mass"}  # equal masses are left out of the kernels
    if names & _LAW:
        names = (names - _LAW) | {"restitution"}
    names.discard("restitution.contact_duration")
    if scene.contact_duration > 0.0:  # by default under gravity
        names.add("contact_duration")
    if driven_axes(scene) and has_dragged_faces(scene):
        names.add("dragged")
    if scene.vibrates:  # by a temperature too
        names.add("vibrates")
    if scene.largest_radius > scene.smallest_radius:
        from gaspart.state.oversized import largest_in_boxes

        if largest_in_boxes(scene) < scene.largest_radius:
            names.add("oversized")
    return names


def _differing(thing: Any, prefix: str = "") -> Iterator[str]:
    for field in fields(thing):
        value, name = getattr(thing, field.name), f"{prefix}{field.name}"
        required = field.default is field.default_factory  # both MISSING: no default
        if field.name in _NO_FEATURE or value == field.default or value in LATTICES:
            continue
        if isinstance(value, dict):
            value = tuple(value.values())
        parts = value if isinstance(value, tuple) else (value,)
        for part in parts:
            if is_dataclass(part):
                yield f"{name}.{type(part).__name__}"
                yield from _differing(part, f"{name}.")
            elif isinstance(part, str):
                yield f"{name}={part}"
            elif not required and part:  # an acceleration of zero is none
                yield name


def task(point: Point) -> str:
    """The task of `warm` for a point, as JSON: its engine, its scene with only a few particles if these have
    all of its features, whether it tallies the stress, and whether it records events."""
    from gaspart.scene.scene import Scene

    parameters, full = point.parameters, point.scene
    scene = {key: value[:_FEW] if isinstance(value, list) else value for key, value in full.to_dict().items()}
    for kind in scene.get("species", ()):
        kind["count"] = min(kind["count"], _FEW)
        if kind["arrangement"] in LATTICES:  # which need fewer kernels
            kind["arrangement"] = "random"
    if features(Scene.from_dict(scene)) != features(full):
        scene = full.to_dict()
    engine = parameters.get("engine") or parameters.get("engines", [None])[0]
    if engine:
        engine = engine_to_dict(engine_from_dict(engine).for_small_scene(full))
    asked = {"stress": "stress", "events": "pairs"}  # of the task, by a key of the point
    extra = {name: True for name, key in asked.items() if point.settings.get(key)}
    return json.dumps({"scene": scene, "engine": engine, **extra})


def warm(job: str) -> None:
    """Compile and cache all kernels of a `task` by a tiny run."""
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
