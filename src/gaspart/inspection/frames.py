"""Frames of a trajectory of any program, in a common form."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np

from gaspart.analysis.flow import sum_squares
from gaspart.engines import Engine
from gaspart.scene.gas import Gas
from gaspart.scene.limits import ball_volume
from gaspart.scene.scene import Scene


@dataclass(frozen=True)
class Frames:
    """Data of T frames of N particles for the checks.

    positions : (T, N, d), on periodic axes inside the container [0, L], NaN for particles that are absent
        from a frame.
    velocities, time : (T, N, d) and (T,), or None if the file does not contain them.
    lengths, radii, masses : (d,), (N,), (N,), for the first frame if they change.
    lengths_by_frame, radii_by_frame : (T, d) and (T, N), if they change.
    periodic : (d,), True for each periodic axis.
    plain : True if the file states that only elastic contacts move particles of equal mass, in a constant
        container.
    resolution : resolution of a position, as a length.
    isolated : True if the file declares that its scene has no further features.
    part : True if the scene has more particles than the file.
    sampled : True if collision partners were drawn at random, so that particles may overlap.
    engine, scene : engine of a gaspart file.
    counted : gaspart file that counts the exact collisions of these frames.
    no_velocities : reason why velocities are missing.
    reordered : first frame that lists its particles in another order than the preceding frame, if ids do not
        restore the order; otherwise None.
    note : where sizes were found, if the format does not define it.
    """

    positions: np.ndarray
    lengths: np.ndarray
    radii: np.ndarray
    periodic: tuple[bool, ...]
    velocities: np.ndarray | None = None
    time: np.ndarray | None = None
    plain: bool = True
    resolution: float = 0.0
    isolated: bool = False
    part: bool = False
    sampled: bool = False
    masses: np.ndarray | None = None
    lengths_by_frame: np.ndarray | None = None
    radii_by_frame: np.ndarray | None = None
    engine: Engine | None = None
    scene: Scene | None = None
    counted: Path | None = None
    no_velocities: str = "the file has no velocities"
    reordered: int | None = None
    note: str = ""

    @property
    def count(self) -> int:
        """N."""
        return self.positions.shape[1]

    @property
    def dimension(self) -> int:
        """Dimension, 2 or 3."""
        return self.positions.shape[2]

    @property
    def spacing(self) -> float:
        """Mean distance between neighbours."""
        return float((np.prod(self.lengths) / self.count) ** (1.0 / self.dimension))

    @property
    def no_identity(self) -> str | None:
        """Reason why particles cannot be followed between frames, or None."""
        if self.reordered is None:
            return None
        return f"rows are in another order in frame {self.reordered}, and there are no ids to follow them by"

    @property
    def diameter(self) -> float | None:
        """The diameter of all particles, or None if they differ."""
        return float(2.0 * self.radii[0]) if np.ptp(self.radii) == 0.0 else None

    @property
    def packing_fraction(self) -> float:
        """Volume (area) of all particles divided by the volume of the container."""
        return float(ball_volume(self.dimension) * (self.radii**self.dimension).sum() / np.prod(self.lengths))

    @cached_property
    def gas(self) -> Gas | None:
        """Plain gas that these particles form, as far as the file describes it, or None.

        The mass is 1, the temperature is the mean of `temperatures` (NaN without velocities). None if the
        particles differ, or if forces other than elastic contacts act on them.
        """
        if not self.plain or self.diameter is None:
            return None
        temperature = math.nan if self.velocities is None else float(self.temperatures.mean())
        return Gas(self.dimension, self.packing_fraction, self.count, self.diameter, temperature)

    @cached_property
    def squares(self) -> np.ndarray:
        """Squared speeds, shape (T, N)."""
        assert self.velocities is not None, "requires velocities"
        return sum_squares(self.velocities)

    @cached_property
    def peculiar_squares(self) -> np.ndarray:
        """Squared speeds relative to the mean velocity of each frame along periodic axes, shape (T, N)."""
        assert self.velocities is not None, "requires velocities"
        total = np.zeros(self.velocities.shape[:2])
        for k, periodic in enumerate(self.periodic):
            along = self.velocities[..., k]
            total += (along - along.mean(axis=1, keepdims=True) if periodic else along) ** 2
        return total

    @property
    def temperatures(self) -> np.ndarray:
        """Temperature k_B T of each frame for particles of mass 1, shape (T,).

        The temperature is 0 for a single particle that has no motion relative to the mean.
        """
        freedom = self.dimension * self.count - sum(self.periodic)
        return np.asarray(self.peculiar_squares.sum(axis=1) / max(freedom, 1))

    def steps(self) -> Iterator[np.ndarray]:
        """Yield the displacements (N, d) between consecutive frames, by nearest images."""
        for before, after in pairwise(self.positions):
            yield self.nearest(after - before)

    def nearest(self, apart: np.ndarray) -> np.ndarray:
        """Replace separations (N, d) by separations of nearest images, in place."""
        for k in np.flatnonzero(self.periodic):
            apart[:, k] -= self.lengths[k] * np.round(apart[:, k] / self.lengths[k])
        return apart

    @cached_property
    def path(self) -> np.ndarray:
        """Displacement (T, N, d) of each particle since the first frame.

        The displacement is relative to the centre of mass along axes on which particles exchange momentum
        only with each other.
        """
        path = np.zeros(self.positions.shape)
        for n, step in enumerate(self.steps()):
            np.add(path[n], step, out=path[n + 1])
        for k in np.flatnonzero(self.periodic):
            path[..., k] -= path[..., k].mean(axis=1, keepdims=True)
        return path

    def at(self, frame: int) -> Frames:
        """Return a single frame with its container and radii, without absent particles."""
        lengths, radii, moving = self.lengths_by_frame, self.radii_by_frame, self.velocities
        there: np.ndarray | slice = slice(None)
        if not np.isfinite(self.positions[frame]).all():
            there = np.isfinite(self.positions[frame]).all(axis=1)
        return replace(
            self,
            positions=self.positions[frame][None, there],
            velocities=None if moving is None else moving[frame][None, there],
            time=None if self.time is None else self.time[frame][None],
            lengths=self.lengths if lengths is None else lengths[frame],
            radii=(self.radii if radii is None else radii[frame])[there],
            lengths_by_frame=None,
            radii_by_frame=None,
        )
