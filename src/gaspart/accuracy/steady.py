"""Energy of a scene: its sources and sinks, and the existence of a steady state."""

from __future__ import annotations

from gaspart.errors import SceneError
from gaspart.scene.faces import LeesEdwards, Vibrating
from gaspart.scene.scene import Scene


def require_steady(scene: Scene) -> None:
    """Raise SceneError for an empty scene, and for a scene that cools or heats.

    The observables of the latter depend on the time.
    """
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
    """Return True if something exchanges energy with the particles.

    It is a thermostat, or a face that is at a temperature or moves.
    """
    moves = any(face.moves for face in scene.faces.values())
    return scene.thermostat is not None or moves or at_temperature(scene)


def at_temperature(scene: Scene) -> bool:
    """Return True if a face or an interior wall draws velocities at a temperature."""
    return bool(scene.face_temperatures)


def keeps_energy(scene: Scene) -> bool:
    """Return True if a run keeps its initial energy, or its enthalpy under a loaded piston."""
    loaded = [piston for _, piston in scene.pistons if piston.pressure is not None]
    moved = any(face.moves for face in scene.faces.values() if face not in loaded)
    exchanged = moved or at_temperature(scene) or scene.thermostat is not None or scene.is_open
    return not exchanged and not scene.dissipates
