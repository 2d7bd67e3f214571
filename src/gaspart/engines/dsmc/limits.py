"""What the DSMC engine can model."""

from __future__ import annotations

from gaspart.engines.step.limits import oversized_particles
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.state.state import State

MOST_PARTICLES = 2**32 - 1
_OVERSIZED = (
    'needs the "event" or the "step" engine: a few particles that are much larger than the others have no '
    "partners to be drawn from"
)


def check_scene(scene: Scene, state: State) -> None:
    """Raise SceneError for particles, or so many of them, that this engine does not model."""
    if oversized_particles(state).any():
        raise SceneError("radius", scene.largest_radius, _OVERSIZED)
    if state.count > MOST_PARTICLES:
        raise SceneError("count", state.count, f"the DSMC engine takes {MOST_PARTICLES} particles at most")
