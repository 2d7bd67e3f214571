"""Flights between frames: a particle that keeps its velocity moves by this velocity times the time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gaspart.analysis.flow import sum_squares
from gaspart.inspection.frames import Frames

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
