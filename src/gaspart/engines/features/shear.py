"""Periodic faces whose images slide (`scene.faces.LeesEdwards`)."""

from __future__ import annotations

import math

import numpy as np

from gaspart.engines.features.part import Part
from gaspart.kernels.model import Model, Shear
from gaspart.scene.faces import FLOW, GRADIENT
from gaspart.scene.scene import Scene
from gaspart.state.state import State


def shear_of(scene: Scene) -> Shear | None:
    """The shear of a scene, before the first epoch; None if there is none."""
    rate = scene.shear_rate
    if rate is None:
        return None
    velocity = rate * scene.container.lengths[GRADIENT]
    return Shear(rate, velocity, np.zeros(1), np.zeros(1, dtype=np.int64), np.zeros(3))


class ShearPart(Part):
    """How far the images are displaced: what follows from the time and the start, a state at time 0, so that
    no checkpoint has it. At each crossing a particle may gain their velocity."""

    def __init__(self, scene: Scene, state: State, shear: Shear) -> None:
        super().__init__({})
        self._shear, self._length = shear, scene.container.lengths[FLOW]
        self._start = state.displaced or 0.0
        self.gained = shear.velocity**2

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Let the displacement go on where the clocks are at zero. The remainder of a division is exact, so
        that it does not drift."""
        shear = self._shear
        period = self._length / abs(shear.velocity) if shear.velocity else math.inf
        phase = math.fmod(start, period)
        shear.origin[0] = self._start + shear.velocity * phase
        shear.turns[0] = round(math.copysign((start - phase) / period, shear.velocity))
        return model

    def write(self, state: State, clock: float) -> None:
        """Write how far images above are displaced. Particles that rounding shows beyond a sheared face,
        which they reach just now, are put at it: they have not crossed it yet."""
        shear = self._shear
        here = shear.origin[0] + shear.velocity * clock
        state.displaced = float(here + shear.turns[0] * self._length)
        inside = np.nextafter(state.lengths[GRADIENT], 0.0)
        state.positions[:, GRADIENT] = np.clip(state.positions[:, GRADIENT], 0.0, inside)
