"""Paths and velocities of groups of moving particles, read in blocks of particles.

The required memory does not depend on the number of particles. A run that is larger than a block is read
twice. The first pass sums the velocity of the centre of mass. The second pass measures the particles.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from gaspart.analysis.conditions import GROUPS
from gaspart.analysis.run import Run
from gaspart.analysis.run_data import divide_frames
from gaspart.errors import SceneError

MOST_FRAMES = 1000
"""Maximum number of frames that are correlated for each group. In a longer run only every second, third ...
frame is used.
"""
_FARTHEST = 0.45  # maximum displacement between frames, as a fraction of a side
_WHOLE = 5_000_000
"""Maximum number of values of a run that is read at once."""
_BLOCK = 1_000_000
"""Number of values in a block of particles of a larger run."""


@dataclass(frozen=True)
class Groups:
    """Paths or velocities of groups of moving particles, read in blocks of particles."""

    sizes: list[int]
    frames: int
    interval: float
    blocks: Callable[[], Iterator[tuple[int, np.ndarray]]]

    def means(self, function: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """Average a function over the particles of each group."""
        totals: list = [0.0] * len(self.sizes)
        for number, values in self.blocks():
            weight = values.shape[1] / self.sizes[number]
            totals[number] = totals[number] + weight * function(values)
        return np.array(totals)


def groups_of(
    run: Run,
    paths: bool = True,
    about: np.ndarray | None = None,
    chosen: np.ndarray | None = None,
    stride: int | None = None,
) -> Groups:
    """Return the moving particles in groups, relative to the centre of mass or the local flow. If there are
    fewer than `GROUPS` particles, the groups are blocks of the run. Relative to the centre of mass, the mean
    squared velocity of a particle of mass m is reduced by the factor 1 - m / M, where M is the total mass. If
    the gas flows, the values are relative to the local flow (`analysis.flow`).
    """
    steps = np.diff(run.time)
    if np.ptp(steps) > 1e-6 * steps.mean():
        raise SceneError("time", "frames at uneven times", "a correlation needs even ones")
    about = run.conserved if about is None else about
    masses = run.masses[run.moving]
    chosen = np.arange(len(masses)) if chosen is None else chosen
    stride = stride_of(run, len(chosen)) if stride is None else stride
    others = masses.sum() - masses[chosen]
    if about.any() and not (others > 0.0).all():
        raise SceneError("count", len(masses), "a single particle keeps its velocity")
    free = np.where(about, np.sqrt(masses.sum() / np.where(others > 0.0, others, 1.0))[:, None], 1.0)
    values = _Values(run, paths, stride)
    centre = values.centre(masses) if about.any() else np.zeros((1, run.dimension))

    def motion(members: slice) -> np.ndarray:
        part = values.read(chosen[members])
        part -= np.where(about, centre, 0.0)[:, None]
        part *= free[members]
        return part

    interval = float(steps.mean()) * stride
    if len(chosen) >= GROUPS:
        return _groups_of_particles(motion, values, _group_numbers(run.species[run.moving][chosen]), interval)
    length = values.frames // GROUPS
    if length < 4:
        rule = f"an error of fewer than {GROUPS} particles needs {4 * GROUPS} frames or more"
        raise SceneError("frames", values.frames, rule)

    def blocks() -> Iterator[tuple[int, np.ndarray]]:
        part = motion(slice(None))
        return ((n, part[n * length : (n + 1) * length]) for n in range(GROUPS))

    return Groups([len(chosen)] * GROUPS, length, interval, blocks)


def _groups_of_particles(
    motion: Callable[[slice], np.ndarray], values: _Values, numbers: np.ndarray, interval: float
) -> Groups:
    """Build groups of particles from the group number of each particle (M,)."""

    def blocks() -> Iterator[tuple[int, np.ndarray]]:
        for members in values.blocks(len(numbers)):
            part, group = motion(members), numbers[members]
            for n in np.unique(group).tolist():
                yield n, part if (group == n).all() else part[:, group == n]

    return Groups(np.bincount(numbers, minlength=GROUPS).tolist(), values.frames, interval, blocks)


class _Values:
    """Paths or velocities (T, M, d) of the moving particles in every `stride`-th frame. If the gas flows, the
    values are relative to the local flow, and all values are in memory.
    """

    def __init__(self, run: Run, paths: bool, stride: int) -> None:
        self._run, self._paths, self._stride = run, paths, stride
        self._moving = np.flatnonzero(run.moving)
        self.frames = len(range(0, len(run.time), stride))
        self._whole: np.ndarray | None = None
        if run.flow_axes:
            self._whole = _about_flow(run, paths, stride)
        elif self.frames * len(self._moving) * run.dimension <= _WHOLE:
            self._whole = self._read(self._moving)

    def blocks(self, count: int) -> Iterator[slice]:
        """Divide `count` particles into blocks that fit into the memory limit."""
        length = max(1, _BLOCK // (self.frames * self._run.dimension)) if self._whole is None else count
        return (slice(first, first + length) for first in range(0, count, length))

    def read(self, particles: np.ndarray) -> np.ndarray:
        """Return the values (T, n, d) of some of the moving particles, as a new array."""
        if self._whole is not None:
            return self._whole[:, particles]
        return self._read(self._moving[particles])

    def _read(self, particles: np.ndarray) -> np.ndarray:
        values = np.empty((self.frames, len(particles), self._run.dimension))
        for n, frame in enumerate(self._read_frames(particles)):
            values[n] = frame
        return values

    def _read_frames(self, particles: np.ndarray) -> Iterator[np.ndarray]:
        if self._paths:
            return unwrap_positions(self._run, particles, self._stride)
        return _read_vectors(self._run, "velocities", particles, self._stride)

    def centre(self, masses: np.ndarray) -> np.ndarray:
        """Compute the mean (T, d) over the moving particles, weighted by their masses (M,)."""
        total = np.zeros((self.frames, self._run.dimension))
        for members in self.blocks(len(masses)):
            part = self._read_frames(self._moving[members]) if self._whole is None else self._whole
            total += [masses[members] @ frame for frame in part]
        return total / masses.sum()


def _about_flow(run: Run, paths: bool, stride: int) -> np.ndarray:
    """Return paths or velocities (T, M, d) of the moving particles relative to the local flow."""
    moving, peculiar, free_part = run.moving, run.motion.velocities, run.motion.freedom
    if paths:
        from scipy.integrate import cumulative_trapezoid

        carried = cumulative_trapezoid(run.velocities[:, moving] - peculiar, run.time, axis=0, initial=0.0)
        positions = np.array(list(unwrap_positions(run, np.flatnonzero(moving))))
        return np.asarray((positions - carried)[::stride])
    return np.asarray((peculiar / np.sqrt(np.where(free_part > 0.0, free_part, 1.0)))[::stride])


def _group_numbers(species: np.ndarray) -> np.ndarray:
    """Return the group of each particle: groups of equal composition, whose scatter decreases with longer
    runs.
    """
    if np.ptp(species) == 0:
        return np.repeat(np.arange(GROUPS), [len(part) for part in np.array_split(species, GROUPS)])
    numbers = np.empty(len(species), dtype=np.int64)
    numbers[np.argsort(species, kind="stable")] = np.arange(len(species)) % GROUPS
    return numbers


def stride_of(run: Run, count: int = GROUPS) -> int:
    """Return the stride between frames, by the number of particles; few have blocks of the run as groups."""
    return -(-len(run.time) // (MOST_FRAMES * (GROUPS if count < GROUPS else 1)))


def unwrap_positions(run: Run, particles: np.ndarray | None = None, stride: int = 1) -> Iterator[np.ndarray]:
    """Yield positions that are continuous across periodic faces."""
    particles = np.arange(run.data.sizes["atom"]) if particles is None else particles
    if "displacements" in run.data:
        yield from _read_vectors(run, "displacements", particles, stride)
        return
    shape = len(particles), run.dimension  # one row per axis: numpy broadcasts an axis of length 3 slowly
    lengths = np.broadcast_to(np.where(run.periodic, run.scene.container.lengths, 1.0), shape).copy()
    wraps = np.broadcast_to(run.periodic, shape).copy()
    path, last = np.zeros(shape), np.zeros(0)
    for number, present in enumerate(_read_vectors(run, "coordinates", particles)):
        if number > 0:
            step = present - last
            turns = np.round(step / lengths)
            turns *= lengths
            step -= np.where(wraps, turns, 0.0)
            if (np.abs(step)[:, run.periodic] > _FARTHEST * lengths[:, run.periodic]).any():
                rule = (
                    "is too long to follow particles across periodic faces; make the run with --displacements"
                )
                raise SceneError("sample_interval", float(run.time[1] - run.time[0]), rule)
            path = path + step
        last = present
        if number % stride == 0:
            yield path


def _read_vectors(run: Run, name: str, particles: np.ndarray, stride: int = 1) -> Iterator[np.ndarray]:
    """Read vectors (n, d) of particles (n,) in every `stride`-th frame, in blocks of frames."""
    first, stop = int(particles[0]), int(particles[-1]) + 1
    vectors = run.vectors(name)[::stride, first:stop]
    rows = slice(None) if len(particles) == stop - first else particles - first
    for frames in divide_frames(len(vectors), (stop - first) * run.dimension):
        for frame in vectors[frames].values:
            yield frame[rows].astype(float)
