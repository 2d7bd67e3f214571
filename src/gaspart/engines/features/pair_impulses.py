"""The momentum that pairs gain along their separation, from the impulses of contacts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gaspart.engines.features.part import TallyPart
from gaspart.kernels.event.pair_impulses import MEETING, OTHERS, PairImpulses
from gaspart.kernels.event.simd import PLACES
from gaspart.kernels.model import Model
from gaspart.kernels.simd import WIDTH
from gaspart.scene.geometry import ball_volume
from gaspart.scene.scene import Scene
from gaspart.state.optional_tallies import OptionalTally, PairImpulseTally
from gaspart.state.state import State

_FINEST = 2.0**-27
"""The unit of whole numbers, in what a thermal momentum gives to a pair at the smallest diameter: a sum holds
2^36 of these."""


class PairImpulsesPart(TallyPart):
    """What is tallied of them, in whole numbers. unit: of these, in that of `Tally`."""

    kernel: PairImpulses

    def __init__(self, kernel: PairImpulses, unit: float) -> None:
        super().__init__("pair_impulses", kernel, {"pair_impulses": kernel.sums})
        self._units = np.array([[unit], [unit / kernel.share]])

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        self.kernel.sums[...] = 0

    def read(self, clock: float) -> np.ndarray:
        """(2, shells) k_B T g(r) times the time, of the pairs that collide and of the others."""
        return np.asarray(self._units * np.cumsum(self.kernel.sums, axis=1)[:, :-1])

    def counts(self, clock: float) -> dict[str, Any]:
        """The same, by the fields of `Tally`."""
        found = self.read(clock)
        return {"contact_impulse_sum": found[MEETING], "other_impulse_sum": found[OTHERS]}


def pair_impulses_part(
    asked: OptionalTally, flights: np.ndarray, model: Model, unit_mass: float, scene: Scene, state: State
) -> PairImpulsesPart:
    """The part of a `PairImpulseTally`."""
    assert isinstance(asked, PairImpulseTally)
    d, n = scene.dimension, scene.count
    momentum = math.sqrt(2.0 * state.kinetic_energy / n * float(state.masses.max())) / unit_mass
    largest = momentum / (2.0 * scene.smallest_radius) ** (d - 1)
    per_unit = 2.0 ** -round(math.log2(largest * _FINEST)) if largest > 0.0 else 1.0
    per_volume = 1.0 / np.diff(np.arange(asked.shells + 1.0) ** d)
    kernel = PairImpulses(
        sums=np.zeros((2, asked.shells + 1), np.int64),
        impulse=np.zeros(d),
        furthest=float(asked.furthest),
        per_length=asked.shells / asked.furthest,
        per_volume=per_volume,
        per_unit=per_unit,
        share=float(asked.share),
        listed=np.zeros(n + PLACES + WIDTH, np.uint32),
        found=np.zeros((2, WIDTH)),
    )
    pairs = 0.5 * n * (n - 1) * d * ball_volume(d)  # per volume and distance^(d - 1), if independent
    return PairImpulsesPart(kernel, unit_mass * scene.container.volume / (pairs * per_unit))
