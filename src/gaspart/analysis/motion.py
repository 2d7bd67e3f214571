"""Observables from the paths and velocities of particles: displacement, diffusion, velocity correlation.

Uncertainties are the scatter of groups of particles, which are taken as independent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from gaspart import theory
from gaspart.analysis.correlations import autocorrelation, correlate
from gaspart.analysis.observable import Observable, observable
from gaspart.analysis.source import Run, Source, measured
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.scene.validation import count_of

GROUPS = 16
"""Of particles, whose scatter gives the uncertainty."""
MOST_FRAMES = 1000
"""That are correlated; of a longer run, every second or third ..."""
LINEAR_FROM = 12.0
"""Collisions per particle, from which on the mean-squared displacement grows evenly."""
_DENSEST = 0.4915  # where spheres freeze, and the range of Erpenbeck and Wood ends
_FARTHEST = 0.45  # of a side: the longest way between frames by which a particle is followed


@dataclass(frozen=True)
class _Groups:
    """Paths and velocities (G, T, n, d) of groups of moving particles, at even times, `interval` apart."""

    paths: list[np.ndarray]
    velocities: list[np.ndarray]
    interval: float


def mean_squared_displacement(
    source: Source, lags: int | None = None, start: float | None = None
) -> Observable:
    """<|r(t) - r(0)|^2> over moving particles and time origins, (lag,), in length^2.

    source: a trajectory, by its path or open, or a simulation; lags: their number (by default half of the
    frames); start: the time from which frames count (by default a quarter of the run). Of N particles whose
    total momentum is zero it is multiplied by N / (N - 1). Theory: that of Enskog's diffusion coefficient
    and an exponential velocity correlation. Raises SceneError for fewer than 16 moving particles, frames at
    uneven times, and frames too far apart to follow particles across periodic faces.
    """
    with measured(source, start) as run:
        groups = _groups(run)
        number = _lags(groups, lags)
        found = np.array(
            [
                correlate(path, velocity, groups.interval, number).msd
                for path, velocity in zip(groups.paths, groups.velocities, strict=True)
            ]
        )
        time = groups.interval * np.arange(number)
        values, errors = means_of(found * _free(run))
        expected: dict[str, Any] = {}
        if run.fluid:
            eta, d = run.scene.packing_fraction, run.dimension
            curve = theory.enskog_mean_squared_displacement(time, eta, d, **run.particle)
            expected = {"theory": (curve, math.nan), "source": "Enskog, exponential velocity correlation"}
        about: dict[str, Any] = {"units": "length^2", "long_name": "mean-squared displacement", **expected}
        return observable("mean_squared_displacement", _lag(time), values, errors, **about)


def velocity_autocorrelation(
    source: Source, lags: int | None = None, start: float | None = None
) -> Observable:
    """<v(0) . v(t)> / d over moving particles and time origins, (lag,), in length^2 / time^2.

    Arguments as of `mean_squared_displacement`. Theory: (k_B T / m) exp(-2 nu t / d), nu the collision rate:
    exact at short times, without the long-time tail. Raises SceneError for fewer than 16 moving particles,
    and frames at uneven times.
    """
    with measured(source, start) as run:
        groups = _groups(run, paths=False)
        number = _lags(groups, lags)
        found = np.array([autocorrelation(velocity, number) for velocity in groups.velocities])
        time = groups.interval * np.arange(number)
        values, errors = means_of(found * _free(run))
        expected: dict[str, Any] = {}
        if run.fluid:
            eta, d, own = run.scene.packing_fraction, run.dimension, run.particle
            rate = float(theory.velocity_decay_rate(eta, d, **own))
            curve = own["temperature"] / own["mass"] * np.exp(-rate * time)
            expected = {"theory": (curve, math.nan), "source": "Enskog, exact initial decay"}
        about: dict[str, Any] = {
            "units": "length^2 / time^2",
            "long_name": "velocity autocorrelation",
            **expected,
        }
        return observable("velocity_autocorrelation", _lag(time), values, errors, **about)


def diffusion_coefficient(source: Source, start: float | None = None) -> Observable:
    """D in length^2 / time, by the rise of the mean-squared displacement from 12 to 24 collisions a particle.

    Arguments and condition of zero momentum as in `mean_squared_displacement`. Theory: of spheres in a
    periodic cube, Erpenbeck and Wood's with the shift of Yeh and Hummer, half of which is its uncertainty.
    Raises SceneError for discs that all move, whose squared displacement grows like t ln t, and for runs that
    are too short.
    """
    with measured(source, start) as run:
        if run.dimension == 2 and run.moving.all():
            rule = "discs have no diffusion coefficient: their squared displacement grows like t ln t"
            raise SceneError("container.lengths", run.scene.container.lengths, rule)
        groups = _groups(run)
        first, last = _linear_lags(run, groups)
        time = (last - first) * groups.interval
        rises = []
        for path in groups.paths:
            early, late = (
                float(((path[lag:] - path[:-lag]) ** 2).sum(axis=2).mean()) for lag in (first, last)
            )
            rises.append((late - early) / (2 * run.dimension * time))
        value, error = means_of(np.array(rises) * _free(run))
        about: dict[str, Any] = {
            "units": "length^2 / time",
            "long_name": "diffusion coefficient D",
            **_theory_of_d(run),
        }
        return observable("diffusion_coefficient", {}, float(value), float(error), **about)


def _linear_lags(run: Run, groups: _Groups) -> tuple[int, int]:
    """Frames between which the rise is taken. Raises SceneError where there are too few."""
    collisions = float(run.increments("collisions").sum())
    duration = float(run.time[-1] - run.time[0])
    rate = 2.0 * collisions / (run.moving.sum() * duration)
    frames = len(groups.velocities[0])
    if rate == 0.0 or frames * groups.interval * rate < 4.0 * LINEAR_FROM:
        rule = f"must cover {4.0 * LINEAR_FROM:g} collisions of a particle or more"
        raise SceneError("duration", duration, rule)
    first, last = (math.ceil(k * LINEAR_FROM / rate / groups.interval) for k in (1.0, 2.0))
    return first, max(last, first + 1)


def _theory_of_d(run: Run) -> dict[str, Any]:
    eta, sides = run.scene.packing_fraction, np.array(run.scene.container.lengths)
    if not run.bulk or run.dimension == 2 or eta > _DENSEST or np.ptp(sides) > 1e-6 * sides[0]:
        return {}
    expected = theory.diffusion_in_cube(eta, float(sides[0]), **run.particle)
    return {"theory": expected, "source": "Erpenbeck and Wood, Yeh and Hummer"}


def _free(run: Run) -> float:
    """What turns the motion of particles of zero total momentum into that without this condition."""
    count = int(run.moving.sum())
    return count / (count - 1) if run.conserved.all() else 1.0


def _lag(time: np.ndarray) -> dict[str, Any]:
    return {"lag": (time, {"units": "time", "long_name": "lag"})}


def _lags(groups: _Groups, lags: int | None) -> int:
    frames = len(groups.velocities[0])
    number = max(2, frames // 2) if lags is None else count_of("lags", lags, least=2)
    if number > frames:
        raise SceneError("lags", lags, f"there are {frames} frames")
    return number


def _groups(run: Run, paths: bool = True) -> _Groups:
    """The moving particles in groups, about the centre of mass where its velocity is conserved."""
    moving, stride = run.moving, -(-len(run.time) // MOST_FRAMES)
    if moving.sum() < GROUPS:
        raise SceneError("count", int(moving.sum()), f"an error needs {GROUPS} moving particles or more")
    steps = np.diff(run.time)
    if np.ptp(steps) > 1e-6 * steps.mean():
        raise SceneError("time", "frames at uneven times", "a correlation needs even ones")
    split = np.array_split(np.arange(moving.sum()), GROUPS)
    travelled = _unwrapped(run)[::stride, moving] if paths else None
    if travelled is not None:
        masses = run.masses[moving]
        centre = np.einsum("tnd,n->td", travelled, masses) / masses.sum()
        travelled = travelled - np.where(run.conserved, centre, 0.0)[:, None]
    velocities = run.peculiar[::stride]
    return _Groups(
        paths=[] if travelled is None else [travelled[:, part] for part in split],
        velocities=[velocities[:, part] for part in split],
        interval=float(steps.mean()) * stride,
    )


def _unwrapped(run: Run) -> np.ndarray:
    """(T, N, d) positions continued across periodic faces: those of the file, or by the nearest image."""
    if "displacements" in run.data:
        return run.data["displacements"].values
    steps = np.diff(run.positions, axis=0)
    lengths = np.where(run.periodic, run.scene.container.lengths, np.inf)
    finite = np.where(run.periodic, run.scene.container.lengths, 1.0)
    steps -= np.where(run.periodic, finite * np.round(steps / finite), 0.0)
    if (np.abs(steps) > _FARTHEST * lengths).any():
        rule = "is too long to follow particles across periodic faces; make the run with --displacements"
        raise SceneError("sample_interval", float(run.time[1] - run.time[0]), rule)
    return np.concatenate([np.zeros_like(steps[:1]), np.cumsum(steps, axis=0)])
