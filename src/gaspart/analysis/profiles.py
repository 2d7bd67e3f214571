"""Density, flow and temperature in cells, with errors, from sums in each frame.

The number of particles in a cell is correlated over many frames; near the top of a granular bed, the
correlation lasts for tens of collision times. So the frames are combined into at most 256 blocks. The error
of a ratio R = sum A / sum B over the run is the error of the mean of the correlated series (A - R B) / mean
B, for each cell separately.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gaspart.analysis.flow import Grid, mean_motion, sides
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import KNOWN_FREEDOM, common_freedom, correlated_mean
from gaspart.errors import SceneError

LEAST_FRAMES = 16
"""Minimum number of frames for an error."""
BLOCKS = 256
"""Maximum number of blocks of frames. More blocks would cost memory; the correlation between blocks is taken
into account.
"""
_ROUNDING = 1e-12  # relative scatter of a constant value


@dataclass(frozen=True)
class Means:
    """Mean values in cells, their standard errors, and the degrees of freedom of these errors. All arrays
    have the same shape. A value is NaN in an empty cell. An error is NaN if it has fewer than two degrees of
    freedom, or if the value of the cell does not change, for example the velocity if only a single particle
    crosses the cell. An error is 0 if nothing moves, or if all cells have the same value.
    """

    values: np.ndarray
    errors: np.ndarray
    freedoms: np.ndarray

    def times(self, factor: float) -> Means:
        """Multiply the values and errors by an exact number."""
        return Means(factor * self.values, factor * self.errors, self.freedoms)


def ratio(above: np.ndarray, below: np.ndarray, still: bool = False, counted: bool = False) -> Means:
    """Compute the ratio sum A / sum B of two series, with its error. The series have the shape (K, ...) for K
    consecutive blocks, at least 16. `still` is True if nothing moves. `counted` is True if A counts
    particles, so that a cell is empty in blocks with A = 0. The degrees of freedom of a cell are limited to
    the number that follows from the correlation of all cells together, and to one less than the number of
    blocks in which it was occupied.
    """
    total = below.sum(axis=0)
    values = np.divide(above.sum(axis=0), total, out=np.full(total.shape, np.nan), where=total > 0.0)
    occupied = above != 0.0 if counted and not still else below > 0.0
    errors, filled = np.full(total.shape, np.nan), occupied.sum(axis=0)
    freedoms = np.where(total > 0.0, np.maximum(filled - 1.0, 0.0), np.nan)
    with np.errstate(invalid="ignore"):
        rest = (above - values * below) / np.where(total > 0.0, total, np.nan) * len(below)
    defined = values[total > 0.0]
    exact = still or bool((np.abs(defined - defined[:1]) <= _ROUNDING * np.abs(defined)).all())
    common = common_freedom(rest[:, filled > KNOWN_FREEDOM])
    for cell in np.argwhere(filled > KNOWN_FREEDOM):
        at = tuple(cell)
        series = rest[(slice(None), *at)]
        if np.ptp(series) <= _ROUNDING * abs(values[at]):
            errors[at], freedoms[at] = (0.0, freedoms[at]) if exact else (np.nan, 0.0)
            continue
        estimate = correlated_mean(series, LEAST_FRAMES).estimate
        freedoms[at] = min(estimate.freedom, common, freedoms[at])
        errors[at] = estimate.error if freedoms[at] >= KNOWN_FREEDOM else np.nan
    return Means(values, errors, freedoms)


@dataclass(frozen=True)
class Cells:
    """Cells of a run along some axes; along the other axes they extend over the container.

    members : numbers (n,) of the particles that are measured. All of these particles move.
    axes : axes of the grid.
    """

    run: Run
    members: np.ndarray
    axes: tuple[int, ...]
    numbers: tuple[int, ...]

    @cached_property
    def grid(self) -> Grid:
        """Grid of cells in the container at its initial size."""
        lengths = [float(self.run.scene.container.lengths[axis]) for axis in self.axes]
        return Grid((0.0,) * len(lengths), tuple(lengths), self.numbers)

    @cached_property
    def blocks(self) -> np.ndarray:
        """Block number (T,) of each frame; raises SceneError if there are too few frames."""
        frames = len(self.run.time)
        if frames < LEAST_FRAMES:
            raise SceneError("frames", frames, f"an error needs {LEAST_FRAMES} or more")
        return np.arange(frames) * min(BLOCKS, frames) // frames

    def cells_of(self, part: Run) -> np.ndarray:
        """Return the cell number (T, n) of each particle in a part of the run."""
        return self.grid.cells(self._values(part.positions)[..., self.axes], inside=True)

    def _values(self, values: np.ndarray) -> np.ndarray:
        """Return the values (T, n, ...) of the measured particles."""
        return values if len(self.members) == values.shape[1] else values[:, self.members]

    @cached_property
    def _still(self) -> bool:
        """True if none of the particles moves."""
        return not any(self._values(part.velocities).any() for _, part in self.run.parts())

    def sums(self, weigh: Callable[[Run, np.ndarray], Sequence[np.ndarray | None]]) -> list[np.ndarray]:
        """Sum (K, *cells) what `weigh(part, cells)` returns, weights (T, n) or None to count, over blocks."""
        shape = int(self.blocks[-1]) + 1, *self.numbers
        sums: list[np.ndarray] = []
        for frames, part in self.run.parts():
            cells = self.cells_of(part)
            weights = weigh(part, cells)
            if not sums:
                sums = [np.zeros(shape, dtype=int if each is None else float) for each in weights]
            blocks = self.blocks[frames]
            sums = [
                self.grid.sums(cells, each, blocks, total) for each, total in zip(weights, sums, strict=True)
            ]
        return sums

    def room(self) -> np.ndarray:
        """Compute the volume of the cells inside the container, summed over frames, shape (K, *cells)."""
        moving, ends = self.run.scene.moving_axes, sides(self.run, self.run.time[:1])
        lengths = np.diff(ends[0], axis=1)[:, 0]
        across = [axis for axis in range(self.run.dimension) if axis not in self.axes]
        volume = self.grid.volume * lengths[across].prod()
        frames = np.bincount(self.blocks).reshape(-1, *[1] * len(self.axes))
        if not moving:
            return frames * np.full(self.numbers, volume)
        return self._changing_room(across)

    def _changing_room(self, across: Sequence[int]) -> np.ndarray:
        """Compute `room` if faces move."""
        ends = sides(self.run, self.run.time)
        wide = np.diff(ends[:, across], axis=2)[..., 0].prod(axis=1)
        parts = []
        for axis, edge in zip(self.axes, self.grid.edges, strict=True):
            low, high = (ends[:, axis, side, None] for side in (0, 1))
            parts.append(np.clip(np.minimum(edge[1:], high) - np.maximum(edge[:-1], low), 0.0, None))
        total = []
        for frames in np.split(np.arange(len(wide)), np.flatnonzero(np.diff(self.blocks)) + 1):
            room = wide[frames]
            for part in parts:
                room = room[..., None] * part[frames].reshape(len(frames), *[1] * (room.ndim - 1), -1)
            total.append(room.sum(axis=0))
        return np.array(total)

    def density(self, weigh: Callable[[np.ndarray], np.ndarray] | None = None) -> Means:
        """Compute the number of particles, or the sum of weights (T, n), per volume."""
        (sums,) = self.sums(lambda part, cells: [None if weigh is None else weigh(cells)])
        return ratio(sums, self.room(), self._still, counted=True)

    def velocity(self) -> Means:
        """Compute the mean velocity of the particles, shape (d, *cells)."""
        axes = range(self.run.dimension)

        def components(part: Run, cells: np.ndarray) -> list[np.ndarray | None]:
            velocities = self._values(part.velocities)
            return [None, *(velocities[..., k] for k in axes)]

        count, *sums = self.sums(components)
        parts = [ratio(each, count, self._still) for each in sums]
        return Means(*(np.stack([getattr(part, name) for part in parts]) for name in vars(parts[0])))

    def temperature(self, local: bool) -> Means:
        """Compute k_B T of each cell relative to the mean motion, always in these cells if `local`."""
        about = mean_motion(self.run, dict(zip(self.axes, self.numbers, strict=True)), local)
        masses = self.run.masses[self.run.moving]
        chosen: np.ndarray | slice = slice(None)
        if len(self.members) < len(masses):
            chosen = np.searchsorted(np.flatnonzero(self.run.moving), self.members)

        def energies_and_freedoms(part: Run, cells: np.ndarray) -> list[np.ndarray | None]:
            motion = about(part)
            return [motion.energies(masses)[:, chosen], motion.freedoms()[:, chosen]]

        energies, freedoms = self.sums(energies_and_freedoms)
        return ratio(energies, freedoms, self._still)
