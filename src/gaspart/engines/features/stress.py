"""The sums of the stress tensor and the heat flux of a scene under the event-driven engine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from gaspart.kernels.model import Model


class StressSums:
    """What is tallied from a reset on, by clocks that start again with each of their epochs.

    arrays: those that the kernels add to; flights (N,): the particles, each with a velocity that holds at any
    time until its next contact.
    """

    def __init__(self, flights: np.ndarray, model: Model, unit_mass: float) -> None:
        from gaspart.kernels.event import stress
        from gaspart.kernels.physics import running_sum

        self._kernels, self._sums, self._unit_mass = stress, running_sum, unit_mass
        self._flights, self._parts = flights, (model.space, model.masses, model.law)
        d = len(model.space.lengths)
        self.arrays = stress.Stress(np.zeros((d * d + d, 2)), np.zeros((2, d + 1)))

    def begin(self, clock: float) -> None:
        """Begin to count from zero."""
        self.arrays.sums[...] = 0.0
        self._add(-clock, self.arrays)

    def next_epoch(self, epoch: float) -> None:
        """Set the clocks, which show `epoch`, to zero."""
        self._add(epoch, self.arrays)

    def read(self, clock: float) -> dict[str, Any]:
        """The fields of a `Tally`."""
        total = self.arrays._replace(sums=self.arrays.sums.copy())
        self._add(clock, total)
        d = len(self._parts[0].lengths)
        values = self._sums.values(total.sums) * self._unit_mass
        return {"stress_sum": values[: d * d].reshape(d, d), "heat_sum": values[d * d :]}

    def _add(self, time: float, arrays: object) -> None:
        self._kernels.add_flights(self._flights, time, *self._parts, arrays)
