"""Checks without statistics: conserved energy and momentum, flights between frames, and continuity."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from gaspart.analysis.flow import sum_squares
from gaspart.inspection.frames import Frames, Vectors
from gaspart.inspection.statistics import why_not_speeds
from gaspart.inspection.verdict import Check

# Flights between frames: a particle with a constant velocity moves by this velocity times the time.


WRONG = 1e-3
"""Relative error of a flight above which the error is not attributed to rounding, in addition to the
resolution of the numbers.
"""
_SINGLE = float(np.finfo(np.float32).eps)
_SAMPLE = 1000  # numbers whose decimal places are counted
_DIGITS = 12  # decimal places at which decimal and binary numbers differ


class Flights(NamedTuple):
    """Number of flights without a collision, their largest relative error, and the frame at which it ends."""

    number: int
    worst: float
    frame: int


def flights(frames: Frames) -> Flights:
    """Compare displacements with velocities for particles whose velocity is the same in two frames."""
    assert frames.velocities is not None and frames.time is not None, "requires velocities and times"
    squares = frames.squares
    root = float(np.sqrt(squares.total.sum() / max(squares.moving.sum(), 1)))
    late = root * max(2.0 * resolution(frames.time), _SINGLE * float(np.abs(frames.time).max()))
    wrong, number, where = 0.0, 0, 0
    sides = np.where(frames.periodic, np.inf, frames.lengths - 2.0 * frames.radii.min())
    for n, interval in enumerate(np.diff(frames.time)):
        velocity = frames.velocities[n]
        free, moves = np.ones(frames.count, dtype=bool), np.zeros(frames.count, dtype=bool)
        for v, after, side in zip(velocity.T, frames.velocities[n + 1].T, sides, strict=True):
            free &= v == after
            free &= np.abs(v) * interval < side  # after two wall hits the velocity is the same, too
            moves |= v != 0.0
        free &= moves
        way = velocity[free] * interval
        off = frames.nearest(frames.positions[n + 1][free] - frames.positions[n][free] - way)
        slack = 4.0 * frames.resolution + late + 2.0 * resolution(velocity) * interval
        excess = np.sqrt(sum_squares(off)) - slack
        excess /= np.maximum(np.sqrt(sum_squares(way)), slack)
        number += len(way)
        if len(way) and excess.max() > wrong:
            wrong, where = float(excess.max()), n + 1
    return Flights(number, wrong, where)


def resolution(values: Vectors) -> float:
    """Return the rounding error of numbers in single precision, or with few decimal places."""
    frames = values if len(values.shape) == 3 else [np.asarray(values)]
    if all(np.array_equal(frame, frame.astype(np.float32)) for frame in frames):
        return _SINGLE * max((float(np.abs(frame).max(initial=0.0)) for frame in frames), default=0.0)
    some = islice(frames, -(-_SAMPLE // max(1, int(np.prod(values.shape[1:])))))
    sample = np.concatenate([np.ravel(frame) for frame in some])[:_SAMPLE]
    for digits in range(1, _DIGITS):
        if np.array_equal(sample, np.round(sample, digits)):
            return 0.5 * 10.0**-digits
    return 0.0


_ONE_WAY = 0.9
"""Net change of the energy divided by the sum of all changes, above which the energy is lost or gained."""
DRIFT = 1e-6
"""Relative change between frames that is attributed to rounding in the program that wrote the file."""


def judge_conserved(frames: Frames, driven: bool = False) -> list[Check]:
    """Check the kinetic energy, the momentum along periodic axes, and flights between frames. `driven`: True
    if something may give energy to the particles or take it. Otherwise the energy in a file of another
    program must not change in one direction.
    """
    names = "energy", "momentum", "flights"
    if reason := why_not_speeds(frames):
        return [Check(name, None, reason) for name in names]
    assert frames.velocities is not None, "see `why_not_speeds`"
    if len(frames.positions) < 2:
        return [Check(name, None, "needs two frames") for name in names]
    total = frames.squares.total
    root = float(np.sqrt(total.mean() / frames.count))
    allowed = DRIFT + 2.0 * resolution(frames.velocities) / root
    energy = total / (frames.count * root**2)
    checks = [_steady("energy", np.abs(np.diff(energy)), allowed, frames.isolated)]
    net = float(energy[-1] - energy[0])
    one_way = abs(net) > _ONE_WAY * float(np.abs(np.diff(energy)).sum())
    if checks[0].acts and one_way and not driven and frames.scene is None:
        verb = "falls" if net < 0.0 else "rises"
        text = f"{verb} in nearly every frame, by {abs(net):.2g} of it: contacts must conserve it "
        text += "(--driven if a force, a thermostat or inelastic contacts change it)"
        checks = [Check("energy", False, text, acts=True)]
    if any(frames.periodic):
        axes = np.flatnonzero(frames.periodic)
        mean = np.array([[each[:, k].mean() for k in axes] for each in frames.velocities]) / root
        change = np.sqrt((np.diff(mean, axis=0) ** 2).sum(axis=1))
        checks.append(_steady("momentum", change, allowed, frames.isolated))
    else:
        checks.append(Check("momentum", None, "walls change it"))
    return [*checks, judge_flights(frames)]


def _steady(name: str, changes: np.ndarray, allowed: float, isolated: bool) -> Check:
    """Check that a quantity is constant from frame to frame. The `changes` (T - 1,) are relative to the total
    of all particles. If the quantity changes in most frames, it must be conserved only if the file excludes
    forces on the particles.
    """
    worst = int(np.argmax(changes))
    text = f"changes by {changes[worst]:.2g} of it at most, before frame {worst + 1} (up to {allowed:.1g})"
    if not isolated and np.median(changes) > allowed:
        reason = f"{text}, and in most intervals: something acts on the particles"
        return Check(name, None, reason, acts=True)
    return Check(name, bool(changes[worst] <= allowed), text)


def judge_flights(frames: Frames) -> Check:
    """Compare the displacements of particles with constant velocities with velocity times time."""
    if reason := frames.no_identity:
        return Check("flights", None, reason)
    if frames.time is None or not (np.diff(frames.time) > 0.0).all():
        return Check("flights", None, "needs increasing times (--time-step)")
    deviation = flights(frames)
    if not deviation.number:
        return Check("flights", None, "no particle kept its velocity from one frame to the next")
    text = f"off by {deviation.worst:.2g} of their length at most in {deviation.number} flights"
    text += " without a collision"
    wrong = deviation.worst > WRONG
    return Check("flights", not wrong, text + (f", before frame {deviation.frame}" if wrong else ""))


# Continuity of a trajectory of another program: velocities belong to their frames, and rows keep their order.
#
# Between collisions a particle moves by its velocity times the time. Two faults break this for nearly all
# particles at once: velocities copied from one frame into all frames, and rows in a different order in each
# frame.


_MOST = 0.5
"""Fraction of the particles above which an agreement is not regarded as a coincidence."""
_NEAR = 0.2
"""Distance within which a predicted position counts as found, in units of the median distance between
neighbours. By chance, 0.6 % of the spheres and 3 % of the discs have a neighbour within this distance.
"""
_KEY = np.sqrt([2.0, 3.0, 5.0])
"""Factors that map different velocities to different numbers."""


def continuous(frames: Frames, doubt: str | None, identified: bool) -> Frames:
    """Return frames without copied velocities (`doubt`: a reason) and the first reordered frame
    (`identified`: by ids).
    """
    if frames.velocities is None or len(frames.positions) < 2 or frames.lengths_by_frame is not None:
        return frames  # in a container that changes, displacements are not compared with velocities
    if _are_copied(frames, doubt is not None):
        reason = doubt or "velocities are the same in all frames, and positions do not continue them: copies"
        return replace(frames, velocities=None, no_velocities=reason)
    return frames if identified else replace(frames, reordered=_reordered_frame(frames))


def _are_copied(frames: Frames, doubtful: bool) -> bool:
    """Return True if all frames have the same velocities, but displacements contradict them."""
    velocities = frames.velocities
    assert velocities is not None, "see `continuous`"
    first = velocities[0]
    if not first.any() or any(np.any(each != first) for each in velocities):
        return False
    if frames.time is None:
        if doubtful:
            return True
        # the time step that fits most particles; if none fits, particles do not move by their velocities
        squares = np.maximum(sum_squares(first), np.finfo(float).tiny)
        times = [np.median((step * first).sum(axis=1) / squares) for step in frames.steps()]
        frames = replace(frames, time=np.concatenate([[0.0], np.cumsum(times)]))
    deviation = flights(frames)
    return deviation.worst > WRONG or not deviation.number


def _reordered_frame(frames: Frames) -> int | None:
    """Find the first frame that lists its particles in a new order, or return None."""
    for n in range(len(frames.positions) - 1):
        if _same_velocities_elsewhere(frames, n) or _predicted_elsewhere(frames, n):
            return n + 1
    return None


def _same_velocities_elsewhere(frames: Frames, n: int) -> bool:
    """Return True if frame n + 1 contains velocities of frame n in other rows. These velocities must occur
    more often in other rows than in their own rows. Velocities that several particles share do not count. If
    the times are known, positions distinguish this case.
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
    """Return True if most particles of frame n + 1 are at positions predicted for other rows of frame n."""
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
    """Return a search tree of the positions in a frame."""
    return cKDTree(frames.positions[n], boxsize=np.where(frames.periodic, frames.lengths, 0.0))


def _near(frames: Frames, n: int, tree: cKDTree) -> float:
    """Return `_NEAR` as a length."""
    return _NEAR * float(np.median(tree.query(frames.positions[n], k=2)[0][:, 1]))


def _wrap_positions(frames: Frames, positions: np.ndarray) -> np.ndarray:
    """Return positions wrapped into the container along periodic axes."""
    inside = np.where(
        frames.periodic, positions - frames.lengths * np.floor(positions / frames.lengths), positions
    )
    return np.where((inside >= frames.lengths) & frames.periodic, 0.0, inside)
