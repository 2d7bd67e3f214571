"""Tallies of the DSMC engine that not every run has. Threads add to them, exactly."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from gaspart.engines.features.part import Part, TallyPart
from gaspart.kernels.dsmc.stress import Stress
from gaspart.kernels.physics.exact_sum import WIDTH, exact_parts
from gaspart.scene.scene import Scene
from gaspart.state.drift import drift_of
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.state import State
from gaspart.state.tally import tallied_fluxes


class StressPart(TallyPart):
    """The stress tensor and the heat flux, about the velocity of the centre of mass of a state at time 0."""

    kernel: Stress

    def __init__(self, asked: OptionalTally, scene: Scene, state: State, threads: int) -> None:
        d = scene.dimension
        number = 2 * d * d + d
        sums, cell = np.zeros((threads, number, WIDTH), np.int64), np.zeros((threads, number))
        kernel = Stress(sums, cell, np.zeros((threads, 2, d + 1)), drift_of(scene, state))
        super().__init__("stress", kernel, {}, {"stress": sums})

    def read(self, clock: float) -> np.ndarray:
        """(2 d^2 + d,) the sums of the stress tensor, of its collisional part and of the heat flux."""
        return exact_parts(self.kernel.sums)[:, 0]

    def counts(self, clock: float) -> dict[str, Any]:
        """The sums, by the fields of `Tally`."""
        return tallied_fluxes(self.read(clock), self.kernel.drift)


class WallShearPart(Part):
    """shear (threads, 2d, d, WIDTH): the momentum that faces were given along themselves."""

    def __init__(self, shear: np.ndarray) -> None:
        super().__init__({}, sums={"shear": shear})

    def counts(self, clock: float) -> dict[str, Any]:
        """The momentum, by the field of `Tally`."""
        return {"wall_shear": exact_parts(self.sums["shear"])[..., 0]}


PARTS = {"stress": StressPart}
"""Classes of the parts of optional tallies, by name."""


def tally_parts(asked: Iterable[OptionalTally], scene: Scene, state: State, threads: int) -> list[TallyPart]:
    """The parts of optional tallies. state: that at time 0."""
    return [PARTS[tally.name](tally, scene, state, threads) for tally in asked]
