"""The scenes that the DSMC engine can model."""

from __future__ import annotations

import numpy as np

from gaspart.engines.step.limits import oversized_particles
from gaspart.errors import SceneError, SimulationError
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


def check_made(counts: np.ndarray, time: float) -> None:
    """Raise SimulationError for steps that could not be finished; counts: see `kernels.dsmc.model`."""
    from gaspart.kernels.dsmc.model import FAR, UNFINISHED

    if counts[:, UNFINISHED].any():
        raise SimulationError(
            f"at time {time:g} a particle has met faces of the container more than 2^24 times in a step,"
            " which is not finished: give a shorter time_step"
        )
    if counts[:, FAR].any():
        raise SimulationError(
            f"at time {time:g} a particle has crossed the container 2^31 times along a periodic axis,"
            " more often than is counted"
        )
