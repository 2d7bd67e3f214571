"""The frames of any program's trajectory, in one form."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from gaspart.analysis.flow import Peculiar, about_the_mean
from gaspart.engines import Engine
from gaspart.scene.gas import Gas
from gaspart.scene.limits import ball_volume
from gaspart.scene.scene import Scene


@dataclass(frozen=True)
class Frames:
    """Data of a trajectory of T frames of N particles that can be checked.

    positions : (T, N, d), on periodic axes inside the container [0, L], NaN for particles that are absent
        from a frame.
    velocities, time : (T, N, d) and (T,), or None if the file does not state it.
    lengths, radii, masses : (d,), (N,), (N,), of the first frame where they change.
    lengths_by_frame, radii_by_frame : (T, d) and (T, N), where they change.
    periodic : (d,), True for each periodic axis.
    plain : True if nothing but elastic contacts moves particles of one mass in a constant container, as far
        as the file knows.
    resolution : error of a position, as a length.
    isolated : True if the file states that it is plain.
    part : True if there are more particles than the file has.
    sampled : True if contacts were sampled, so that particles may overlap.
    engine, scene : by which a file of gaspart was made.
    counted : file of gaspart that counts the exact collisions of these frames.
    no_velocities : reason why there are no velocities.
    reordered : first frame that lists its particles in another order than the one before, without ids to
        restore it, or None.
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

    @property
    def count(self) -> int:
        """N."""
        return self.positions.shape[1]

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.positions.shape[2]

    @property
    def spacing(self) -> float:
        """Distance of neighbours."""
        return float((np.prod(self.lengths) / self.count) ** (1.0 / self.dimension))

    @property
    def no_identity(self) -> str | None:
        """The reason why particles cannot be followed from frame to frame; None if they can."""
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
        """Plain gas of these particles, as far as the file knows, or None.

        The mass is 1, the temperature is the mean of `temperatures` (NaN without velocities). None if the
        particles differ or more than elastic contacts moves them.
        """
        if not self.plain or self.diameter is None:
            return None
        temperature = math.nan if self.velocities is None else float(self.temperatures.mean())
        return Gas(self.dimension, self.packing_fraction, self.count, self.diameter, temperature)

    @cached_property
    def motion(self) -> Peculiar:
        """Velocities of particles of mass 1 about the mean velocity of each frame, along periodic axes.

        Raises ValueError without velocities.
        """
        if self.velocities is None:
            raise ValueError("velocities: None (the file has none)")
        return about_the_mean(self.velocities, np.ones(self.count), np.array(self.periodic))

    @property
    def temperatures(self) -> np.ndarray:
        """Temperature k_B T of each frame, of particles of mass 1, shape (T,).

        It is 0 for a particle that cannot move about the mean.
        """
        energies = self.motion.energies(np.ones(self.count)).sum(axis=1)
        freedom = self.dimension * self.count - sum(self.periodic)
        return np.asarray(energies / max(freedom, 1))

    def at(self, frame: int) -> Frames:
        """Return one frame, with the container and the radii that it has, and without absent particles."""
        lengths, radii, moving = self.lengths_by_frame, self.radii_by_frame, self.velocities
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
