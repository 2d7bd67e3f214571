"""The kicks of a thermostat, at regular times that do not depend on where a run is split."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gaspart.scene.scene import Scene
from gaspart.scene.thermostat import Thermostat
from gaspart.state.random import key_of

if TYPE_CHECKING:
    from gaspart.kernels.model import Model, Particles, Tally

_KICK_DRAWS = 3  # the purpose of their random numbers, after those of thermal walls


class Kicks:
    """The thermostat of a scene.

    arrays: what belongs to a checkpoint: next (1,), the time of the next kick on the clocks of the epoch;
    number (1,), how many there have been; given (1, 2), the energy given since the tally began.
    """

    def __init__(
        self, thermostat: Thermostat, dimension: int, seed: int | tuple[int, ...], unit_mass: float
    ) -> None:
        self._interval = thermostat.interval
        self._width = math.sqrt(2.0 * thermostat.power * thermostat.interval / (dimension * unit_mass))
        self._key = key_of(seed, _KICK_DRAWS)
        self.arrays = {
            "next": np.array([thermostat.interval]),
            "number": np.zeros(1, dtype=np.int64),
            "given": np.zeros((1, 2)),
        }

    @property
    def next(self) -> float:
        """The time of the next kick, on the clocks of the epoch."""
        return float(self.arrays["next"][0])

    def begin_epoch(self, _: float, start: float) -> None:
        """Count from the `start` of an epoch."""
        self._set_next(start)

    def _set_next(self, start: float) -> None:
        """The next kick is at a multiple of the interval, rounded once: a sum of intervals would drift away
        from it. The subtraction is exact."""
        self.arrays["next"][0] = (int(self.arrays["number"][0]) + 1) * self._interval - start

    def reset(self) -> None:
        """Begin to sum energies up from zero."""
        self.arrays["given"][:] = 0.0

    @property
    def given(self) -> np.ndarray:
        """(1, 2) the energy given since the tally began, in the kernels' unit, see `running_sum.add`."""
        return self.arrays["given"]

    def happen(self, particles: Particles, model: Model, _: Tally, start: float) -> bool:
        """Kick all particles at the time `next` of an epoch with this `start`. Returns that their flights
        have changed."""
        from gaspart.kernels.event.kicks import kick_all

        counter = self._key, int(self.arrays["number"][0])
        kick_all(particles.flights, self.next, self._width, counter, model, self.arrays["given"])
        self.arrays["number"] += 1
        self._set_next(start)
        return True


def kicks(scene: Scene, seed: int | tuple[int, ...], unit_mass: float) -> Kicks | None:
    """Those of a scene's thermostat, if it has one and particles that can move."""
    if scene.thermostat is None or not any(not kind.fixed for kind in scene.kinds):
        return None
    return Kicks(scene.thermostat, scene.dimension, seed, unit_mass)
