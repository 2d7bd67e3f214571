"""Observables from the paths and velocities of particles: displacement and velocity correlation.

Of a run with correlations they are what it has accumulated from all its samples, with the scatter of parts of
the run as the uncertainty. Otherwise frames are correlated, and the uncertainty is the scatter of groups of
particles, which are taken as independent.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.conditions import GROUPS
from gaspart.analysis.correlations import Curves, autocorrelation, squared_displacement
from gaspart.analysis.expected.equilibrium import describe
from gaspart.analysis.flow import FLOW
from gaspart.analysis.observable import Observable, observable, with_freedom
from gaspart.analysis.observables import require_defined
from gaspart.analysis.run import Run, Source, open_run, select_particles
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.keys.values import count_of
from gaspart.trajectory.correlator import SUMS

# Time correlations that a run has accumulated.


_PARTS = 16, 32
"""Minimum and maximum number of parts of a run, whose scatter gives an uncertainty."""
_PART = 4.0
"""The length of one in longest lags, so that few pairs of samples are on both sides of an edge."""


def average_correlations(trajectory: xr.Dataset) -> Curves:
    """Return the averages that a run with correlations has accumulated to its last frame.

    At lags in the scene's time, with velocities as they are; msd and running are NaN without displacements.
    """
    last, dimension = trajectory.isel(frame=-1), trajectory.sizes["spatial"]
    lags = trajectory.sizes["lag"]
    pairs = float(last["correlated_samples"]) - np.arange(lags)
    velocity, square, crossed = (
        last[name].values / pairs if name in last else np.full(lags, math.nan) for name in SUMS
    )
    return Curves(last["lag"].values, square, velocity / dimension, crossed / (2 * dimension))


def accumulated_mean(run: Run, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Compute the mean of one of `SUMS` of a run's correlations, and its error, by lag.

    Returned are the lags, the mean and its standard error, (lags,), and the error's degrees of freedom.

    The mean is over pairs of samples of which the later one is in the measured part; the error is the scatter
    of 16 to 32 consecutive parts of it, of four times the longest lag if it is long enough. It holds for
    freely moving particles: where the velocity of the centre of mass, which is subtracted, is conserved, it
    is multiplied by N / (N - 1). Raises SceneError for fewer frames, and a single particle that keeps its
    velocity.
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
    """Return the square of velocities of free particles relative to the centre of mass's frame.

    It is the ratio of both squares.
    """
    if not run.conserved.any():
        return 1.0
    count = int(np.isfinite(run.masses).sum())
    if count < 2:
        raise SceneError("count", count, "a single particle keeps its velocity")
    return count / (count - 1.0)


def mask_between(time: np.ndarray, start: float, stop: float) -> np.ndarray:
    """Mask of the times from `start` to `stop`, both included."""
    return (time >= start * (1.0 - 1e-9)) & (time <= stop * (1.0 + 1e-9))


def line(x: np.ndarray, y: np.ndarray) -> float:
    """Fit the slope of a line by least squares; NaN through fewer than four points."""
    return float(np.polyfit(x, y, 1)[0]) if len(x) >= 4 else math.nan


MOST_FRAMES = 1000
"""Maximum number of frames that are correlated of each group; a longer run has every second or third ..."""
_SQUARES, _PRODUCTS = "squared_displacement_sum", "velocity_product_sum"
_FARTHEST = 0.45  # of a side: the longest way between frames by which a particle is followed


@dataclass(frozen=True)
class Groups:
    """Paths or velocities (T, n, d) of groups of moving particles, made on iteration.

    Parameters
    ----------
    sizes : list of int
        Numbers of particles of the groups.
    frames : int
        Number of frames.
    interval : float, [time]
        Time between frames.
    make : callable
        Function that returns a group, by its number.
    """

    sizes: list[int]
    frames: int
    interval: float
    make: Callable[[int], np.ndarray]

    def __iter__(self) -> Iterator[np.ndarray]:
        return (self.make(number) for number in range(len(self.sizes)))


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

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory, by its path or open, or a simulation.
    lags : int, optional
        Number of lags, in frames. Default: half of the frames.
    start : float, [time], optional
        Frames before this time are discarded. Default: a quarter of the run.
    species : int, optional
        Only this species, by its number in the scene. Single particles have the number after the last.
    particles : sequence of int, optional
        Only these particles. Of fewer than 16 the error is the scatter of as many blocks of the run.
    per_axis : bool, default False
        Along each axis, (axis, lag), instead of the sum.
    about : {"flow", "rest"}, default "flow"
        Frame of reference. "flow": about the local flow where the gas flows; otherwise, along axes on which
        the total momentum is conserved, about the centre of mass, times N / (N - 1). "rest": about the
        container.

    Returns
    -------
    Observable
        The displacement (lag,) in [length^2].

    Raises
    ------
    SceneError
        If there are fewer than 16 moving particles, unless they are selected, the flow changes with time,
        frames are at uneven times, or frames are too far apart to follow particles across periodic faces.

    Notes
    -----
    A run with correlations and displacements has the lags of the correlations, and all samples
    count, unless lags, species, particles or per_axis are given. About the flow: see `gaspart.analysis.flow`.
    Theory: Enskog's diffusion coefficient and the linear Boltzmann equation.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> scene = gp.Scene(box, [gp.Species(32, 0.5, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> gp.analysis.mean_squared_displacement(simulation, lags=5).estimate.dims
    ('lag',)
    """
    with open_run(source, start, about=about) as run:
        require_defined("msd", run.scene, species=species, particles=particles, about=about)
        if _accumulates(run, _SQUARES, lags, species, particles) and not per_axis:
            return _displacement(run, *accumulated_mean(run, _SQUARES))
        groups = groups_of(run, chosen=select_particles(run, species, particles))
        number = _lags(groups, lags)
        axes = [slice(k, k + 1) for k in range(run.dimension)] if per_axis else [slice(None)]
        curves = np.array([[squared_displacement(path[..., k], number) for k in axes] for path in groups])
        time = groups.interval * np.arange(number)
        values, errors = means_of(curves if per_axis else curves[:, 0], groups.sizes)
        return _displacement(run, time, values, errors, len(curves) - 1.0)


def velocity_autocorrelation(
    source: Source,
    lags: int | None = None,
    start: float | None = None,
    species: int | None = None,
    particles: Sequence[int] | None = None,
    about: str = FLOW,
) -> Observable:
    """Measure the velocity autocorrelation <v(0) . v(t)> / d over moving particles and time origins.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory, by its path or open, or a simulation.
    lags : int, optional
        Number of lags, in frames. Default: half of the frames.
    start : float, [time], optional
        Frames before this time are discarded. Default: a quarter of the run.
    species : int, optional
        Only this species, as in `mean_squared_displacement`.
    particles : sequence of int, optional
        Only these particles, as in `mean_squared_displacement`.
    about : {"flow", "rest"}, default "flow"
        Frame of reference, as in `mean_squared_displacement`.

    Returns
    -------
    Observable
        The correlation (lag,) in [length^2/time^2].

    Raises
    ------
    SceneError
        If there are fewer than 16 moving particles, or frames are at uneven times.

    Notes
    -----
    Of a run with correlations, which needs no displacements, all samples count, as in
    `mean_squared_displacement`. Theory: (k_B T / m) exp(-2 nu t / d), with the collision rate nu: exact at
    short times, without the long-time tail.

    Examples
    --------
    >>> import gaspart as gp
    >>> box = gp.Container((10.0, 10.0), boundary="periodic")
    >>> scene = gp.Scene(box, [gp.Species(32, 0.5, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> gp.analysis.velocity_autocorrelation(simulation, lags=5).estimate.dims
    ('lag',)
    """
    with open_run(source, start, about=about) as run:
        require_defined("vacf", run.scene, species=species, particles=particles, about=about)
        if _accumulates(run, _PRODUCTS, lags, species, particles):
            time, values, errors, freedom = accumulated_mean(run, _PRODUCTS)
            return _autocorrelation(run, time, values / run.dimension, errors / run.dimension, freedom)
        groups = groups_of(run, paths=False, chosen=select_particles(run, species, particles))
        number = _lags(groups, lags)
        curves = np.array([autocorrelation(velocity, number) for velocity in groups])
        time, means = groups.interval * np.arange(number), means_of(curves, groups.sizes)
        return _autocorrelation(run, time, *means, len(curves) - 1.0)


def _accumulates(
    run: Run, name: str, lags: int | None, species: int | None, particles: Sequence[int] | None
) -> bool:
    """Return True if a run has accumulated the requested curve, under a name of `SUMS`.

    The gas must not flow.
    """
    covers_all = lags is None and species is None and particles is None
    if not (name in run.data and covers_all and run.about == FLOW):
        return False
    return not (run.scene.flow_axes if run.is_subset else run.flow_axes)  # some particles show no wind


def _displacement(
    run: Run, time: np.ndarray, values: np.ndarray, errors: np.ndarray, freedom: float
) -> Observable:
    """Return the mean-squared displacement (lag,) or (axis, lag), with theory."""
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
    """Return the dimension of an observable along the chosen axes.

    Parameters
    ----------
    run : Run
        The run.
    chosen : ndarray or slice, optional
        The axes. Default: all.

    Returns
    -------
    dict of str to object
        The dimension with its coordinate.
    """
    return {"axis": (np.array(list("xyz"[: run.dimension]))[chosen], {"long_name": "axis"})}


def _lag(time: np.ndarray) -> dict[str, Any]:
    return {"lag": (time, {"units": "time", "long_name": "lag"})}


def _lags(groups: Groups, lags: int | None) -> int:
    frames = groups.frames
    number = max(2, frames // 2) if lags is None else count_of("lags", lags, least=2)
    if number > frames:
        raise SceneError("lags", lags, f"there are {frames} frames")
    return number


def groups_of(
    run: Run,
    paths: bool = True,
    about: np.ndarray | None = None,
    chosen: np.ndarray | None = None,
    stride: int | None = None,
) -> Groups:
    """Return the moving particles in groups, about the centre of mass or the local flow.

    Of fewer than `GROUPS` particles the groups are as many blocks of the run. About the centre of mass, the
    square of a velocity of a particle of mass m is 1 - m / M of its value without this condition, M the mass
    of all. Where the gas flows it is about the local flow (`analysis.flow`).

    Parameters
    ----------
    run : Run
        The run.
    paths : bool, default True
        Paths; otherwise velocities.
    about : ndarray of bool, shape (d,), optional
        Axes along which values are about the centre of mass. Default: those along which its velocity is
        conserved.
    chosen : ndarray, optional
        The chosen ones of the moving particles.
    stride : int, optional
        One of this number of frames is taken. Default: `stride_of`.

    Returns
    -------
    Groups
        The groups.
    """
    moving = run.moving
    steps = np.diff(run.time)
    if np.ptp(steps) > 1e-6 * steps.mean():
        raise SceneError("time", "frames at uneven times", "a correlation needs even ones")
    about = run.conserved if about is None else about
    masses = run.masses[moving]
    chosen = np.arange(len(masses)) if chosen is None else chosen
    stride = stride_of(run, len(chosen)) if stride is None else stride
    others = masses.sum() - masses[chosen]
    if about.any() and not (others > 0.0).all():
        raise SceneError("count", len(masses), "a single particle keeps its velocity")
    free = np.where(about, np.sqrt(masses.sum() / np.where(others > 0.0, others, 1.0))[:, None], 1.0)

    values = _values(run, paths, stride)
    centre = np.array([masses @ frame for frame in values]) / masses.sum()

    def motion(frames: slice, members: np.ndarray) -> np.ndarray:
        part = values[frames][:, chosen[members]].astype(float)
        part -= np.where(about, centre, 0.0)[frames, None]
        part *= free[members]
        return np.asarray(part)

    interval = float(steps.mean()) * stride
    if len(chosen) >= GROUPS:
        alike = _alike(run.species[moving][chosen])
        sizes = [len(members) for members in alike]
        return Groups(sizes, len(values), interval, lambda n: motion(slice(None), alike[n]))
    length, everyone = len(values) // GROUPS, np.arange(len(chosen))
    if length < 4:
        rule = f"an error of fewer than {GROUPS} particles needs {4 * GROUPS} frames or more"
        raise SceneError("frames", len(values), rule)
    sizes = [len(chosen)] * GROUPS
    return Groups(sizes, length, interval, lambda n: motion(slice(n * length, (n + 1) * length), everyone))


def _values(run: Run, paths: bool, stride: int) -> np.ndarray:
    """Return paths or velocities (T, M, d) of the moving particles in every `stride`-th frame.

    Where the gas flows they are about the local flow.
    """
    moving = run.moving
    if not run.flow_axes:
        values = unwrap_positions(run, stride) if paths else run.vectors("velocities")[::stride].values
        return values if moving.all() else values[:, moving]
    velocities, peculiar, free_part = run.velocities[:, moving], run.motion.velocities, run.motion.freedom
    if paths:
        from scipy.integrate import cumulative_trapezoid

        carried = cumulative_trapezoid(velocities - peculiar, run.time, axis=0, initial=0.0)
        return np.asarray((unwrap_positions(run)[:, moving] - carried)[::stride])
    velocities = peculiar / np.sqrt(np.where(free_part > 0.0, free_part, 1.0))
    return velocities[::stride]


def _alike(species: np.ndarray) -> list[np.ndarray]:
    """Return the indices of particles of these species (M,) in each group.

    Groups of a mixture have the same composition: else the difference between species, which no longer run
    reduces, would be their scatter.
    """
    if np.ptp(species) == 0:
        return np.array_split(np.arange(len(species)), GROUPS)
    order = np.argsort(species, kind="stable")
    return [order[first::GROUPS] for first in range(GROUPS)]


def stride_of(run: Run, count: int = GROUPS) -> int:
    """Return the number of frames of which one is taken, for a number of particles.

    Of fewer than `GROUPS` particles each block of the run is a group.

    Parameters
    ----------
    run : Run
        The run.
    count : int, optional
        Number of particles.

    Returns
    -------
    int
        The number of frames.
    """
    return -(-len(run.time) // (MOST_FRAMES * (GROUPS if count < GROUPS else 1)))


def unwrap_positions(run: Run, stride: int = 1) -> np.ndarray:
    """Return positions continued across periodic faces, from the file or by the nearest image.

    Parameters
    ----------
    run : Run
        The run.
    stride : int, default 1
        One of this number of frames is returned.

    Returns
    -------
    ndarray, shape (T, N, d)
        The positions.
    """
    if "displacements" in run.data:
        return run.data["displacements"][::stride].values
    positions = run.vectors("coordinates").values
    lengths = np.where(run.periodic, run.scene.container.lengths, np.inf)
    finite = np.where(run.periodic, run.scene.container.lengths, 1.0)
    path, last = np.zeros(positions.shape[1:]), positions[0].astype(float)
    paths = np.zeros((len(range(0, len(positions), stride)), *path.shape))
    for frame in range(1, len(positions)):
        present = positions[frame].astype(float)
        step, last = present - last, present
        step -= np.where(run.periodic, finite * np.round(step / finite), 0.0)
        if (np.abs(step) > _FARTHEST * lengths).any():
            rule = "is too long to follow particles across periodic faces; make the run with --displacements"
            raise SceneError("sample_interval", float(run.time[1] - run.time[0]), rule)
        path += step
        if frame % stride == 0:
            paths[frame // stride] = path
    return paths
