"""What the event-driven engine counts, and the energy that leaves and enters a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaspart.scene.scene import Scene
from gaspart.state.tally import Tally

if TYPE_CHECKING:
    from gaspart.engines.features.thermostat import Kicks
    from gaspart.kernels.model import ContactDuration


class EventTally:
    """The counts of a scene in progress, since the last `reset`.

    arrays: those that the kernels add to; since: the time of the reset; lost (2,): the net and the gross
    energy taken before it, see `dissipated` and `exchanged`.
    """

    def __init__(
        self,
        scene: Scene,
        unit_mass: float,
        duration: ContactDuration | None,
        kicks: Kicks | None,
        time: float,
    ) -> None:
        from gaspart.kernels import model
        from gaspart.kernels.physics import running_sum

        self._kernels, self._sums = model, running_sum
        self._unit_mass, self._duration, self._kicks = unit_mass, duration, kicks
        self._surfaces = 2 * scene.dimension + len(scene.walls)
        self.lost = np.zeros(2)
        self._begin(time)

    def reset(self, time: float) -> None:
        """Begin to count from zero."""
        self.lost = np.array([self.dissipated, self.exchanged])
        self._begin(time)

    def _begin(self, time: float) -> None:
        self.arrays = self._kernels.empty_tally(self._surfaces)
        if self._duration:
            self._duration.elastic[:], self._duration.kept[:] = 0, 0.0
        if self._kicks:
            self._kicks.reset()
        self.since = time

    def read(self, time: float) -> Tally:
        """What was counted up to the present `time`."""
        kernels, arrays, duration = self._kernels, self.arrays, self._duration
        return Tally(
            time=time - self.since,
            collisions=int(arrays.counts[kernels.COLLISIONS]),
            wall_hits=arrays.wall_hits.copy(),
            wall_impulse=self._sums.values(arrays.wall_impulse) * self._unit_mass,
            wall_energy=self._sums.values(arrays.wall_energy) * self._unit_mass,
            virial_sum=self._sums.net(arrays.sums[kernels.VIRIAL]) * self._unit_mass,
            pair_tests=int(arrays.counts[kernels.PAIR_TESTS]),
            box_visits=int(arrays.counts[kernels.BOX_VISITS]),
            crossings=int(arrays.counts[kernels.CROSSINGS]),
            worst_contact=float(arrays.worst[0]),
            dissipated_energy=self._sums.net(arrays.sums[kernels.LOSS]),
            elastic_contacts=int(duration.elastic[0]) if duration else 0,
            retained_energy=self._sums.net(duration.kept) if duration else 0.0,
            thermostat_energy=self._given(),
        )

    @property
    def dissipated(self) -> float:
        """The energy that contacts and thermal walls have taken since time 0, less what kicks have given."""
        taken = self.arrays.sums[self._kernels.LOSS], self.arrays.wall_energy
        return float(self.lost[0]) + self._sums.net(*taken) * self._unit_mass - self._given()

    @property
    def exchanged(self) -> float:
        """The sum of what contacts and each face have taken or given since time 0, each counted positive."""
        loss, walls = self.arrays.sums[self._kernels.LOSS], self._sums.values(self.arrays.wall_energy)
        gross = self._sums.net(loss) + float(np.abs(walls).sum())
        return float(self.lost[1]) + gross * self._unit_mass + self._given()

    def _given(self) -> float:
        """The energy that kicks have given since the last reset."""
        return self._sums.net(self._kicks.given) * self._unit_mass if self._kicks else 0.0
