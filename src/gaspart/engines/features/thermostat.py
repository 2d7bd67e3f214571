"""The kicks of a thermostat, at regular times that do not depend on where a run is split."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gaspart.engines.features.part import Part
from gaspart.kernels.physics import running_sum
from gaspart.scene.scene import Scene
from gaspart.scene.thermostat import Thermostat
from gaspart.state.random import key_of

if TYPE_CHECKING:
    from gaspart.kernels.model import Model, Particles, Tally

_MOST_NUMBERS = 2**63 - 1  # of kicks, before they begin anew
_KICK_DRAWS = 3  # the purpose of their random numbers, after those of thermal walls


def _width(thermostat: Thermostat, dimension: int, unit_mass: float) -> float:
    """The standard deviation of a kick's velocity components, for the unit of mass."""
    return math.sqrt(2.0 * thermostat.power * thermostat.interval / (dimension * unit_mass))


class Kicks(Part):
    """The thermostat of a scene under the event-driven engine: the time of the next kick on the clocks of the
    epoch, the number of kicks, and the energy given since the tally began."""

    def __init__(
        self, thermostat: Thermostat, dimension: int, seed: int | tuple[int, ...], unit_mass: float
    ) -> None:
        self._interval, self._unit_mass = thermostat.interval, unit_mass
        self._width = _width(thermostat, dimension, unit_mass)
        self._key = key_of(seed, _KICK_DRAWS)
        self._next = np.array([thermostat.interval])
        self._number = np.zeros(1, dtype=np.int64)
        self._given = np.zeros((1, 2))
        arrays = {"next": self._next, "number": self._number, "given": self._given}
        super().__init__({f"scheduled_{key}": array for key, array in arrays.items()}, scheduled=self._next)

    @property
    def given(self) -> float:
        """The energy that kicks have given since the tally began."""
        return running_sum.net(self._given) * self._unit_mass

    def end_epoch(self, length: float, start: float) -> None:
        """The next kick is at a multiple of the interval, rounded once: a sum of intervals would drift away
        from it. The subtraction is exact."""
        self._next[0] = (int(self._number[0]) + 1) * self._interval - start

    def reset(self, clock: float) -> None:
        """Begin to sum energies up from zero."""
        self._given[:] = 0.0

    def apply_event(self, particles: Particles, model: Model, tally: Tally, start: float) -> bool:
        """Kick all particles. Returns that their flights have changed."""
        from gaspart.kernels.event.kicks import kick_all

        counter = self._key, int(self._number[0])
        kick_all(particles.flights, self.next, self._width, counter, model, self._given)
        self._number += 1
        self.end_epoch(0.0, start)
        return True


def kicks(scene: Scene, seed: int | tuple[int, ...], unit_mass: float) -> Kicks | None:
    """The kicks of a scene's thermostat, if it has one and particles that can move."""
    if scene.thermostat is None or not any(not kind.fixed for kind in scene.kinds):
        return None
    return Kicks(scene.thermostat, scene.dimension, seed, unit_mass)


class StepKicks(Part):
    """The thermostat of a scene in steps. A step in which several kicks are due ends with one as strong as
    all.

    given_terms (1, 2): the energy given since the tally began, see `running_sum.add`.
    """

    def __init__(
        self, thermostat: Thermostat, dimension: int, time_step: float, seed: int | tuple[int, ...]
    ) -> None:
        self._per_step = time_step / thermostat.interval
        self._width = _width(thermostat, dimension, 1.0)
        self._key = key_of(seed, _KICK_DRAWS)
        self.given_terms = np.zeros((1, 2))
        super().__init__({"given": self.given_terms})

    def reset(self, clock: float) -> None:
        """Begin to sum energies up from zero."""
        self.given_terms[:] = 0.0

    def _kicks_by(self, steps: float) -> int:
        """How many kicks are due by the end of so many steps."""
        return math.floor(steps * self._per_step * (1.0 + 4e-16) + 1e-9)

    def until(self, steps: float, part: float) -> int:
        """The number of the next parts of a step, of such a length, of which the last ends with a kick."""
        due = self._kicks_by(steps)
        number = max(1, math.floor(((due + 1) / self._per_step - steps) / part) - 1)
        while self._kicks_by(steps + number * part) <= due:
            number += 1
        return number

    def due(self, steps: float, part: float) -> tuple[float, tuple[np.ndarray, int]] | None:
        """The width of the kick that all particles get after so many steps, the last `part` of which has just
        been made, and the counter of its random numbers; None if none is due."""
        due = self._kicks_by(steps)
        number = due - self._kicks_by(steps - part)
        if number <= 0:
            return None
        return self._width * math.sqrt(number), (self._key, due & _MOST_NUMBERS)


def step_kicks(scene: Scene, time_step: float, seed: int | tuple[int, ...]) -> StepKicks | None:
    """The kicks of a scene's thermostat in steps, if it has one."""
    if scene.thermostat is None or not scene.count:
        return None
    return StepKicks(scene.thermostat, scene.dimension, time_step, seed)
