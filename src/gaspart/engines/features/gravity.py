"""Gravity, and the particles that it holds on interior walls."""

from __future__ import annotations

import numpy as np

from gaspart.engines.features.part import Part
from gaspart.kernels.model import Gravity, Model, no_support
from gaspart.scene.scene import Scene
from gaspart.state.state import State

_SHORTEST_BOUNCE = 2.0**-44  # of an epoch: the longest bounce on a floor that is taken for rest
_LOWEST = 2.0**-44  # of the container: the highest bounce on an interior wall that is taken for rest


def gravity_of(scene: Scene, state: State) -> Gravity | None:
    """The kernels' gravity, before the first epoch of the clocks; None if there is none."""
    if scene.gravity is None:
        return None
    height = _LOWEST * max(scene.container.lengths)
    support = no_support(state.count, height) if scene.walls else None
    return Gravity(scene.gravity, np.isinf(state.masses), 0.0, support)


class GravityPart(Part):
    """Particles that fall, in a container with these `lengths`, and what they rest on at interior walls."""

    def __init__(self, gravity: Gravity, lengths: tuple[float, ...]) -> None:
        support = gravity.support._asdict() if gravity.support else {}
        super().__init__({f"support_{key}": array for key, array in support.items() if key != "height"})
        falls = (abs(g) * length for g, length in zip(gravity.acceleration, lengths, strict=True))
        self.gained = 2.0 * sum(falls)

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Bounces that an epoch's clocks do not resolve are rest."""
        assert model.gravity is not None  # or there were no such part
        return model._replace(gravity=model.gravity._replace(shortest_bounce=_SHORTEST_BOUNCE * length))
