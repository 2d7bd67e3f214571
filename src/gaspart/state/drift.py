"""Velocity of the centre of mass of a gas, about which its fluxes are."""

from __future__ import annotations

import numpy as np

from gaspart.scene.scene import Scene
from gaspart.scene.shear import flow
from gaspart.state.state import State

_ROUNDED = 2.0**-46  # of the rms speed: a mean velocity that is only rounding


def drift_of(scene: Scene, state: State) -> np.ndarray:
    """Return the velocity of the centre of mass of a state without fixed particles.

    Parameters
    ----------
    scene : Scene
        Scene of the state. In a sheared gas the velocity is about the flow.
    state : State
        State.

    Returns
    -------
    ndarray, shape (d,), [length/time]
        Velocity; 0 if it is only rounding.
    """
    velocities = state.velocities - flow(scene, state.positions)
    shares = (state.masses / state.masses.sum())[:, None] if state.count else np.zeros((0, 1))
    drift = (shares * velocities).sum(axis=0)
    return np.where(abs(drift) > _ROUNDED * np.sqrt((shares * velocities**2).sum()), drift, 0.0)
