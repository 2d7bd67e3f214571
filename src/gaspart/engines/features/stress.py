"""The sums of the stress tensor and the heat flux of a scene under the event-driven engine."""

from __future__ import annotations

from typing import Any

import numpy as np

from gaspart.engines.features.part import TallyPart
from gaspart.kernels.event.sheared_stress import add_sheared_flights
from gaspart.kernels.event.stress import Stress, add_flights
from gaspart.kernels.model import Model
from gaspart.kernels.physics.running_sum import values
from gaspart.scene.faces import FLOW, GRADIENT
from gaspart.scene.scene import Scene
from gaspart.state.drift import drift_of
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State
from gaspart.state.tally import tallied_fluxes


class StressPart(TallyPart):
    """The stress tensor and the heat flux of a gas without walls.

    flights (N,): the particles, each with a velocity that holds at any time until its next contact; drift
    (d,): the velocity of their centre of mass.
    """

    kernel: Stress

    def __init__(self, flights: np.ndarray, model: Model, unit_mass: float, drift: np.ndarray) -> None:
        self._flights, self._unit_mass = flights, unit_mass
        self._masses = model.space, model.masses, model.law
        self._drift, d = drift, len(drift)
        sums = np.zeros((2 * d * d + d, 2))
        super().__init__("stress", Stress(sums, np.zeros((2, d + 1)), drift.copy()), {"stress": sums})

    def end_epoch(self, length: float, start: float) -> None:
        """Add what the particles have carried in the epoch."""
        add_flights(self._flights, length, *self._masses, self.kernel)

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        self.kernel.sums[...] = 0.0
        add_flights(self._flights, -clock, *self._masses, self.kernel)

    def read(self, clock: float) -> np.ndarray:
        """(2 d^2 + d,) the sums until this time on the clocks of the epoch."""
        total = self.kernel._replace(sums=self.kernel.sums.copy())
        add_flights(self._flights, clock, *self._masses, total)
        return values(total.sums) * self._unit_mass

    def counts(self, clock: float) -> dict[str, Any]:
        """The sums, by the fields of `Tally`."""
        return tallied_fluxes(self.read(clock), self._drift)


class ShearedStressPart(StressPart):
    """The stress tensor and the heat flux of a sheared gas. Velocities relative to the flow change in flight,
    so that each flight counts from its clock on."""

    def __init__(self, flights: np.ndarray, model: Model, unit_mass: float, drift: np.ndarray) -> None:
        super().__init__(flights, model, unit_mass, drift)
        self._model = model

    def begin_epoch(self, length: float, start: float, model: Model) -> Model:
        """Set how fast the centre of mass moves about the flow: across it at one speed, and so along it less
        and less."""
        assert model.shear is not None  # or there were no such part
        across = self._drift[GRADIENT]
        self.kernel.drift[FLOW] = self._drift[FLOW] - model.shear.rate * across * start
        return model

    def close_epoch(self, length: float) -> None:
        """Add what the particles have carried until the end of the epoch."""
        add_sheared_flights(self._flights, length, 1.0, self._model, self.kernel)

    def end_epoch(self, length: float, start: float) -> None:
        """Nothing: the flights begin anew."""

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        self.kernel.sums[...] = 0.0
        add_sheared_flights(self._flights, clock, -1.0, self._model, self.kernel)

    def read(self, clock: float) -> np.ndarray:
        """(2 d^2 + d,) the sums until this time on the clocks of the epoch."""
        total = self.kernel._replace(sums=self.kernel.sums.copy())
        add_sheared_flights(self._flights, clock, 1.0, self._model, total)
        return values(total.sums) * self._unit_mass


def stress_part(
    asked: OptionalTally, flights: np.ndarray, model: Model, unit_mass: float, scene: Scene, state: State
) -> StressPart:
    """The part for a gas that is sheared or not, which is in this `state` at time 0."""
    kind = StressPart if model.shear is None else ShearedStressPart
    return kind(flights, model, unit_mass, drift_of(scene, state))
