"""The piston of a scene, as the kernels know it."""

from __future__ import annotations

import numpy as np

from gaspart.kernels import model
from gaspart.scene.faces import pistons
from gaspart.scene.scene import Scene
from gaspart.state.state import State

_OF_EPOCH = 2.0**-24  # a particle at rest on which the piston lies meets it again after this part of an epoch


def piston_of(scene: Scene, state: State, unit_mass: float) -> model.Piston | None:
    """The piston of a state, in units of `unit_mass`; None if there is none."""
    found = pistons(scene)
    if not found or state.piston is None:
        return None
    n, face = found[0]
    x, velocity = state.piston
    inwards = (scene.container.lengths[n // 2] - x, -velocity) if n % 2 else (x, velocity)
    push = face.acceleration(scene, n // 2)
    return model.Piston(n, face.mass / unit_mass, push, np.array([*inwards, 0.0]), np.zeros(1))


def begin_epoch(piston: model.Piston, length: float) -> None:
    """Let the present epoch of the clocks have this length."""
    piston.slowest[0] = 0.5 * piston.push * _OF_EPOCH * length


def set_clock(piston: model.Piston, clock: float) -> None:
    """Let the piston's present motion be that of this time on the clocks of the epoch."""
    piston.motion[model.PISTON_CLOCK] = clock


def next_epoch(piston: model.Piston, last: float) -> None:
    """Move the piston to the end of an epoch of a length `last`, and let that be time 0 of its clock."""
    from gaspart.kernels.obstacles.piston import advance_piston

    advance_piston(piston.motion, piston.push, last)
    set_clock(piston, 0.0)


def motion_at(piston: model.Piston, time: float, lengths: tuple[float, ...]) -> np.ndarray:
    """(2,) where the piston is along its axis, and its velocity, at a time on the clocks of the epoch."""
    from gaspart.kernels.obstacles.piston import advance_piston

    motion = piston.motion.copy()
    advance_piston(motion, piston.push, time)
    place, velocity = motion[model.PISTON_PLACE], motion[model.PISTON_VELOCITY]
    upper = piston.face % 2 == 1
    return np.array([lengths[piston.face // 2] - place, -velocity] if upper else [place, velocity])
