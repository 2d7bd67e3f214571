"""Time correlations of paths and velocities, averaged over particles and time origins.

Sums over all pairs of frames are made by fast Fourier transforms [1]_, in blocks of particles: they take the
memory of a block, and their time grows as T log T for T frames. A squared displacement at a short lag is a
small difference of such sums where particles move far. It is summed directly where that would cost digits.

References
----------
.. [1] V. Calandrini and others, Collection SFN 12, 201 (2011).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_BLOCK = 256
"""Number of coordinates whose transforms are made at once."""
_DIRECT = 1e-4
"""A squared displacement divided by the mean square of coordinates, below which it is summed directly: the
transforms would lose 4 digits or more of 16."""


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
    """Average over particles and all time origins at lags 0 ... `lags` - 1 of `interval`.

    displacements, velocities: (T, N, d), evenly sampled. Raises ValueError for more lags than frames.
    """
    frames, count, dimension = displacements.shape
    if not 1 <= lags <= frames:
        raise ValueError(f"lags: {lags} (must be between 1 and the {frames} frames)")
    r, v = _columns(displacements), _columns(velocities)
    r = r - r.mean(axis=0)
    crossed = _products(r, v)
    lag = np.arange(lags)
    before = np.concatenate([[0.0], np.cumsum((r * v).sum(axis=1))])
    late, early = before[-1] - before[lag], before[frames - lag]
    running = (late - early + crossed[lag] - crossed[-lag]) / (2 * dimension * (frames - lag) * count)
    return Curves(
        interval * lag, squared_displacement(displacements, lags), autocorrelation(velocities, lags), running
    )


def squared_displacement(paths: np.ndarray, lags: int) -> np.ndarray:
    """Return the mean of |r(t) - r(0)|^2 over particles and time origins.

    Parameters
    ----------
    paths : ndarray, shape (T, N, d), [length]
        Continued positions at even times.
    lags : int
        Number of lags, in frames, from 0 on.

    Returns
    -------
    ndarray, shape (lags,), [length^2]
        The mean-squared displacement.
    """
    frames, count, _ = paths.shape
    r = _columns(paths)
    r = r - r.mean(axis=0)  # from the middle of each path: the digits of the differences are kept
    squares = np.einsum("tc,tc->t", r, r)
    before = np.concatenate([[0.0], np.cumsum(squares)])
    lag = np.arange(lags)
    sums = before[frames - lag] + before[-1] - before[lag] - 2.0 * _products(r)[:lags]
    means = sums / ((frames - lag) * count)
    means[0] = 0.0
    for short in np.flatnonzero(means[1:] < _DIRECT * squares.mean() / count) + 1:
        moved = r[short:] - r[: frames - short]
        means[short] = np.einsum("tc,tc->", moved, moved) / ((frames - short) * count)
    return means


def autocorrelation(values: np.ndarray, lags: int) -> np.ndarray:
    """Return the mean of a(0) a(t) over particles, axes and time origins.

    Parameters
    ----------
    values : ndarray, shape (T, N, d)
        Values at even times.
    lags : int
        Number of lags, in frames, from 0 on.

    Returns
    -------
    ndarray, shape (lags,)
        The autocorrelation.
    """
    flat = _columns(values)
    return _products(flat)[:lags] / ((len(flat) - np.arange(lags)) * flat.shape[1])


def _columns(values: np.ndarray) -> np.ndarray:
    """Return values (T, N, d) as columns (T, N d)."""
    return np.asarray(values, dtype=float).reshape(len(values), -1)


def _products(columns: np.ndarray, others: np.ndarray | None = None) -> np.ndarray:
    """Return sums of products of series at a distance in time t.

    The sums are over columns (T, C) and times s, of a(s + t) a(s), or of a(s + t) b(s), at t = 0,
    1 ... T - 1. Negative t are counted from the end.
    """
    from scipy.fft import irfft, next_fast_len, rfft

    length = next_fast_len(2 * len(columns), True)
    power = np.zeros(length // 2 + 1, dtype=float if others is None else complex)
    for first in range(0, columns.shape[1], _BLOCK):
        part = rfft(np.ascontiguousarray(columns[:, first : first + _BLOCK].T), length, axis=1)
        if others is None:
            power += np.einsum("ck,ck->k", part.real, part.real) + np.einsum("ck,ck->k", part.imag, part.imag)
        else:
            other = rfft(np.ascontiguousarray(others[:, first : first + _BLOCK].T), length, axis=1)
            power += np.einsum("ck,ck->k", part, other.conj())
    return np.asarray(irfft(power, length))
