"""The kicks of a thermostat, at the ends of steps."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gaspart.scene.scene import Scene
from gaspart.state.random import key_of

if TYPE_CHECKING:
    from gaspart.kernels.dsmc.model import Particles, Tools

_KICK_DRAWS = 3  # the purpose of their random numbers, as in `engines.features.thermostat`


class StepKicks:
    """The thermostat of a scene. A step in which several kicks are due ends with one as strong as all.

    given (1, 2): the energy given since the tally began, see `running_sum.add`.
    """

    def __init__(self, scene: Scene, time_step: float, seed: int | tuple[int, ...]) -> None:
        thermostat = scene.thermostat
        assert thermostat is not None
        self._per_step = time_step / thermostat.interval
        self._width = math.sqrt(2.0 * thermostat.power * thermostat.interval / scene.dimension)
        self._key = key_of(seed, _KICK_DRAWS)
        self.given = np.zeros((1, 2))

    def _due(self, steps: int) -> int:
        """How many kicks are due by the end of so many steps."""
        return math.floor(steps * self._per_step * (1.0 + 4e-16) + 1e-9)

    def next_step(self, steps: int) -> int:
        """The first of the steps after so many that ends with a kick."""
        due = self._due(steps)
        found = max(steps + 1, math.floor((due + 1) / self._per_step) - 1)
        while self._due(found) <= due:
            found += 1
        return found

    def happen(self, particles: Particles, tools: Tools, steps: int) -> None:
        """Kick all particles if that is due after so many steps."""
        from gaspart.kernels.dsmc.kicks import kick_all

        due = self._due(steps)
        number = due - self._due(steps - 1)
        if number > 0:
            kick_all(particles, tools, self._width * math.sqrt(number), (self._key, due), self.given)


def kicks(scene: Scene, time_step: float, seed: int | tuple[int, ...]) -> StepKicks | None:
    """Those of a scene's thermostat, if it has one."""
    return None if scene.thermostat is None or not scene.count else StepKicks(scene, time_step, seed)
