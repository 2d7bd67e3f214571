"""The flow of a gas between sheared faces (`faces.LeesEdwards`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaspart.scene.faces import FLOW, GRADIENT

if TYPE_CHECKING:
    from gaspart.scene.scene import Scene


def flow(scene: Scene, positions: np.ndarray) -> np.ndarray:
    """(..., d) the velocity of the flow at positions (..., d); 0 without sheared faces."""
    velocities = np.zeros_like(positions, dtype=float)
    if scene.shear_rate is not None:
        middle = 0.5 * scene.container.lengths[GRADIENT]
        velocities[..., FLOW] = scene.shear_rate * (positions[..., GRADIENT] - middle)
    return velocities
