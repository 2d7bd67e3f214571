"""Time correlations of one run's displacements and velocities, averaged over particles and time origins:
computed from frames, or accumulated by the run."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr

from gaspart.analysis.run import Run
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.trajectory.correlator import SUMS

_PARTS = 16, 32
"""Of a run, whose scatter gives an uncertainty: the least and the largest number."""
_PART = 4.0
"""The length of one in longest lags, so that few pairs of samples are on both sides of an edge."""


@dataclass(frozen=True)
class Curves:
    """Time correlations of one replica at L lags, in reduced units, (L,) each.

    time; msd <|r(t) - r(0)|^2>; correlation <v(0).v(t)> / d; running, the msd's derivative over 2d, from
    <(r(t) - r(0)).(v(t) + v(0))> / 2d, which holds at every lag.
    """

    time: np.ndarray
    msd: np.ndarray
    correlation: np.ndarray
    running: np.ndarray


def correlate(displacements: np.ndarray, velocities: np.ndarray, interval: float, lags: int) -> Curves:
    """Averages over particles and all time origins at lags 0 ... `lags` - 1 of `interval`.

    displacements, velocities: (T, N, d), evenly sampled. In double precision throughout: freud's windowed
    mean-squared displacement is the same average, but rounds positions to single precision first.
    Raises ValueError for more lags than frames.
    """
    frames, count, dimension = displacements.shape
    if not 1 <= lags <= frames:
        raise ValueError(f"lags: {lags} (must be between 1 and the {frames} frames)")
    r = np.asarray(displacements, dtype=float).reshape(frames, -1)
    v = np.asarray(velocities, dtype=float).reshape(frames, -1)
    # Sums over particles and axes for every pair of frames at once; a lag is a diagonal of these T x T
    # matrices.
    rr, rv = r @ r.T, r @ v.T
    square, product = np.diag(rr), np.diag(rv)
    msd, running = np.empty(lags), np.empty(lags)
    for lag in range(lags):
        late, early = slice(lag, frames), slice(0, frames - lag)
        pairs = (frames - lag) * count
        msd[lag] = (square[late] + square[early] - 2.0 * np.diag(rr, lag)).sum() / pairs
        crossed = np.diag(rv, -lag) - np.diag(rv, lag)
        running[lag] = (product[late] - product[early] + crossed).sum() / (2 * dimension * pairs)
    return Curves(interval * np.arange(lags), msd, autocorrelation(velocities, lags), running)


def accumulated(trajectory: xr.Dataset) -> Curves:
    """The averages of a run with correlations, as it has accumulated them to its last frame.

    At lags in the scene's time, with velocities as they are; msd and running are NaN without displacements.
    """
    last, dimension = trajectory.isel(frame=-1), trajectory.sizes["spatial"]
    lags = trajectory.sizes["lag"]
    pairs = float(last["correlated_samples"]) - np.arange(lags)
    velocity, square, crossed = (
        last[name].values / pairs if name in last else np.full(lags, math.nan) for name in SUMS
    )
    return Curves(last["lag"].values, square, velocity / dimension, crossed / (2 * dimension))


def accumulated_mean(run: Run, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The lags of a run's correlations, the mean of one of `SUMS` and its standard error at each, (lags,).

    Over pairs of samples of which the later one is in the measured part; the error is the scatter of 16 to 32
    consecutive parts of it, of four times the longest lag if it is long enough. As of freely moving
    particles: where the velocity of the centre of mass, which is taken off, is conserved, times N / (N - 1).
    Raises SceneError for fewer frames, and a single particle that keeps its velocity.
    """
    samples, lags = run.data["correlated_samples"].values, np.arange(run.data.sizes["lag"])
    pairs = np.maximum(samples[:, None] - lags, 0.0)
    known = np.flatnonzero(pairs[:, -1] > 0.0)
    least, most = _PARTS
    if len(known) <= least:
        rule = f"an error needs {least + 1} with samples at all lags in the measured part, or more"
        raise SceneError("frames", len(known), rule)
    span = float(np.ptp(run.time[known]) / run.data["lag"].values[-1])
    parts = min(len(known) - 1, int(np.clip(span / _PART, least, most)))
    edges = known[np.linspace(0, len(known) - 1, parts + 1).round().astype(int)]
    sums = run.data[name].values[edges]
    scale = _of_free_particles(run)
    _, errors = means_of(np.diff(sums, axis=0) / np.diff(pairs[edges], axis=0))
    values = (sums[-1] - sums[0]) / (pairs[edges[-1]] - pairs[edges[0]])
    return run.data["lag"].values, scale * values, scale * errors


def _of_free_particles(run: Run) -> float:
    """A square of velocities of freely moving particles over that about the centre of mass."""
    if not run.conserved.any():
        return 1.0
    count = int(np.isfinite(run.masses).sum())
    if count < 2:
        raise SceneError("count", count, "a single particle keeps its velocity")
    return count / (count - 1.0)


def autocorrelation(values: np.ndarray, lags: int) -> np.ndarray:
    """(lags,) mean over particles, axes and all time origins of values(0) values(t); values: (T, N, d)."""
    frames = len(values)
    flat = np.asarray(values, dtype=float).reshape(frames, -1)
    products = flat @ flat.T
    return np.array([np.diag(products, lag).mean() for lag in range(lags)]) / flat.shape[1]


def between(time: np.ndarray, start: float, stop: float) -> np.ndarray:
    """Mask of the times from `start` to `stop`, both included."""
    return (time >= start * (1.0 - 1e-9)) & (time <= stop * (1.0 + 1e-9))


def line(x: np.ndarray, y: np.ndarray) -> float:
    """Slope of the least-squares line; NaN through fewer than four points."""
    return float(np.polyfit(x, y, 1)[0]) if len(x) >= 4 else math.nan
