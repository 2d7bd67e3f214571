"""Features of a scene, and their names.

A scene without features has smooth, elastic particles in a hard or periodic container. `FEATURES` is the
table of all features. `EXCLUDED` is the table of pairs of features that exclude each other. Each engine has a
list of the features that it models (`Engine.models`). The scenes that an engine rejects, and the table of
features in the documentation, follow from this list.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from gaspart.errors import SceneError
from gaspart.scene.composition import Composition
from gaspart.scene.faces import FACE_KINDS
from gaspart.scene.surfaces import FACES


class Feature(NamedTuple):
    """Feature of a scene. The function value(scene) returns None if the scene does not have the feature. A
    feature that is a kind of face has a `kind`.
    """

    meaning: str
    key: str
    value: Callable[[Composition], Any]
    kind: str | None = None

    def refuse(self, scene: Composition, rule: str) -> SceneError:
        """Return an error about a scene with this feature. The error names the key and the face."""
        faces = (name for name, face in scene.faces.items() if face.kind == self.kind)
        key = f"faces.{next(faces)}" if self.kind else self.key
        return SceneError(key, self.value(scene), rule)


def _face(kind: str) -> Feature:
    """Return the feature that represents a kind of face."""

    def value(scene: Composition) -> str | None:
        return kind if any(face.kind == kind for face in scene.faces.values()) else None

    return Feature(f"{kind} faces of the container", "faces", value, kind)


def _law(key: str, meaning: str, value: Callable[[Any], Any]) -> Feature:
    """Return the feature for a property of the collision law."""

    def of_scene(scene: Composition) -> Any:
        return value(scene.restitution) if scene.restitution is not None else None

    return Feature(meaning, f"restitution.{key}", of_scene)


FEATURES: dict[str, Feature] = {
    "gravity": Feature("gravity", "gravity", lambda scene: scene.gravity),
    "restitution": _law("normal", "inelastic contacts", lambda law: law.normal if law.normal < 1.0 else None),
    "roughness": _law(
        "tangential", "rough particles, with spins", lambda law: law.tangential if law.rough else None
    ),
    "viscoelasticity": _law(
        "reference_speed",
        "restitution that depends on the speed of a contact",
        lambda law: law.reference_speed,
    ),
    "contact_duration": _law(
        "contact_duration", "contacts that last", lambda law: law.contact_duration or None
    ),
    "thermostat": Feature("random kicks", "thermostat", lambda scene: scene.thermostat),
    "walls": Feature("interior walls", "walls", lambda scene: scene.walls or None),
    "thermal_walls": Feature(
        "interior walls at a temperature",
        "walls.temperature",
        lambda scene: next((wall.temperature for wall in scene.walls if wall.temperature), None),
    ),
    "moving_wall": Feature(
        "an interior wall that moves",
        "walls.mass",
        lambda scene: next((wall.mass for wall in scene.walls if wall.mass), None),
    ),
    "fixed": Feature(
        "fixed particles",
        "fixed",
        lambda scene: scene.has_fixed or None,
    ),
    "polydispersity": Feature(
        "radii that differ within a species",
        "species.polydispersity",
        lambda scene: next((kind.polydispersity for kind in scene.species if not kind.alike), None),
    ),
    "centres_to_walls": Feature(
        "walls that stop the centres of particles",
        "centres_to_walls",
        lambda scene: scene.centres_to_walls or None,
    ),
    **{kind: _face(kind) for kind in FACE_KINDS},
    "sliding": Feature(
        "thermal faces that move along themselves",
        "faces",
        lambda scene: [FACES[n] for n, _ in scene.sliding_faces] or None,
    ),
    "accommodation": Feature(
        "thermal faces with partial accommodation",
        "faces",
        lambda scene: [FACES[n] for n, _ in scene.partial_faces] or None,
    ),
    "ramp": Feature(
        "thermal faces whose temperature varies along them",
        "faces",
        lambda scene: [FACES[n] for n, _ in scene.ramps] or None,
    ),
    "vibrations": Feature(
        "particles that store energy in a vibration",
        "vibrates",
        lambda scene: scene.vibrates or None,
    ),
}
"""Features by name, in the order in which scenes are rejected."""

_CLOSED = {
    "the particles of a reservoir are smooth and elastic": (
        "restitution", "roughness", "viscoelasticity", "contact_duration", "vibrations",
    ),
    "nothing acts on the gas of a reservoir": ("gravity", "thermostat"),
    "a reservoir has particles of one size, which move": ("polydispersity", "fixed"),
    "an interior wall that moves needs a closed container": ("moving_wall",),
    "beside open faces, the others are hard or thermal": (
        "well", "sticky", "vibrating", "piston", "lees_edwards",
    ),
    "beside open faces, a thermal one is at rest": ("sliding",),
}  # fmt: skip
"""Features that exclude open faces, with the reason."""

EXCLUDED: dict[tuple[str, str], str] = {
    ("gravity", "piston"): "the energy of a piston is known only without gravity",
    ("restitution", "piston"): "a piston needs elastic particles",
    ("roughness", "piston"): "a piston needs smooth particles",
    ("thermostat", "piston"): "a piston needs a gas that nothing else drives",
    ("walls", "piston"): "a piston sweeps through the container",
    ("fixed", "piston"): "a piston sweeps through the container",
    ("vibrating", "piston"): "one face may move by itself, and no other then",
    ("gravity", "moving_wall"): "its energy is known only without gravity",
    ("restitution", "moving_wall"): "it needs elastic particles",
    ("roughness", "moving_wall"): "it needs smooth particles",
    ("thermostat", "moving_wall"): "it needs gases that nothing else drives",
    ("fixed", "moving_wall"): "it sweeps through the container",
    ("sticky", "moving_wall"): "it sweeps through the container",
    ("vibrating", "moving_wall"): "one wall may move by itself, and no other then",
    ("gravity", "thermostat"): "kicks are defined without gravity",
    ("well", "thermostat"): "kicks need faces that are hard or thermal",
    ("sticky", "thermostat"): "kicks need faces that are hard or thermal",
    ("vibrating", "thermostat"): "kicks need faces that are hard or thermal",
    ("thermostat", "lees_edwards"): "kicks need faces that are hard or thermal",
    ("walls", "lees_edwards"): "the images of walls would slide",
    ("fixed", "lees_edwards"): "the images of fixed particles would slide",
    ("restitution", "vibrations"): "energy would be lost twice",
    ("centres_to_walls", "roughness"): "rough particles touch walls with their surfaces",
    **{(name, "open"): reason for reason, names in _CLOSED.items() for name in names},
}
"""Pairs of features that exclude each other, with the reason."""


def row_count(scene: Composition) -> int:
    """Return the number of rows of impulses. There is a row for each species, and one for all single
    particles.
    """
    return len(scene.species) + bool(scene.particles)
