"""Flights between frames: a particle that keeps its velocity moves by this velocity times the time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

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
    squares = (frames.velocities**2).sum(axis=2)
    root = float(np.sqrt(squares.sum() / max(np.count_nonzero(squares), 1)))
    late = root * max(2.0 * resolution(frames.time), _SINGLE * float(np.abs(frames.time).max()))
    wrong, number, where = 0.0, 0, 0
    sides = np.where(frames.periodic, np.inf, frames.lengths - 2.0 * frames.radii.min())
    for n, interval in enumerate(np.diff(frames.time)):
        velocity = frames.velocities[n]
        # back and forth between two walls, a velocity is the same too
        free = (velocity == frames.velocities[n + 1]).all(axis=1) & velocity.any(axis=1)
        free &= (np.abs(velocity) * interval < sides).all(axis=1)
        way = velocity[free] * interval
        off = frames.positions[n + 1][free] - frames.positions[n][free] - way
        off -= np.where(frames.periodic, frames.lengths * np.round(off / frames.lengths), 0.0)
        slack = 4.0 * frames.resolution + late + 2.0 * resolution(velocity) * interval
        excess = np.sqrt((off**2).sum(axis=1)) - slack
        excess /= np.maximum(np.sqrt((way**2).sum(axis=1)), slack)
        number += len(way)
        if len(way) and excess.max() > wrong:
            wrong, where = float(excess.max()), n + 1
    return Flights(number, wrong, where)


def resolution(values: np.ndarray) -> float:
    """Return the rounding error of numbers in single precision, or with a few decimals."""
    if np.array_equal(values, values.astype(np.float32)):
        return _SINGLE * float(np.abs(values).max(initial=0.0))
    sample = values.reshape(-1)[:1000]
    for digits in range(1, _DIGITS):
        if np.array_equal(sample, np.round(sample, digits)):
            return 0.5 * 10.0**-digits
    return 0.0
