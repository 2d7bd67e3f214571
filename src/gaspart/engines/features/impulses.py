"""The momentum that particles carry through planes across an axis, from the impulses that they receive."""

from __future__ import annotations

from typing import Any

import numpy as np

from gaspart.engines.features.part import TallyPart
from gaspart.kernels.event import impulses as kernels
from gaspart.kernels.model import Model
from gaspart.kernels.physics.flight import advance_all
from gaspart.scene.impulses import row_count
from gaspart.scene.scene import Scene
from gaspart.state.optional_tallies import ImpulseTally, OptionalTally
from gaspart.state.state import State


def rows_of(scene: Scene) -> np.ndarray:
    """(N,) the row of each particle: the number of its species; single particles have the number after the
    last, and are the first particles."""
    counts = [len(scene.particles), *(kind.count for kind in scene.species)]
    return np.repeat([len(scene.species), *range(len(scene.species))], counts)


class ImpulsesPart(TallyPart):
    """What is tallied of them: the momentum below each plane at the last reset and all impulses since then,
    of which that below at present is taken off when it is read.

    flights (N,): the particles, each at its own clock.
    """

    kernel: kernels.Impulses

    def __init__(
        self, flights: np.ndarray, model: Model, unit_mass: float, scene: Scene, axis: int, bins: int
    ) -> None:
        self._flights, self._unit_mass = flights, unit_mass
        self._model = model._replace(faces=None, walls=None, oversized=None)
        rows, per_length = row_count(scene), bins / scene.container.lengths[axis]
        sums = np.zeros((rows, bins + 1))
        row = rows_of(scene) if rows > 1 else None
        super().__init__("impulses", kernels.Impulses(sums, axis, per_length, row), {"impulses": sums})

    def _add_momenta(self, clock: float, sign: float, sums: np.ndarray) -> None:
        """Add `sign` times the momenta of all particles at this time on the clocks of the epoch."""
        flights, model = self._flights.copy(), self._model
        advance_all(flights, clock, model.space, model.gravity)
        kernels.add_momenta(flights, sign, model, self.kernel._replace(sums=sums))

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        self.kernel.sums[...] = 0.0
        self._add_momenta(clock, 1.0, self.kernel.sums)

    def read(self, clock: float) -> np.ndarray:
        """(species, bins) the momentum that has flown until this time on the clocks of the epoch."""
        sums = self.kernel.sums.copy()
        self._add_momenta(clock, -1.0, sums)
        return np.asarray(self._unit_mass * np.cumsum(sums, axis=1)[:, :-1])

    def counts(self, clock: float) -> dict[str, Any]:
        """The same, by the field of `Tally`."""
        return {"momentum_flux_sum": self.read(clock)}


def impulses_part(
    asked: OptionalTally, flights: np.ndarray, model: Model, unit_mass: float, scene: Scene, state: State
) -> ImpulsesPart:
    """The part of an `ImpulseTally`."""
    assert isinstance(asked, ImpulseTally)
    return ImpulsesPart(flights, model, unit_mass, scene, "xyz".index(asked.axis), asked.bins)
