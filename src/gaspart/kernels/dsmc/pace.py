"""How fast the particles are, and what length of a step fits that.

A step can be divided into 2^level parts. A level fits if the mean speed is within its limits: not so high
that particles fly too far in a part, nor so low that the kicks of a part would change the speeds too much.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, kernel
from gaspart.kernels.dsmc.model import velocity_row


class Pace(NamedTuple):
    """low, high (levels,): the limits of the mean speed of each level; level: the present one; drifts (d,):
    along which axes only the motion about the mean counts; fastest (1,): the highest mean speed found."""

    low: np.ndarray
    high: np.ndarray
    level: int
    drifts: tuple[bool, ...]
    fastest: np.ndarray


@inner_helper
def drift_along(particles, axis, drifts):
    """The mean velocity along an axis, if it does not count."""
    total = 0.0
    if drifts[axis]:
        v = particles.data[velocity_row(particles, axis)]
        for n in range(len(v)):
            total += v[n]
        total /= len(v)
    return total


@inner_helper
def mean_speed(particles, drifts):
    """That of all particles, 0 of none."""
    d, count = len(particles.images), particles.data.shape[1]
    u = particles.data[velocity_row(particles, 0)]
    v = particles.data[velocity_row(particles, 1)]
    w = particles.data[velocity_row(particles, d - 1)]
    flat = 0.0 if d == 2 else 1.0
    mean_u, mean_v = drift_along(particles, 0, drifts), drift_along(particles, 1, drifts)
    mean_w = drift_along(particles, d - 1, drifts)
    total = 0.0
    for n in range(count):
        x, y, z = u[n] - mean_u, v[n] - mean_v, flat * (w[n] - mean_w)
        total += sqrt(x * x + y * y + z * z)
    return total / max(count, 1)


@kernel
def fitting_level(particles, pace):
    """The first level that fits the particles; their number if none does."""
    speed = mean_speed(particles, pace.drifts)
    pace.fastest[0] = max(pace.fastest[0], speed)
    for level in range(len(pace.low)):
        if pace.low[level] <= speed <= pace.high[level]:
            return level
    return len(pace.low)


@inner_helper
def still_fits(particles, pace):
    """Whether the present level does."""
    if pace is None:
        return True
    return fitting_level(particles, pace) == pace.level
