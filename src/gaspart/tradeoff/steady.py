"""The energy of a scene: what gives and what takes it, and whether there is a steady state."""

from __future__ import annotations

import math

from gaspart.errors import SceneError
from gaspart.scene.faces import LeesEdwards, Vibrating
from gaspart.scene.scene import Scene


def require_steady(scene: Scene) -> None:
    """Raise SceneError for an empty scene, and for one that cools or heats: its observables depend on the
    time."""
    if not scene.count:
        raise SceneError("count", 0, "advice is for a gas: the scene is empty")
    law = scene.restitution
    loses = law is not None and law.dissipative
    if law is not None and loses and not is_driven(scene):
        rule = "loses energy that nothing returns: there is no steady state to measure; give a duration"
        raise SceneError("restitution.normal", law.normal, rule)
    moved = any(isinstance(face, Vibrating | LeesEdwards) for face in scene.faces.values())
    if (moved or scene.thermostat is not None) and not loses and not at_temperature(scene):
        rule = "nothing takes the energy that the scene is given: there is no steady state; give a duration"
        raise SceneError("restitution", None, rule)


def is_driven(scene: Scene) -> bool:
    """Whether a thermostat, or a face that is at a temperature or moves, exchanges energy with the
    particles."""
    moves = any(face.moves for face in scene.faces.values())
    return scene.thermostat is not None or moves or at_temperature(scene)


def at_temperature(scene: Scene) -> bool:
    """Whether a face gives particles the velocities of a temperature."""
    return any(getattr(face, "temperature", None) for face in scene.faces.values())


def temperature_scatter(scene: Scene) -> float:
    """Relative standard deviation, from run to run, of the temperature of a scene whose energy is conserved:
    velocities that are drawn have that of their species only on average."""
    drawn = any(kind.temperature is not None and not kind.exact_temperature for kind in scene.species)
    law = scene.restitution
    if not drawn or is_driven(scene) or (law is not None and law.dissipative):
        return 0.0
    return math.sqrt(2.0 / (scene.dimension * scene.count))
