"""Observables from paths and velocities of particles: displacement and velocity correlation.

If a run has stored correlations, the observables are averages over all samples, and the uncertainty follows
from the scatter between parts of the run. Otherwise the observables are computed from frames. The uncertainty
then follows from the scatter between groups of particles, which are treated as independent.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.expected.equilibrium import describe
from gaspart.analysis.observable import Observable, observable, with_freedom
from gaspart.analysis.observables import require_defined
from gaspart.analysis.paths import Groups, groups_of
from gaspart.analysis.run import Run, Source, open_run, select_particles
from gaspart.analysis.run_data import FLOW
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.keys.values import count_of
from gaspart.trajectory.correlator import SUMS

# Time correlations of paths and velocities, averaged over particles and time origins.
#
# Sums over all pairs of frames are computed by fast Fourier transforms [1]_, in blocks of particles. The
# memory is that of one block, and the time grows as T log T for T frames. If particles move far, a squared
# displacement at a short lag is a small difference of such sums. It is then summed directly, to avoid a loss
# of digits.
#
# References
# ----------
# .. [1] V. Calandrini and others, Collection SFN 12, 201 (2011).


_FEW_LAGS = 5
"""Number of lags below which a curve has a remark."""
_BLOCK = 256
"""Number of coordinates whose Fourier transforms are computed at once."""
_DIRECT = 1e-4
"""If the squared displacement divided by the mean square of the coordinates is below this limit, it is summed
directly. Fourier transforms would lose at least 4 of 16 digits.
"""


@dataclass(frozen=True)
class Curves:
    """Time correlations of one replica at L lags, in reduced units; each has the shape (L,). `time`, lags.
    `msd`, <|r(t) - r(0)|^2>. `correlation`, <v(0).v(t)> / d. `running`, derivative of msd divided by 2d, from
    <(r(t) - r(0)).(v(t) + v(0))> / 2d, which is exact at every lag.
    """

    time: np.ndarray
    msd: np.ndarray
    correlation: np.ndarray
    running: np.ndarray


def correlate(displacements: np.ndarray, velocities: np.ndarray, interval: float, lags: int) -> Curves:
    """Compute correlations, averaged over particles and all time origins. The lags are 0 ... `lags` - 1 times
    `interval`. `displacements` and `velocities` have the shape (T, N, d) and are sampled at equal intervals.
    Raises ValueError for more lags than frames.
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
    """Compute the mean of |r(t) - r(0)|^2 over particles and time origins."""
    frames, count, _ = paths.shape
    r = _columns(paths)
    r = r - r.mean(axis=0)  # relative to the middle of each path, to keep the digits of the differences
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
    """Compute the mean of a(0) a(t) over particles, axes and time origins."""
    flat = _columns(values)
    return _products(flat)[:lags] / ((len(flat) - np.arange(lags)) * flat.shape[1])


def _columns(values: np.ndarray) -> np.ndarray:
    """Reshape values (T, N, d) to columns (T, N d)."""
    return np.asarray(values, dtype=float).reshape(len(values), -1)


def _products(columns: np.ndarray, others: np.ndarray | None = None) -> np.ndarray:
    """Compute sums over times s and columns of a(s + t) a(s) or a(s + t) b(s), t from 0; negative t at the
    end.
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


# Time correlations accumulated during a run.


_PARTS = 16, 32
"""Minimum and maximum number of parts of a run. The scatter between the parts gives an uncertainty."""
_PART = 4.0
"""Minimum length of a part divided by the longest lag, so that few pairs of samples extend over two parts."""


def average_correlations(trajectory: xr.Dataset) -> Curves:
    """Return the averages of stored correlations up to the last frame, in the scene's unit of time; NaN if
    not stored.
    """
    last, dimension = trajectory.isel(frame=-1), trajectory.sizes["spatial"]
    lags = trajectory.sizes["lag"]
    pairs = float(last["correlated_samples"]) - np.arange(lags)
    velocity, square, crossed = (
        last[name].values / pairs if name in last else np.full(lags, math.nan) for name in SUMS
    )
    return Curves(last["lag"].values, square, velocity / dimension, crossed / (2 * dimension))


def accumulated_mean(run: Run, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Compute the mean of a correlation sum in `SUMS` and its error, by lag. Returns four arrays of shape
    (lags,): the lags, the mean, its standard error, and the degrees of freedom of the error. The mean is over
    all pairs of samples whose later sample is in the measured part of the run. The error follows from the
    scatter between 16 to 32 consecutive parts. In a long run, each part is at least four times as long as the
    longest lag. The result is for particles that are independent of the centre of mass: along axes on which
    the momentum is conserved, the velocity of the centre of mass is subtracted, and the result is multiplied
    by N / (N - 1). Raises SceneError for too few frames, and for a single particle with a constant velocity.
    """
    samples, lags = run.data["correlated_samples"].values, np.arange(run.data.sizes["lag"])
    pairs = np.maximum(samples[:, None] - lags, 0.0)
    frames = np.flatnonzero(pairs[:, -1] > 0.0)
    least, most = _PARTS
    if len(frames) <= least:
        rule = f"an error needs {least + 1} with samples at all lags in the measured part, or more"
        raise SceneError("frames", len(frames), rule)
    span = float(np.ptp(run.time[frames]) / run.data["lag"].values[-1])
    parts = min(len(frames) - 1, int(np.clip(span / _PART, least, most)))
    edges = frames[np.linspace(0, len(frames) - 1, parts + 1).round().astype(int)]
    sums = run.data[name].values[edges]
    scale = _of_free_particles(run)
    _, errors = means_of(np.diff(sums, axis=0) / np.diff(pairs[edges], axis=0))
    values = (sums[-1] - sums[0]) / (pairs[edges[-1]] - pairs[edges[0]])
    return run.data["lag"].values, scale * values, scale * errors, parts - 1.0


def _of_free_particles(run: Run) -> float:
    """Compute <v^2> of independent particles divided by <v^2> relative to the centre of mass."""
    if not run.conserved.any():
        return 1.0
    count = int(np.isfinite(run.masses).sum())
    if count < 2:
        raise SceneError("count", count, "a single particle keeps its velocity")
    return count / (count - 1.0)


def mask_between(time: np.ndarray, start: float, stop: float) -> np.ndarray:
    """Return a mask of the times from `start` to `stop`, both included."""
    return (time >= start * (1.0 - 1e-9)) & (time <= stop * (1.0 + 1e-9))


def line(x: np.ndarray, y: np.ndarray) -> float:
    """Compute the slope of a line by least squares; NaN for fewer than four points."""
    return float(np.polyfit(x, y, 1)[0]) if len(x) >= 4 else math.nan


_SQUARES, _PRODUCTS = "squared_displacement_sum", "velocity_product_sum"


def mean_squared_displacement(
    source: Source,
    lags: int | None = None,
    start: float | None = None,
    species: int | None = None,
    particles: Sequence[int] | None = None,
    per_axis: bool = False,
    about: str = FLOW,
) -> Observable:
    """Measure the mean-squared displacement <|r(t) - r(0)|^2> over moving particles and time origins.

    If the run has stored correlations with displacements, and none of `lags`, `species`, `particles` and
    `per_axis` is passed, all samples are used, and the lags are the lags of the correlations.
    `gaspart.analysis.flow` defines the local flow. The theoretical curve follows from the linear Boltzmann
    equation with Enskog's diffusion coefficient.

    Parameters
    ----------
    lags : int, optional
        Number of lags, in frames. Default: half of the frames.
    particles : sequence of int, optional
        Measure only these particles. For fewer than 16 particles the error follows from the scatter between
        blocks of the run.
    per_axis : bool, default False
        Return the mean-squared displacement along each axis, (axis, lag), instead of the sum over the axes.
    about : {"flow", "rest"}, default "flow"
        Frame of reference. "flow": relative to the local flow if the gas flows; otherwise relative to the
        centre of mass along axes on which the total momentum is conserved, multiplied by N / (N - 1). "rest":
        relative to the container.

    Returns
    -------
    Observable
        The mean-squared displacement (lag,) in [length^2].

    Raises
    ------
    SceneError
        If there are fewer than 16 moving particles and no selection is passed; if the flow changes with time;
        if frames are unevenly spaced; or if frames are too far apart to follow particles across periodic
        faces.
    """
    with open_run(source, start, about=about) as run:
        require_defined("msd", run.scene, species=species, particles=particles, about=about)
        if _accumulates(run, _SQUARES, lags, species, particles) and not per_axis:
            return _displacement(run, *accumulated_mean(run, _SQUARES))
        groups = groups_of(run, chosen=select_particles(run, species, particles))
        number = _lags(groups, lags)
        axes = [slice(k, k + 1) for k in range(run.dimension)] if per_axis else [slice(None)]
        curves = groups.means(
            lambda paths: np.array([squared_displacement(paths[..., k], number) for k in axes])
        )
        time = groups.interval * np.arange(number)
        values, errors = means_of(curves if per_axis else curves[:, 0], groups.sizes)
        result = _displacement(run, time, values, errors, len(curves) - 1.0)
        if lags is None and number < _FEW_LAGS:
            rule = "each block of the run must contain them; store frames more often, or make the run longer"
            result.attrs["note"] = f"{number} lags: {rule}"
        return result


def velocity_autocorrelation(
    source: Source,
    lags: int | None = None,
    start: float | None = None,
    species: int | None = None,
    particles: Sequence[int] | None = None,
    about: str = FLOW,
) -> Observable:
    """Measure the velocity autocorrelation <v(0) . v(t)> / d over moving particles and time origins.

    If the run has stored correlations, all samples are used, as in `mean_squared_displacement`, but the
    correlations need not include displacements. The theoretical curve is (k_B T / m) exp(-2 nu t / d), where
    nu is the collision rate. It is exact at short times, but does not contain the long-time tail.

    Parameters
    ----------
    lags : int, optional
        Number of lags, in frames. Default: half of the frames.

    Returns
    -------
    Observable
        The correlation (lag,) in [length^2/time^2].

    Raises
    ------
    SceneError
        If there are fewer than 16 moving particles, or if frames are unevenly spaced.
    """
    with open_run(source, start, about=about) as run:
        require_defined("vacf", run.scene, species=species, particles=particles, about=about)
        if _accumulates(run, _PRODUCTS, lags, species, particles):
            time, values, errors, freedom = accumulated_mean(run, _PRODUCTS)
            return _autocorrelation(run, time, values / run.dimension, errors / run.dimension, freedom)
        groups = groups_of(run, paths=False, chosen=select_particles(run, species, particles))
        number = _lags(groups, lags)
        curves = groups.means(lambda velocities: autocorrelation(velocities, number))
        time, means = groups.interval * np.arange(number), means_of(curves, groups.sizes)
        return _autocorrelation(run, time, *means, len(curves) - 1.0)


def _accumulates(
    run: Run, name: str, lags: int | None, species: int | None, particles: Sequence[int] | None
) -> bool:
    """Return True if a run accumulated the curve of `SUMS` and does not flow."""
    covers_all = lags is None and species is None and particles is None
    if not (name in run.data and covers_all and run.about == FLOW):
        return False
    return not (run.scene.flow_axes if run.is_subset else run.flow_axes)  # a subset shows no wind


def _displacement(
    run: Run, time: np.ndarray, values: np.ndarray, errors: np.ndarray, freedom: float
) -> Observable:
    """Return the mean-squared displacement, (lag,) or (axis, lag), with theory."""
    attributes = describe("msd", run, time, axes=values.ndim > 1)
    along = {**(axes_of(run) if values.ndim > 1 else {}), **_lag(time)}
    result = observable("mean_squared_displacement", along, values, errors, **attributes)
    return with_freedom(result, freedom)


def _autocorrelation(
    run: Run, time: np.ndarray, values: np.ndarray, errors: np.ndarray, freedom: float
) -> Observable:
    """Return the velocity autocorrelation (lag,), with theory."""
    about = describe("vacf", run, time)
    result = observable("velocity_autocorrelation", _lag(time), values, errors, **about)
    return with_freedom(result, freedom)


def axes_of(run: Run, chosen: np.ndarray | slice = slice(None)) -> dict[str, Any]:
    """Return the dimension `axis` of an observable that is resolved along axes."""
    return {"axis": (np.array(list("xyz"[: run.dimension]))[chosen], {"long_name": "axis"})}


def _lag(time: np.ndarray) -> dict[str, Any]:
    return {"lag": (time, {"units": "time", "long_name": "lag"})}


def _lags(groups: Groups, lags: int | None) -> int:
    frames = groups.frames
    number = max(2, frames // 2) if lags is None else count_of("lags", lags, least=2)
    if number > frames:
        raise SceneError("lags", lags, f"there are {frames} frames")
    return number
