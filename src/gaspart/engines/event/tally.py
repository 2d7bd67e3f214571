"""Counters of the event-driven engine, and the energy that leaves and enters a scene."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from gaspart.engines.features.impulses import impulses_part
from gaspart.engines.features.pair_impulses import pair_impulses_part
from gaspart.engines.features.part import Part, TallyPart
from gaspart.engines.features.stress import stress_part
from gaspart.kernels import model as kernels
from gaspart.kernels.physics.running_sum import net, values
from gaspart.scene.scene import Scene
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State
from gaspart.state.tally import Tally

PARTS = {"stress": stress_part, "impulses": impulses_part, "pair_impulses": pair_impulses_part}
"""Functions that make the part of an optional tally, by its name."""
_OPTIONAL = kernels.Tally._field_defaults  # entries that a part has


def tally_parts(
    asked: Iterable[OptionalTally],
    flights: np.ndarray,
    model: kernels.Model,
    unit_mass: float,
    scene: Scene,
    state: State,
) -> list[TallyPart]:
    """The parts of optional tallies. flights (N,): the particles; state: that at time 0."""
    return [PARTS[tally.name](tally, flights, model, unit_mass, scene, state) for tally in asked]


class EventTally:
    """The counts of a scene in progress, since the last `reset`.

    arrays: those that the kernels add to; since: the time of the reset; lost (2,): the net and the gross
    energy taken before it, see `dissipated` and `exchanged`.
    """

    def __init__(self, scene: Scene, unit_mass: float, parts: Sequence[Part]) -> None:
        self._unit_mass, self._parts = unit_mass, parts
        self._optional = {part.name: part.kernel for part in parts if isinstance(part, TallyPart)}
        self._surfaces = 2 * scene.dimension + len(scene.walls)
        self.lost = np.zeros(2)

    def reset(self, time: float, clock: float) -> None:
        """Begin to count from zero at a time, which is `clock` on the clocks of the epoch."""
        self.lost = np.array([self.dissipated, self.exchanged])
        self.begin(time, clock)

    def begin(self, time: float, clock: float) -> None:
        """Begin to count from zero, and forget what was counted before."""
        self.arrays = kernels.empty_tally(self._surfaces)._replace(**self._optional)
        for part in self._parts:
            part.reset(clock)
        self.since = time

    @property
    def changing(self) -> dict[str, np.ndarray]:
        """The arrays by name, without those of parts."""
        return {key: array for key, array in self.arrays._asdict().items() if key not in _OPTIONAL}

    def read(self, time: float, clock: float) -> Tally:
        """Counters and sums up to the present `time`."""
        arrays = self.arrays
        sums = (net(terms) * self._unit_mass for terms in arrays.sums)
        counted: dict[str, Any] = dict(zip(kernels.COUNTS, arrays.counts.tolist(), strict=True))
        counted |= zip(kernels.SUMS, sums, strict=True)
        for part in self._parts:
            counted |= part.counts(clock)
        del counted["outdated"]
        return Tally(
            time=time - self.since,
            wall_hits=arrays.wall_hits.copy(),
            wall_impulse=values(arrays.wall_impulse) * self._unit_mass,
            wall_energy=values(arrays.wall_energy) * self._unit_mass,
            worst_contact=float(arrays.worst[0]),
            thermostat_energy=self._given,
            **counted,
        )

    @property
    def dissipated(self) -> float:
        """The energy that contacts and thermal walls have taken since time 0, less what kicks have given."""
        taken = self.arrays.sums[kernels.LOSS], self.arrays.wall_energy
        return float(self.lost[0]) + net(*taken) * self._unit_mass - self._given

    @property
    def exchanged(self) -> float:
        """The sum of what contacts and each face have taken or given since time 0, each counted positive."""
        gross = net(self.arrays.sums[kernels.LOSS]) + float(np.abs(values(self.arrays.wall_energy)).sum())
        return float(self.lost[1]) + gross * self._unit_mass + self._given

    @property
    def _given(self) -> float:
        """The energy that scheduled events have given since the last reset."""
        return sum(part.given for part in self._parts)
