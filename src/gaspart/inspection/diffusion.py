"""The diffusion coefficient of spheres from a trajectory, and that of theory for their number and cube."""

from __future__ import annotations

import math

import numpy as np

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import mean_of
from gaspart.inspection.frames import Frames

_LINEAR_FROM = 12.0  # collisions per particle, from which on the displacement's square grows evenly
_GROUPS = 32
_DENSEST = 0.4915  # where spheres freeze, and the range of Erpenbeck and Wood ends


def why_not(frames: Frames) -> str | None:
    """The reason why D cannot be measured from a trajectory of equal particles with velocities, or None."""
    if frames.dimension == 2:
        return "discs have none: the displacement's square grows like t ln t"
    if frames.time is None or not all(frames.periodic):
        return "needs times (--time-step) and a periodic container"
    if frames.packing_fraction > _DENSEST or np.ptp(frames.lengths) > 1e-6 * frames.lengths[0]:
        return "needs a fluid in a cube"
    interval = np.diff(frames.time)
    if len(interval) == 0 or np.ptp(interval) > 1e-3 * interval.mean():
        return "needs frames at even times"
    if np.abs(_steps(frames)).max() > 0.45 * frames.lengths[0]:
        return "frames are too far apart to follow a particle across the boundary"
    first, last = _lags(frames)
    if last - first < 1 or len(interval) < 2 * last:
        start = first * interval.mean()
        return f"needs frames closer than {start:.2g} over a time of {4.0 * start:.2g} or more"
    return None


def groups_of(frames: Frames) -> int:
    """Number of groups of particles whose scatter gives the error."""
    return min(frames.count, _GROUPS)


def diffusion(frames: Frames) -> Estimate:
    """D, by the rise of the mean-squared displacement from 12 to 24 collisions a
    particle.

    Of N particles whose total momentum is zero D is (N - 1) / N of its value without this condition; this is
    corrected. The error is the scatter of groups of particles.
    """
    steps, n = _steps(frames), frames.count
    path = np.concatenate([np.zeros_like(steps[:1]), np.cumsum(steps, axis=0)])
    path -= path.mean(axis=1, keepdims=True)
    first, last = _lags(frames)
    squares = [
        ((path[lag:] - path[:-lag]) ** 2).sum(axis=2).mean(axis=0) for lag in (first, last)
    ]  # (N,) each
    time = (last - first) * _interval(frames)
    rise = (squares[1] - squares[0]) / (6.0 * time) * n / (n - 1.0)
    return mean_of(np.array([part.mean() for part in np.array_split(rise, groups_of(frames))]))


def expected_diffusion(frames: Frames) -> tuple[float, float]:
    """D in this cube and its uncertainty: Enskog's, Erpenbeck and Wood's ratio, Yeh and Hummer's shift."""
    sigma, temperature = _diameter(frames), _thermal_speed(frames) ** 2
    return theory.diffusion_in_cube(frames.packing_fraction, float(frames.lengths[0]), sigma, temperature)


def _steps(frames: Frames) -> np.ndarray:
    """(T - 1, N, d) displacements from frame to frame, by the nearest image."""
    steps = np.diff(frames.positions, axis=0)
    return steps - frames.lengths * np.round(steps / frames.lengths)


def _interval(frames: Frames) -> float:
    """Mean time between frames."""
    assert frames.time is not None, "see `why_not`"
    return float(np.diff(frames.time).mean())


def _diameter(frames: Frames) -> float:
    """That of all particles."""
    assert frames.diameter is not None, "requires equal particles"
    return frames.diameter


def _thermal_speed(frames: Frames) -> float:
    """sqrt(k_B T / m), of the motion about the centre of mass."""
    assert frames.velocities is not None, "see `why_not`"
    moving = frames.velocities - frames.velocities.mean(axis=1, keepdims=True)
    return math.sqrt((moving**2).sum() / (len(moving) * frames.dimension * (frames.count - 1)))


def _lags(frames: Frames) -> tuple[int, int]:
    """Frames between which the rise is taken."""
    temperature = _thermal_speed(frames) ** 2
    rate = float(theory.collision_rate(frames.packing_fraction, 3, _diameter(frames), temperature))
    interval = _interval(frames)
    return math.ceil(_LINEAR_FROM / rate / interval), math.ceil(2.0 * _LINEAR_FROM / rate / interval)
