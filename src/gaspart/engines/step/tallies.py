"""Tallies of the time-stepped engine that not every run has. Threads add to them, exactly."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from gaspart.engines.features.impulses import rows_of
from gaspart.engines.features.part import TallyPart
from gaspart.kernels.physics.running_sum import whole_parts
from gaspart.kernels.step.model import StepModel, StepParticles
from gaspart.scene.impulses import row_count
from gaspart.scene.scene import Scene
from gaspart.state.optional_tallies import ImpulseTally, OptionalTally


class ImpulsesPart(TallyPart):
    """The momentum that particles carry through planes across an axis: that below each plane at the last
    reset, `momenta`, and all impulses since then, less that below it at present.

    particles: those of the kernels; unit_mass, largest: the unit of their masses, and the bound of a momentum
    in it. The kernel is the entries of a `StepTally`, by name.
    """

    kernel: dict[str, Any]

    def __init__(
        self,
        asked: OptionalTally,
        particles: StepParticles,
        model: StepModel,
        scene: Scene,
        threads: int,
        units: tuple[float, float],
    ) -> None:
        assert isinstance(asked, ImpulseTally)
        self._particles, (self._unit_mass, self._largest) = particles, units
        self._axis, self._rows = "xyz".index(asked.axis), rows_of(scene)
        self._per_length = asked.bins / scene.container.lengths[self._axis]
        rows = row_count(scene)
        momenta = np.zeros((rows, asked.bins + 1))
        sums = np.zeros((threads, *momenta.shape, 2), np.int64)
        kernel = {
            "impulses": sums,
            "axis": self._axis,
            "pull": 0.0 if model.gravity is None else float(model.gravity[self._axis]),
            "per_length": self._per_length,
            "turns": 1.0 / asked.bins if scene.container.periodic[self._axis] else 0.0,
            "row": self._rows if rows > 1 else None,
        }
        super().__init__("impulses", kernel, {"momenta": momenta}, {"impulses": sums})
        self.reset(0.0)

    def _momenta(self) -> np.ndarray:
        """(rows, bins + 1) the momenta of all particles now, as impulses are summed; in their own order, of
        which rounding is to depend on nothing else."""
        particles = self._particles
        order = np.argsort(particles.index)
        places = particles.positions[self._axis][order].astype(float) * self._per_length
        momenta = particles.masses.astype(float) * particles.velocities[self._axis][order]
        found = np.zeros_like(self.arrays["momenta"])
        bins = np.clip(places.astype(np.int64), 0, found.shape[1] - 2)
        upper = momenta * (places - bins)
        np.add.at(found, (self._rows, bins), momenta - upper)
        np.add.at(found, (self._rows, bins + 1), upper)
        return found

    def reset(self, clock: float) -> None:
        """Begin to count from zero."""
        super().reset(clock)
        self.arrays["momenta"][...] = self._momenta()

    def read(self, clock: float) -> np.ndarray:
        """(species, bins) the momentum that has flown until now."""
        impulses = whole_parts(self.sums["impulses"].sum(axis=0), self._largest).sum(axis=-1)
        below = np.cumsum(impulses + (self.arrays["momenta"] - self._momenta()), axis=1)
        return np.asarray(self._unit_mass * below[:, :-1])

    def counts(self, clock: float) -> dict[str, Any]:
        """The same, by the field of `Tally`."""
        return {"momentum_flux_sum": self.read(clock)}


PARTS = {"impulses": ImpulsesPart}
"""Classes of the parts of optional tallies, by name."""


def tally_parts(
    asked: Iterable[OptionalTally],
    particles: StepParticles,
    model: StepModel,
    scene: Scene,
    threads: int,
    units: tuple[float, float],
) -> list[TallyPart]:
    """The parts of optional tallies. particles: in their slots at time 0; units: see `ImpulsesPart`."""
    return [PARTS[tally.name](tally, particles, model, scene, threads, units) for tally in asked]
