"""Flow of a gas between sheared faces (`faces.LeesEdwards`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaspart.errors import SceneError
from gaspart.scene.faces import FLOW, GRADIENT, LeesEdwards

if TYPE_CHECKING:
    import numpy as np

    from gaspart.scene.scene import Scene


def flow(scene: Scene, positions: np.ndarray) -> np.ndarray:
    """Return the velocity (..., d) of the flow at positions; 0 without shear."""
    return flow_of_rate(scene.shear_rate, scene.container.lengths[GRADIENT], positions)


def flow_of_rate(rate: float | None, height: float, positions: np.ndarray) -> np.ndarray:
    """Return the velocity (..., d) of a uniform shear flow at positions.

    Without a `rate`, the velocity is 0.

    height : side of the container along the gradient.
    """
    import numpy as np  # planning a workflow needs the rest of this module, but not this import

    velocities = np.zeros_like(positions, dtype=float)
    if rate is not None:
        velocities[..., FLOW] = rate * (positions[..., GRADIENT] - 0.5 * height)
    return velocities


def refuse_sheared(scene: Scene, rule: str) -> None:
    """Raise SceneError, with `rule` in its message, for a scene with sheared faces."""
    for name, face in scene.faces.items():
        if isinstance(face, LeesEdwards):
            raise SceneError(f"faces.{name}", face.kind, rule)
