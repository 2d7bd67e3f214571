"""Drift of a run: change between both halves of its measured part beyond the noise.

A line is fitted to a series of n values. Its rise over the run has the variance 12 S / n, with S the spectrum
at frequency 0 of the series without its cubic part, from `statistics.correlated_mean`: the drift itself is
not in its error, as it is in the error of the mean.
"""

from __future__ import annotations

import math

import numpy as np

from gaspart.analysis.estimate import Estimate, concise
from gaspart.analysis.fluxes import particle_numbers
from gaspart.analysis.run import Run, Source, open_run
from gaspart.analysis.statistics import correlated_mean

LEAST_FRAMES = 32
"""Frames without which no drift is looked for."""
SIGNIFICANT = 4.0
"""Standard errors of a rise that is a drift: by chance once in 16 000 series."""
_DEGREE = 3
"""Degree of the polynomial that follows a drift."""
_CONSTANT = 1e-6
"""Relative scatter of what does not change but for rounding."""


def drift_of(data: Source, start: float | None = None, positions: bool = False) -> str:
    """Describe what drifts in the measured part of an open trajectory; "" if nothing does.

    The number of particles is examined where faces are open, the kinetic energy of a particle, and, with
    `positions`, the mean position of the particles along axes with walls.
    """
    with open_run(data, start, sheared=True, varying=True) as run:
        if len(run.time) < LEAST_FRAMES:
            return ""
        drifts = [_drift(name, series) for name, series in _series(run, positions).items()]
    return "; ".join(filter(None, drifts))


def _series(run: Run, positions: bool) -> dict[str, np.ndarray]:
    """Return the series (T,) that are examined, by their names."""
    numbers, series = np.full(len(run.time), max(1, run.scene.moving_count), dtype=float), {}
    if run.scene.is_open:
        numbers = series["the number of particles"] = particle_numbers(run.scene, run.data).astype(float)
    series["the kinetic energy of a particle"] = run.data["kinetic_energy"].values / np.maximum(numbers, 1.0)
    if positions and "coordinates" in run.data and not run.is_subset:
        moving = np.ones(run.count, dtype=bool) if run.scene.is_open else run.moving
        means = np.concatenate([np.nanmean(part.positions[:, moving], axis=1) for _, part in run.parts()])
        for axis in run.scene.walled_axes:
            series[f"the mean position along {'xyz'[axis]}"] = means[:, axis]
    return series


def _drift(name: str, series: np.ndarray) -> str:
    """Describe the drift of a series (T,); "" if it has none."""
    if not np.isfinite(series).all() or np.ptp(series) <= _CONSTANT * np.abs(series).max():
        return ""
    time = np.linspace(-0.5, 0.5, len(series))
    rise = float(time @ (series - series.mean()) / (time @ time))
    rest = correlated_mean(series - np.polynomial.Polynomial.fit(time, series, _DEGREE)(time)).estimate
    if abs(Estimate(rise, math.sqrt(12.0) * rest.error, rest.freedom).deviation) <= SIGNIFICANT:
        return ""
    halves = [half.mean() for half in np.array_split(series, 2)]
    first, second = (concise(float(mean), math.sqrt(2.0) * rest.error) for mean in halves)
    return f"{name} drifts from {first} in the first half to {second} in the second"
