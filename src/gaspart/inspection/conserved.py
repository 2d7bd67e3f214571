"""Checks without statistics: conserved energy and momentum, and flights at constant velocity."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gaspart.analysis.flow import sum_squares
from gaspart.inspection.frames import Frames
from gaspart.inspection.statistics import why_not_speeds
from gaspart.inspection.verdict import Check

# Flights between frames: a particle that keeps its velocity moves by this velocity times the time.


WRONG = 1e-3
"""Error of a flight beyond the resolution of the numbers, relative to its length, that is no rounding."""
_SINGLE = float(np.finfo(np.float32).eps)
_DIGITS = 12  # after the point, at which decimals differ from binary numbers


class Flights(NamedTuple):
    """Number of flights without a collision, their largest relative error, and the frame at its end."""

    number: int
    worst: float
    frame: int


def flights(frames: Frames) -> Flights:
    """Compare displacements with velocities of particles whose velocity is the same in two frames."""
    assert frames.velocities is not None and frames.time is not None, "requires velocities and times"
    squares = frames.squares
    root = float(np.sqrt(squares.sum() / max(np.count_nonzero(squares), 1)))
    late = root * max(2.0 * resolution(frames.time), _SINGLE * float(np.abs(frames.time).max()))
    wrong, number, where = 0.0, 0, 0
    sides = np.where(frames.periodic, np.inf, frames.lengths - 2.0 * frames.radii.min())
    for n, interval in enumerate(np.diff(frames.time)):
        velocity = frames.velocities[n]
        free, moves = np.ones(frames.count, dtype=bool), np.zeros(frames.count, dtype=bool)
        for v, after, side in zip(velocity.T, frames.velocities[n + 1].T, sides, strict=True):
            free &= v == after
            free &= np.abs(v) * interval < side  # back and forth between two walls, v is the same too
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


def resolution(values: np.ndarray) -> float:
    """Return the rounding error of numbers in single precision, or with a few decimals."""
    frames = values if values.ndim == 3 else [values]  # each fits the cache of the processor
    if all(np.array_equal(frame, frame.astype(np.float32)) for frame in frames):
        return _SINGLE * float(max(values.max(initial=0.0), -values.min(initial=0.0)))
    sample = values.reshape(-1)[:1000]
    for digits in range(1, _DIGITS):
        if np.array_equal(sample, np.round(sample, digits)):
            return 0.5 * 10.0**-digits
    return 0.0


DRIFT = 1e-6
"""Relative change from frame to frame that is attributed to rounding in the program that made the file."""


def judge_conserved(frames: Frames) -> list[Check]:
    """Check the kinetic energy, the momentum along periodic axes, and flights between frames."""
    names = "energy", "momentum", "flights"
    if reason := why_not_speeds(frames):
        return [Check(name, None, reason) for name in names]
    assert frames.velocities is not None, "see `why_not_speeds`"
    if len(frames.positions) < 2:
        return [Check(name, None, "needs two frames") for name in names]
    root = float(np.sqrt(frames.squares.mean()))
    allowed = DRIFT + 2.0 * resolution(frames.velocities) / root
    energy = frames.squares.sum(axis=1) / (frames.count * root**2)
    checks = [_steady("energy", np.abs(np.diff(energy)), allowed, frames.isolated)]
    if any(frames.periodic):
        axes = np.flatnonzero(frames.periodic)
        mean = np.stack([frames.velocities[..., k].mean(axis=1) for k in axes], axis=1) / root
        change = np.sqrt((np.diff(mean, axis=0) ** 2).sum(axis=1))
        checks.append(_steady("momentum", change, allowed, frames.isolated))
    else:
        checks.append(Check("momentum", None, "walls change it"))
    return [*checks, judge_flights(frames)]


def _steady(name: str, changes: np.ndarray, allowed: float, isolated: bool) -> Check:
    """Check that a quantity stays constant from frame to frame.

    The `changes` (T - 1,) are relative to the quantity of all particles together. If it changes most of the
    time, it is conserved only if the file excludes forces on the particles.
    """
    worst = int(np.argmax(changes))
    text = f"changes by {changes[worst]:.2g} of it at most, before frame {worst + 1} (up to {allowed:.1g})"
    if not isolated and np.median(changes) > allowed:
        reason = f"{text}, and in most intervals: something acts on the particles"
        return Check(name, None, reason, acts=True)
    return Check(name, bool(changes[worst] <= allowed), text)


def judge_flights(frames: Frames) -> Check:
    """Compare the way of a particle whose velocity stays with velocity times time."""
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
