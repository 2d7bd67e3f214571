"""Results of source C's own runs under gravity, next to the numbers in its notebooks.

The sample of such a point begins where the collisions of the source end.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import curve_fit

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.flow import Grid
from gaspart.reproduction.families.shared.columns import field, stretches
from gaspart.reproduction.points.point import Point
from gaspart.trajectory.reading import open_trajectory

_FALL = 0.3
"""Part of the time before the sample in which the oscillation is large, and not yet harmonic."""


def collisions(point: Point) -> float:
    """Compute collisions and hits of walls before the sample, which the source counts alike."""
    with open_trajectory(point.replica_path(0)) as trajectory:
        frame = trajectory.isel(frame=point.schedule.equilibration_frames)
        return float(frame["collisions"] + frame["wall_hits"].sum())


def ringing(point: Point) -> dict[str, Estimate]:
    """Fit the amplitude of the oscillation of the kinetic energy at the start of the sample.

    It is relative to the mean.

    The fit is mean + e^{-t / decay} (a cos w t + b sin w t) to all frames after the fall, with t from the
    start of the sample. The error is from the scatter of the frames.
    """
    begin = point.schedule.equilibration
    with open_trajectory(point.replica_path(0)) as trajectory:
        time, kinetic = trajectory["time"].values, trajectory["kinetic_energy"].values
    late = time > _FALL * begin
    time, kinetic = time[late] - begin, kinetic[late] / kinetic[late].mean()

    def model(t: np.ndarray, mean: float, a: float, b: float, w: float, decay: float) -> np.ndarray:
        return mean + np.exp(-t / decay) * (a * np.cos(w * t) + b * np.sin(w * t))

    frequencies = np.linspace(2.0, 30.0, 600) * np.pi / np.ptp(time)
    power = np.abs(np.exp(1j * np.outer(frequencies, time)) @ (kinetic - 1.0))
    start = (1.0, 0.01, 0.01, frequencies[power.argmax()], 0.5 * begin)
    (_, a, b, _, _), covariance = curve_fit(model, time, kinetic, start, sigma=None, absolute_sigma=False)
    amplitude = float(np.hypot(a, b))
    direction = np.array([a, b]) / amplitude
    error = np.sqrt(direction @ covariance[1:3, 1:3] @ direction)
    return {"ringing": Estimate(amplitude, error, len(time) - len(start))}


def shares(point: Point, layers: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Compute the fraction of the first species in equal layers of the container, (layers,).

    Its error is the binomial one of a single frame: the frames of one sample are close to each other, and so
    are their compositions of a layer. The source has one frame.
    """
    column, [sample] = field(point), stretches(point, 1)
    grid = Grid.line(-0.5 * column.diameter, column.height + 0.5 * column.diameter, layers)
    cells = grid.cells(sample.heights[..., None])
    first, second = (grid.sums(cells[:, column.species == kind]) / len(cells) for kind in (0, 1))
    share = first / (first + second)
    return {"share": (share, np.sqrt(share * (1.0 - share) / (first + second)))}
