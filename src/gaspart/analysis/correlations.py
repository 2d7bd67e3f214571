"""Time correlations of one run's displacements and velocities, averaged over particles and time origins:
computed from frames, or accumulated by the run."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr

from gaspart.trajectory.correlator import SUMS


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
