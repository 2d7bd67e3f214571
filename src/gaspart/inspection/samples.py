"""How many independent samples a trajectory holds: from the motion of its own particles, whatever made it.

Velocities change by collisions, positions by flights. So the first are judged on a clock of collisions, the
second by the way that particles have moved; neither needs times, nor a law of motion.
"""

from __future__ import annotations

import numpy as np

from gaspart.inspection.frames import Frames

UNEVEN = 20.0
"""Power of a long wave, 1 on average if particles are independent, from which on a gas is not uniform: by
chance once in 1e8."""
_CHANGED = 0.05  # of the root-mean-square speed, from which on a velocity has changed


def collided(frames: Frames) -> np.ndarray:
    """(T,) collisions of a particle since the first frame, or fewer: a lower bound.

    From frame to frame it is the smaller of two numbers: -ln of the fraction of particles whose velocity has
    not changed (reflections at walls apart), and -(d/2) ln of the correlation of velocities, which falls by
    exp(-2s/d) in s collisions. The first is deceived by a thermostat, which changes all velocities a
    little, the second by walls.
    """
    velocities = frames.velocities
    assert velocities is not None, "requires velocities"
    square = (velocities**2).sum(axis=(1, 2))
    least = 0.5 / frames.count
    small = np.maximum(_CHANGED**2 * square / frames.count, np.finfo(float).tiny)
    reflected = np.where(frames.periodic, velocities, np.abs(velocities))
    changed = ((reflected[1:] - reflected[:-1]) ** 2).sum(axis=2) > small[1:, None]
    correlation = (velocities[1:] * velocities[:-1]).sum(axis=(1, 2))
    correlation /= np.maximum(np.sqrt(square[1:] * square[:-1]), np.finfo(float).tiny)
    unhit = -np.log(np.clip(1.0 - changed.mean(axis=1), least, 1.0))
    kept = -0.5 * frames.dimension * np.log(np.clip(correlation, least, 1.0))
    return np.concatenate([[0.0], np.cumsum(np.minimum(unhit, kept))]) + 0.0  # no -0


def independent(times: np.ndarray, rate: float) -> float:
    """Number of independent samples that a mean over frames at `times` is worth, for a property whose
    correlation decays as exp(-rate t): 1 / mean of exp(-rate |t_i - t_j|) over all pairs i, j."""
    total, before = 0.0, 0.0  # sum over earlier frames of their correlation with this one
    for decay in np.exp(-rate * np.diff(times, prepend=times[0])):
        before *= decay
        total += 1.0 + 2.0 * before
        before += 1.0
    return len(times) ** 2 / total


def steps(frames: Frames) -> np.ndarray:
    """(T - 1, N, d) displacements from frame to frame, by nearest images."""
    apart = np.diff(frames.positions, axis=0)
    return apart - np.where(frames.periodic, frames.lengths * np.round(apart / frames.lengths), 0.0)


def path(frames: Frames) -> np.ndarray:
    """(T, N, d) way of each particle since the first frame, about the centre of mass where
    nothing but particles gives it momentum."""
    way = np.concatenate([np.zeros_like(frames.positions[:1]), np.cumsum(steps(frames), axis=0)])
    return way - np.where(frames.periodic, way.mean(axis=1, keepdims=True), 0.0)


def decorrelated_frames(way: np.ndarray, distance: float, first: int = 0) -> list[int]:
    """Frames, from `first` on, between which the particles have moved by a root mean square of `distance` or
    more, one after the other."""
    chosen = [first]
    for n in range(first + 1, len(way)):
        if ((way[n] - way[chosen[-1]]) ** 2).sum(axis=1).mean() >= distance**2:
            chosen.append(n)
    return chosen


def first_relaxed_frame(way: np.ndarray, distance: float) -> int | None:
    """The first frame until which particles have moved by a root mean square of `distance`, or None."""
    far = np.flatnonzero((way**2).sum(axis=2).mean(axis=1) >= distance**2)
    return int(far[0]) if far.size else None


def density_modulation(frames: Frames, n: int, of: np.ndarray | None = None) -> float:
    """The largest power of the two longest waves along each axis, of the particles' density in frame n or,
    with `of` (N,), of that property about its mean: about 1 if it does not depend on the place."""
    weights = np.ones(frames.count) if of is None else of - of.mean()
    total = float((weights**2).sum())
    if total == 0.0:
        return 0.0
    largest = 0.0
    for x, side, periodic in zip(frames.positions[n].T, frames.lengths, frames.periodic, strict=True):
        phases = np.pi * np.outer((2.0, 4.0) if periodic else (1.0, 2.0), x / side)
        powers = (np.cos(phases) @ weights) ** 2
        powers = powers + (np.sin(phases) @ weights) ** 2 if periodic else 2.0 * powers
        largest = max(largest, float(powers.max()))
    return largest / total
