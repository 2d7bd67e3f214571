"""Momentum and heat given to faces by particles of several sizes, divided by accessible areas.

Areas are the areas of the container at the start; faces and walls that move are at their positions then.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from gaspart.engines.features.part import Part, TallyPart
from gaspart.kernels.physics.per_area import PerArea
from gaspart.kernels.physics.running_sum import values
from gaspart.scene.accessible import Accessible
from gaspart.scene.scene import Scene
from gaspart.state.optional_tallies import PerAreaTally
from gaspart.state.state import State


def inverse_areas(scene: Scene, state: State) -> tuple[np.ndarray, np.ndarray]:
    """Return the inverse accessible area (sizes, 2d) of each face, and the particles' sizes (N,).

    The inverse is 0 for faces that no centre reaches. Fixed particles have the first size.
    """
    fixed = ~np.isfinite(state.masses)
    sizes, size = np.unique(state.radii[~fixed], return_inverse=True)
    areas = Accessible(scene, (state.positions[fixed], state.radii[fixed])).areas(sizes)
    numbers = np.zeros(state.count, np.int64)
    numbers[~fixed] = size
    return np.divide(1.0, areas, out=np.zeros_like(areas), where=areas > 0.0), numbers


def per_area_fields(momentum: np.ndarray, heat: np.ndarray, walls: int) -> dict[str, np.ndarray]:
    """Return the fields of `Tally` from the sums of faces, (2d, d) and (2d,).

    Interior walls have 0.
    """
    return {
        "momentum_per_area": np.pad(momentum, ((0, walls), (0, 0))),
        "heat_per_area": np.pad(heat, (0, walls)),
    }


class EventPerAreaPart(TallyPart):
    """Sums of the event-driven engine, with masses in units of `unit_mass`."""

    kernel: PerArea

    def __init__(self, scene: Scene, state: State, unit_mass: float) -> None:
        d = scene.dimension
        sums = np.zeros((2 * d * (d + 1), 2))
        super().__init__(PerAreaTally.name, PerArea(*inverse_areas(scene, state), sums), {"per_area": sums})
        self._scene, self._unit_mass = scene, unit_mass

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        self.kernel.sums[...] = 0.0

    def counts(self, clock: float) -> dict[str, Any]:
        """Return the sums by the fields of `Tally`."""
        d = self._scene.dimension
        sums = values(self.kernel.sums).reshape(2 * d, d + 1) * self._unit_mass
        return per_area_fields(sums[:, :d], sums[:, d], len(self._scene.walls))


class ThreadedPerAreaPart(Part):
    """Sums of an engine whose threads add to them.

    read : function that returns the value of the sums, (2d, d + 1)
    """

    def __init__(self, sums: np.ndarray, read: Callable[[np.ndarray], np.ndarray]) -> None:
        super().__init__({}, sums={"per_area": sums})
        self._read = read

    def counts(self, clock: float) -> dict[str, Any]:
        """Return the sums by the fields of `Tally`."""
        sums = self._read(self.sums["per_area"])
        return per_area_fields(sums[:, :-1], sums[:, -1], 0)
