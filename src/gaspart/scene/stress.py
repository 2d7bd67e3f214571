"""Scenes whose stress tensor and heat flux can be tallied: velocities change at contacts only."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaspart.errors import SceneError
from gaspart.scene.features import FEATURES

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene

_ALLOWED = frozenset(
    ("restitution", "roughness", "viscoelasticity", "contact_duration", "polydispersity", "lees_edwards")
)


def require_tallied(scene: Scene) -> None:
    """Raise SceneError if the stress tensor of a scene cannot be tallied by any engine."""
    if not scene.is_periodic:
        rule = "the stress, viscosity and conductivity need a periodic container; set boundary: periodic"
        raise SceneError("container.boundary", scene.container.boundary, rule)
    for name in sorted(scene.features - _ALLOWED):
        raise SceneError("stress", True, f"cannot be tallied in a scene with {FEATURES[name].meaning}")
