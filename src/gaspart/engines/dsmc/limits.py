"""What the DSMC engine can model."""

from __future__ import annotations

import numpy as np

from gaspart.engines.step.limits import oversized_particles
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.state.state import State

MOST_PARTICLES = 2**32 - 1
_EVENT = 'needs the "event" engine; this one has none'
_EITHER = 'needs the "event" or the "step" engine; this one has none'


def check_scene(scene: Scene, state: State) -> None:
    """Raise SceneError for what this engine does not model."""
    law, fixed = scene.restitution, bool(np.isinf(state.masses).any())
    faces = {name: face for name, face in scene.faces.items() if face.kind != "thermal"}
    moving = {name: face for name, face in faces.items() if face.kind in ("vibrating", "piston")}
    for key, value, rule in (
        ("walls", scene.walls or None, _EVENT),
        *((f"faces.{name}", face.kind, _EVENT) for name, face in moving.items()),
        *((f"faces.{name}", face.kind, _EITHER) for name, face in faces.items() if name not in moving),
        ("fixed", True if fixed else None, _EITHER),
        ("restitution.contact_duration", law.contact_duration or None if law else None, _EVENT),
        ("radius", scene.largest_radius if oversized_particles(state).any() else None, _OVERSIZED),
    ):
        if value is not None:
            raise SceneError(key, value, rule)
    if state.count > MOST_PARTICLES:
        raise SceneError("count", state.count, f"the DSMC engine takes {MOST_PARTICLES} particles at most")


_OVERSIZED = (
    'needs the "event" or the "step" engine: a few particles that are much larger than the others have no '
    "partners to be drawn from"
)
