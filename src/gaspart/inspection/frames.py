"""Frames of a trajectory of any program, in a common form."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gaspart.analysis.flow import sum_squares
from gaspart.engines import Engine
from gaspart.scene.facts import Gas
from gaspart.scene.scene import Scene
from gaspart.scene.sizes import ball_volume


class Rows:
    """Vectors (T, N, d) whose frames are read, or computed, when they are used. Indexed by frames like an
    array: a number returns the vectors (N, d) of a frame, a slice or numbers return `Rows`. The last two
    frames are kept, because most checks compare consecutive frames.
    """

    def __init__(self, shape: tuple[int, int, int], read: Callable[[int], np.ndarray]) -> None:
        self.shape, self._read = shape, read
        self._kept: dict[int, np.ndarray] = {}

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, index: Any) -> Any:
        if not isinstance(index, int | np.integer):
            numbers = np.arange(len(self))[index]
            return Rows((len(numbers), *self.shape[1:]), lambda n: self[numbers[n]])
        n = int(index) + (len(self) if index < 0 else 0)
        if not 0 <= n < len(self):
            raise IndexError(index)
        if n not in self._kept:
            if len(self._kept) > 1:
                del self._kept[next(iter(self._kept))]
            self._kept[n] = self._read(n)
        return self._kept[n]

    def __iter__(self) -> Iterator[np.ndarray]:
        return (self[n] for n in range(len(self)))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.array(list(self), dtype)


Vectors = np.ndarray | Rows
"""Vectors (T, N, d) of all frames, in memory or not."""


_BLOCK = 500_000  # number of values that are read at once


def read_in_blocks(shape: tuple[int, int, int], read: Callable[[slice], np.ndarray]) -> Rows:
    """Return vectors of which `read` returns consecutive frames."""
    size = max(1, _BLOCK // max(1, shape[1] * shape[2]))

    @lru_cache(maxsize=2)  # checks compare consecutive frames
    def block(number: int) -> np.ndarray:
        return read(slice(number * size, (number + 1) * size))

    return Rows(shape, lambda n: block(n // size)[n % size])


def map_frames(
    vectors: Vectors, function: Callable[[np.ndarray, int], np.ndarray], width: int | None = None
) -> Rows:
    """Return function(frame, n) for each frame (N, d), computed when it is used; its vectors have `width`."""
    shape = vectors.shape[0], vectors.shape[1], vectors.shape[2] if width is None else width
    return Rows(shape, lambda n: function(vectors[n], n))


class Squares(NamedTuple):
    """Sums over squared speeds in each frame, shape (T,).

    total, largest : sum and maximum of the squared speeds.
    moving : number of squared speeds that are not 0.
    peculiar : sum of the squares relative to the mean velocity along periodic axes.
    kurtosis : mean fourth power of these relative velocities divided by the squared mean square; 1 at rest.
    """

    total: np.ndarray
    largest: np.ndarray
    moving: np.ndarray
    peculiar: np.ndarray
    kurtosis: np.ndarray


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

    positions: Vectors
    lengths: np.ndarray
    radii: np.ndarray
    periodic: tuple[bool, ...]
    velocities: Vectors | None = None
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
        """Plain gas that these particles form, as far as the file describes it, or None. The mass is 1, the
        temperature is the mean of `temperatures` (NaN without velocities). None if the particles differ, or
        if forces other than elastic contacts act on them.
        """
        if not self.plain or self.diameter is None:
            return None
        temperature = math.nan if self.velocities is None else float(self.temperatures.mean())
        return Gas(self.dimension, self.packing_fraction, self.count, self.diameter, temperature)

    @cached_property
    def squares(self) -> Squares:
        """Sums over squared speeds in each frame."""
        assert self.velocities is not None, "requires velocities"
        rows = []
        for n, velocities in enumerate(self.velocities):
            squares, relative = sum_squares(velocities), self.peculiar_squares(n)
            mean = relative.mean()
            kurtosis = (relative**2).mean() / mean**2 if mean > 0.0 else 1.0
            rows.append((squares.sum(), squares.max(), np.count_nonzero(squares), relative.sum(), kurtosis))
        return Squares(*np.array(rows).T)

    def peculiar_squares(self, frame: int) -> np.ndarray:
        """Return squared speeds (N,) relative to the mean velocity of a frame along periodic axes."""
        assert self.velocities is not None, "requires velocities"
        velocities = self.velocities[frame]
        total = np.zeros(len(velocities))
        for along, periodic in zip(velocities.T, self.periodic, strict=True):
            total += (along - along.mean() if periodic else along) ** 2
        return total

    @property
    def temperatures(self) -> np.ndarray:
        """Temperature k_B T of each frame for mass 1, shape (T,); 0 for a single particle at rest to the
        mean.
        """
        freedom = self.dimension * self.count - sum(self.periodic)
        return np.asarray(self.squares.peculiar / max(freedom, 1))

    def steps(self) -> Iterator[np.ndarray]:
        """Yield the displacements (N, d) between consecutive frames, by nearest images."""
        for before, after in pairwise(self.positions):
            yield self.nearest(after - before)

    def nearest(self, apart: np.ndarray) -> np.ndarray:
        """Replace separations (N, d) by separations of nearest images, in place."""
        for k in np.flatnonzero(self.periodic):
            apart[:, k] -= self.lengths[k] * np.round(apart[:, k] / self.lengths[k])
        return apart

    def paths(self, part: slice = slice(None)) -> Iterator[np.ndarray]:
        """Yield the displacements (N, d) of all or some particles since the first frame, in each frame. The
        displacement is relative to the centre of mass along axes on which particles exchange momentum only
        with each other.
        """
        moved = np.zeros(self.positions[0][part].shape)
        yield moved
        for n, (before, after) in enumerate(pairwise(self.positions)):
            moved = moved + self.nearest(after[part] - before[part])
            drift = moved.mean(axis=0) if part == slice(None) else self._drift[n]
            yield moved - np.where(self.periodic, drift, 0.0)

    @cached_property
    def _drift(self) -> np.ndarray:
        """Displacement of the centre of all particles since the first frame, (T - 1, d)."""
        return np.cumsum([step.mean(axis=0) for step in self.steps()], axis=0)

    def parts(self, frames: Sequence[int] | slice) -> Frames:
        """Return some of the frames."""
        return replace(
            self,
            positions=self.positions[frames],
            velocities=None if self.velocities is None else self.velocities[frames],
            time=None if self.time is None else self.time[frames],
        )

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
