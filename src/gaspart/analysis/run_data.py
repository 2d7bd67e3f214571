"""Frames of the measured part of a run: particles, counters, and what may move."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
import xarray as xr

from gaspart.errors import SceneError
from gaspart.scene.accessible import Accessible
from gaspart.scene.scene import Scene
from gaspart.state.insertion import per_particle

ABOUT = FLOW, REST = "flow", "rest"
"""Frames of reference for motion: the local flow, or the container at rest."""
_BLOWS = 3.0  # equilibrium standard deviations above which a mean momentum counts as a wind
_BLOCK = 500_000  # number of values that are read at once; more if a single frame has more


@dataclass(frozen=True)
class RunData:
    """Measured part of a run: T frames of N particles in d dimensions.

    time : (T,), times of the frames.
    data : the frames, with cumulative counters of shape (T,) or (T, walls).
    centred : True if the total momentum is known to be zero along the axes on which it is conserved. Then a
        temperature is defined even if the file does not contain all particles or their velocities.
    about : reference of velocities and displacements (`analysis.flow`): the local "flow" of the gas, or
        "rest".
    """

    scene: Scene
    time: np.ndarray
    data: xr.Dataset
    centred: bool = False
    about: str = FLOW

    @property
    def count(self) -> int:
        """Number of particles N in the scene; with open faces, number of particle numbers in use."""
        return self.scene.capacity

    @property
    def dimension(self) -> int:
        """Dimension, 2 or 3."""
        return self.scene.dimension

    @property
    def periodic(self) -> np.ndarray:
        """Mask (d,) of periodic axes."""
        return np.array(self.scene.container.periodic)

    @property
    def interval(self) -> float:
        """Mean time between frames."""
        return float(np.diff(self.time).mean())

    def increments(self, name: str) -> np.ndarray:
        """Compute the growth of a counter in each interval, shape (T - 1, ...)."""
        return np.diff(self._counter(name), axis=0)

    def growth(self, name: str) -> np.ndarray:
        """Compute the growth of a counter per time."""
        first, last = self._counter(name)[[0, -1]]
        return (last - first) / (self.time[-1] - self.time[0])

    def _counter(self, name: str) -> np.ndarray:
        if name not in self.data:
            raise SceneError(
                name, "missing", "the engine does not tally it, or an older version wrote the file"
            )
        return np.asarray(self.data[name].values)

    def block_length(self, blocks: int) -> int:
        """Return the number of frames in each of `blocks` equal blocks after the first; ValueError if too
        few.
        """
        length = (len(self.time) - 1) // blocks
        if length < 1:
            raise ValueError(f"blocks: {blocks} (more than the {len(self.time) - 1} intervals of a run)")
        return length

    @cached_property
    def positions(self) -> np.ndarray:
        """Positions (T, N, d); with open faces, NaN for particle numbers that are not in use."""
        return self.vectors("coordinates").values.astype(float)

    @cached_property
    def velocities(self) -> np.ndarray:
        """Velocities (T, N, d)."""
        return self.vectors("velocities").values.astype(float)

    def vectors(self, name: str) -> xr.DataArray:
        """Return the vectors of all frames; they are read from the file when they are used."""
        if name not in self.data:
            kept = self.data.attrs.get("keep")
            rule = f"the file holds only {kept} of the particles, and {name} are needed; run without keep"
            raise SceneError("keep", kept, rule)
        return self.data[name]

    def frame(self, name: str, number: int) -> np.ndarray:
        """Read the vectors (N, d) of one frame."""
        return np.asarray(self.vectors(name)[number].values, dtype=float)

    def blocks(self, name: str, frames: slice) -> Iterator[np.ndarray]:
        """Read the vectors of some frames in blocks that need limited memory."""
        values = self.vectors(name)[frames]
        for part in divide_frames(len(values), self._numbers):
            yield values[part].values

    @property
    def _numbers(self) -> int:
        """Number of values in the vectors of a frame."""
        return self.data.sizes["atom"] * self.dimension

    def parts(self) -> Iterator[tuple[slice, Self]]:
        """Divide the run into parts that need limited memory."""
        for frames in divide_frames(len(self.time), self._numbers):
            yield frames, replace(self, time=self.time[frames], data=self.data.isel(frame=frames))

    @cached_property
    def masses(self) -> np.ndarray:
        """Masses (N,), infinite for fixed particles; single particles come first, then species."""
        fixed = self._each(per_particle(self.scene, "fixed")).astype(bool)
        return np.where(fixed, np.inf, self._each(per_particle(self.scene, "mass")).astype(float))

    @cached_property
    def radii(self) -> np.ndarray:
        """Radii (N,)."""
        return self._each(per_particle(self.scene, "radius")).astype(float)

    def _each(self, values: np.ndarray) -> np.ndarray:
        """Extend values of the initial particles to all N particle numbers. Particles that enter later have
        the same properties as the initial particles.
        """
        return np.resize(values, self.count)

    @cached_property
    def species(self) -> np.ndarray:
        """Species number (N,) of each particle, as in the scene; single particles have the last number."""
        counts = [len(self.scene.particles), *(kind.count for kind in self.scene.species)]
        return self._each(np.repeat([len(self.scene.species), *range(len(self.scene.species))], counts))

    @property
    def is_subset(self) -> bool:
        """True if the file contains only some of the particles."""
        return self.data.sizes["atom"] < self.count

    @property
    def has_states(self) -> bool:
        """True if the positions and velocities of all particles are in the file."""
        return not self.is_subset and {"coordinates", "velocities"} <= set(self.data.variables)

    def require_all(self) -> None:
        """Raise SceneError if only some of the particles are in the file."""
        if self.is_subset:
            rule = f"needs all {self.count} particles in the file"
            raise SceneError("follow", self.data.sizes["atom"], rule)

    @cached_property
    def moving(self) -> np.ndarray:
        """Mask (N,) of particles that are not fixed. Raises SceneError if the file does not contain all
        particles, unless the run is centred.
        """
        if not self.centred:
            self.require_all()
        return np.isfinite(self.masses)

    @property
    def conserved(self) -> np.ndarray:
        """Mask (d,) of axes along which the total momentum is conserved. Motion along these axes is measured
        relative to the centre of mass. If motion is measured relative to rest, all elements are False.
        """
        return np.array(self.scene.conserved_axes) & (self.about == FLOW)

    @cached_property
    def accessible(self) -> Accessible:
        """Volume and areas accessible to centres, excluding the fixed particles of the run. Raises SceneError
        if the file does not contain the fixed species.
        """
        if not any(kind.fixed and kind.count for kind in self.scene.species):
            return Accessible(self.scene)
        fixed = ~self.moving
        return Accessible(self.scene, (self.frame("coordinates", 0)[fixed], self.radii[fixed]))

    @cached_property
    def flow_axes(self) -> list[int]:
        """Axes along which the flow velocity may vary; none if the gas can only move as a whole. The scene
        may define these axes (`Facts.flow_axes`). If it does not, they are the axes along which a wind may
        vary.
        """
        if self.about != FLOW:
            return []
        scene = self.scene
        return list(scene.flow_axes or (scene.resolved_axes() if self.wind.any() else ()))

    @property
    def wind(self) -> np.ndarray:
        """Mask (d,) of the periodic axes along which a wind (a mean velocity) exists. A wind exists along an
        axis if the momentum along the axis is not conserved, and if its mean over the run is more than three
        times the equilibrium scatter sqrt(M k_B T). If a weaker wind is neglected, the temperature is too
        high by at most the fraction 9 / (d N). For a single particle no wind is assumed, because its momentum
        has no scatter for comparison.
        """
        has_flow = np.zeros(self.dimension, dtype=bool)
        masses = self.masses[self.moving]
        axes = np.flatnonzero(self.periodic & ~self.conserved & (len(masses) > 1))
        if not axes.size:
            return has_flow
        rows = []
        for _, part in self.parts():
            weighted = masses[:, None] * part.velocities[:, self.moving][..., axes]
            momentum = weighted.sum(axis=1)
            weighted **= 2
            weighted /= masses[:, None]
            rows.append([momentum, weighted.sum(axis=1) - momentum**2 / masses.sum()])
        momenta, squares = np.concatenate(rows, axis=1).mean(axis=1)
        has_flow[axes] = momenta**2 > _BLOWS**2 * np.maximum(squares / len(masses), 0.0) * masses.sum()
        return has_flow


def divide_frames(frames: int, numbers: int) -> Iterator[slice]:
    """Divide frames into blocks that need limited memory."""
    length = max(1, _BLOCK // max(1, numbers))
    for first in range(0, frames, length):
        yield slice(first, min(first + length, frames))
