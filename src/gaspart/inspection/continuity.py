"""Continuity of a trajectory of another program: velocities of their frames, rows in one order.

Between collisions a particle moves by its velocity times the time. Velocities that were copied from one frame
into all, and rows in another order in each frame, break this for nearly all particles at once.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from gaspart.inspection.conserved import WRONG, flights
from gaspart.inspection.frames import Frames

_MOST = 0.5
"""Fraction of the particles from which on a finding is no coincidence."""
_NEAR = 0.2
"""Distance within which a predicted position is recognised, in units of the median distance of neighbours. By
chance 0.6 % of the spheres and 3 % of the discs have a neighbour there."""
_KEY = np.sqrt([2.0, 3.0, 5.0])
"""Factors that make one number of a velocity, different for different velocities."""


def continuous(frames: Frames, doubt: str | None, identified: bool) -> Frames:
    """Return frames without copied velocities, and with the first frame in another order.

    doubt : reason to take velocities for copies.
    identified : True if ids have restored the order.
    """
    if frames.velocities is None or len(frames.positions) < 2 or frames.lengths_by_frame is not None:
        return frames  # in a container that changes, nothing is compared with velocities
    if _are_copied(frames, doubt is not None):
        reason = doubt or "velocities are the same in all frames, and positions do not continue them: copies"
        return replace(frames, velocities=None, no_velocities=reason)
    return frames if identified else replace(frames, reordered=_reordered_frame(frames))


def _are_copied(frames: Frames, doubtful: bool) -> bool:
    """Return True if all frames have equal velocities by which particles do not move.

    If `doubtful`, velocities are copies unless the times are known and all particles move by them.
    """
    velocities = frames.velocities
    assert velocities is not None, "see `continuous`"
    if not velocities.any() or np.any(velocities != velocities[0]):
        return False
    if frames.time is None:
        if doubtful:
            return True
        # the time that fits most particles; if none does, they do not move by their velocities
        squares = np.maximum(frames.squares[0], np.finfo(float).tiny)
        times = [np.median((step * velocities[0]).sum(axis=1) / squares) for step in frames.steps()]
        frames = replace(frames, time=np.concatenate([[0.0], np.cumsum(times)]))
    deviation = flights(frames)
    return deviation.worst > WRONG or not deviation.number


def _reordered_frame(frames: Frames) -> int | None:
    """Find the first frame that lists its particles in another order than before, or None."""
    for n in range(len(frames.positions) - 1):
        if _same_velocities_elsewhere(frames, n) or _predicted_elsewhere(frames, n):
            return n + 1
    return None


def _same_velocities_elsewhere(frames: Frames, n: int) -> bool:
    """Return True if frame n + 1 has velocities of frame n in other rows.

    The velocities must occur more often in other rows than in their own row. Velocities that several
    particles have do not count. Two equal particles may exchange their velocities in a head-on collision. If
    times are known, positions show which of the two happened.
    """
    assert frames.velocities is not None, "see `continuous`"
    keys = [(velocity * _KEY[: frames.dimension]).sum(axis=1) for velocity in frames.velocities[n : n + 2]]
    unique = [np.unique(key, return_index=True, return_counts=True) for key in keys]
    alone = [
        (key[(counts == 1) & (key != 0.0)], rows[(counts == 1) & (key != 0.0)])
        for key, rows, counts in unique
    ]
    _, before, after = np.intersect1d(alone[0][0], alone[1][0], assume_unique=True, return_indices=True)
    if not before.size:
        return False
    first, then = alone[0][1][before], alone[1][1][after]
    moved = first != then
    if frames.time is not None and moved.any():
        way = frames.velocities[n][first] * (frames.time[n + 1] - frames.time[n])
        off = frames.nearest(frames.positions[n + 1][then] - frames.positions[n][first] - way)
        moved &= (off**2).sum(axis=1) < _near(frames, n + 1, _tree(frames, n + 1)) ** 2
    return bool(moved.sum() > max(_MOST * len(moved), 2))


def _predicted_elsewhere(frames: Frames, n: int) -> bool:
    """Return True if most particles of a frame are where other rows must have moved.

    The particles are in frame n + 1, the rows are rows of frame n.
    """
    if frames.time is None or frames.count < 3:
        return False
    assert frames.velocities is not None, "see `continuous`"
    predicted = frames.positions[n] + frames.velocities[n] * (frames.time[n + 1] - frames.time[n])
    tree = _tree(frames, n + 1)
    near = _near(frames, n + 1, tree)
    own = np.sqrt((frames.nearest(frames.positions[n + 1] - predicted) ** 2).sum(axis=1))
    if (own < near).mean() > 1.0 - _MOST:
        return False
    distance, row = tree.query(_wrap_positions(frames, predicted), k=1, distance_upper_bound=near)
    elsewhere = np.isfinite(distance) & (row != np.arange(frames.count))
    return bool(elsewhere.sum() > max(_MOST * frames.count, 2))


def _tree(frames: Frames, n: int) -> cKDTree:
    """Return the positions of a frame, for searches."""
    return cKDTree(frames.positions[n], boxsize=np.where(frames.periodic, frames.lengths, 0.0))


def _near(frames: Frames, n: int, tree: cKDTree) -> float:
    """Return `_NEAR` as a length."""
    return _NEAR * float(np.median(tree.query(frames.positions[n], k=2)[0][:, 1]))


def _wrap_positions(frames: Frames, positions: np.ndarray) -> np.ndarray:
    """Return positions in the container along periodic axes."""
    inside = np.where(
        frames.periodic, positions - frames.lengths * np.floor(positions / frames.lengths), positions
    )
    return np.where((inside >= frames.lengths) & frames.periodic, 0.0, inside)
