"""The diffusion coefficient of spheres from a trajectory, and that of theory for their number and cube."""

from __future__ import annotations

import math

import numpy as np

from gaspart import theory
from gaspart.analysis.bulk import EXACT, collision_rate
from gaspart.analysis.diffusion import linear_lags, settled_slope
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.expected.transport import diffusion_in_cube
from gaspart.analysis.statistics import mean_of
from gaspart.inspection.frames import Frames
from gaspart.inspection.samples import path, steps
from gaspart.scene.gas import Gas

_GROUPS = 32


def why_not(frames: Frames) -> str | None:
    """The reason why D cannot be measured from a trajectory of equal particles with velocities, or None."""
    if frames.dimension == 2:
        return "discs have none: the displacement's square grows like t ln t"
    if frames.time is None or not all(frames.periodic):
        return "needs times (--time-step) and a periodic container"
    cubic = np.ptp(frames.lengths) <= 1e-6 * frames.lengths[0]
    if not cubic or frames.packing_fraction > theory.ERPENBECK_WOOD_HIGHEST:
        return "needs a fluid in a cube"
    interval = np.diff(frames.time)
    if len(interval) == 0 or np.ptp(interval) > 1e-3 * interval.mean():
        return "needs frames at even times"
    if np.abs(steps(frames)).max() > 0.45 * frames.lengths[0]:
        return "frames are too far apart to follow a particle across the boundary"
    _, first, last = _lags(frames)
    if last - first < 1 or len(interval) < 2 * last:
        start = first * interval.mean()
        return f"needs frames closer than {start:.2g} over a time of {4.0 * start:.2g} or more"
    return None


def groups_of(frames: Frames) -> int:
    """Number of groups of particles whose scatter gives the error."""
    return min(frames.count, _GROUPS)


def diffusion(frames: Frames) -> tuple[Estimate, tuple[float, float]]:
    """Measure D by the slope of the mean-squared displacement that no longer changes, as `gaspart measure`,
    with the collisions of a particle between which it is taken. Raises SceneError if it still changes.

    Of N particles whose total momentum is zero D is (N - 1) / N of its value without this condition; this is
    corrected. The error is the scatter of groups of particles.
    """
    way, n = path(frames), frames.count
    lags = _lags(frames)
    while 4 * lags[-1] <= len(way):
        lags = [*lags, 2 * lags[-1]]
    squares = np.array([((way[lag:] - way[:-lag]) ** 2).sum(axis=2).mean(axis=0) for lag in lags])  # (K, N)
    times = _interval(frames) * np.diff(lags)
    rises = np.diff(squares, axis=0) / (6.0 * times[:, None]) * n / (n - 1.0)
    groups = np.array([part.mean(axis=1) for part in np.array_split(rises, groups_of(frames), axis=1)])
    number, tail = settled_slope(groups)
    found, rate = mean_of(groups[:, number]), _rate(frames) * _interval(frames)
    window = rate * lags[number], rate * lags[number + 1]
    return Estimate(found.value, math.hypot(found.error, float(tail)), found.freedom), window


def expected_diffusion(frames: Frames, window: tuple[float, float]) -> tuple[float, float, str]:
    """D in this cube, its uncertainty and source, by the equation of the engine, if the file states one."""
    found = diffusion_in_cube(_gas(frames), float(frames.lengths[0]), frames.engine, frames.scene, window)
    assert found is not None, "see `why_not`"
    return found


def _interval(frames: Frames) -> float:
    """Mean time between frames."""
    assert frames.time is not None, "see `why_not`"
    return float(np.diff(frames.time).mean())


def _gas(frames: Frames) -> Gas:
    assert frames.gas is not None, "see `why_not_speeds`"
    return frames.gas


def _rate(frames: Frames) -> float:
    """Return the collisions of a particle per time, by theory."""
    return collision_rate(_gas(frames), frames.engine.equation if frames.engine else EXACT)


def _lags(frames: Frames) -> list[int]:
    """Return the first lags between which slopes are taken, in frames, all different."""
    first, middle, last = linear_lags(_rate(frames), _interval(frames))
    middle = max(middle, first + 1)
    return [first, middle, max(last, middle + 1)]
