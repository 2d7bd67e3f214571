"""Observables from the paths and velocities of particles: displacement, diffusion, velocity correlation.

Uncertainties are the scatter of groups of particles, which are taken as independent.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from gaspart import theory
from gaspart.analysis.correlations import autocorrelation, correlate
from gaspart.analysis.observable import Observable, observable
from gaspart.analysis.run import Run, Source, measured, selected
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.scene.validation import count_of

GROUPS = 16
"""Number of groups of particles, whose scatter gives the uncertainty."""
MOST_FRAMES = 1000
"""That are correlated; of a longer run, every second or third ..."""
LINEAR_FROM = 12.0
"""Collisions per particle, from which on the mean-squared displacement grows evenly, if there is a D."""
_CONSTANT = 0.06  # of a slope: what it may change, as by the slow decay of correlations in a fluid
_SIGNIFICANT = 4.0  # standard errors of 15 degrees of freedom: exceeded by chance once in a thousand
_FARTHEST = 0.45  # of a side: the longest way between frames by which a particle is followed


@dataclass(frozen=True)
class _Groups:
    """Paths and velocities (G, T, n, d) of groups of moving particles, at even times, `interval` apart."""

    paths: list[np.ndarray]
    velocities: list[np.ndarray]
    interval: float


def mean_squared_displacement(
    source: Source,
    lags: int | None = None,
    start: float | None = None,
    species: int | None = None,
    particles: Sequence[int] | None = None,
    per_axis: bool = False,
) -> Observable:
    """<|r(t) - r(0)|^2> over moving particles and time origins, (lag,), in length^2.

    source: a trajectory, by its path or open, or a simulation; lags: their number (by default half of the
    frames); start: the time from which frames count (by default a quarter of the run). Along axes on which
    the total momentum is conserved it is that about the centre of mass, times N / (N - 1). species,
    particles: of one species, by its number in the scene (single particles have the number after the last),
    or of these particles only; of fewer than 16 the error is the scatter of as many stretches of the run.
    per_axis: that along each axis instead of their sum, (axis, lag). Theory: that of Enskog's diffusion
    coefficient and an exponential velocity correlation. Raises SceneError for fewer than 16 moving particles,
    unless they are selected, frames at uneven times, and frames too far apart to follow particles across
    periodic faces.
    """
    with measured(source, start) as run:
        groups = _groups(run, chosen=_chosen(run, species, particles))
        number = _lags(groups, lags)
        axes = [slice(k, k + 1) for k in range(run.dimension)] if per_axis else [slice(None)]
        found = np.array(
            [
                [correlate(path[..., k], velocity[..., k], groups.interval, number).msd for k in axes]
                for path, velocity in zip(groups.paths, groups.velocities, strict=True)
            ]
        )
        time = groups.interval * np.arange(number)
        values, errors = means_of(found if per_axis else found[:, 0])
        expected: dict[str, Any] = {}
        if gas := run.moving_fluid:
            curve = theory.enskog_mean_squared_displacement(time, **gas.parameters)
            curve = curve / run.dimension if per_axis else curve
            expected = {"theory": (curve, math.nan), "source": "Enskog, exponential velocity correlation"}
        about: dict[str, Any] = {"units": "length^2", "long_name": "mean-squared displacement", **expected}
        along = {**(_axes(run) if per_axis else {}), **_lag(time)}
        return observable("mean_squared_displacement", along, values, errors, **about)


def velocity_autocorrelation(
    source: Source,
    lags: int | None = None,
    start: float | None = None,
    species: int | None = None,
    particles: Sequence[int] | None = None,
) -> Observable:
    """<v(0) . v(t)> / d over moving particles and time origins, (lag,), in length^2 / time^2.

    Arguments as of `mean_squared_displacement`. Theory: (k_B T / m) exp(-2 nu t / d), nu the collision rate:
    exact at short times, without the long-time tail. Raises SceneError for fewer than 16 moving particles,
    and frames at uneven times.
    """
    with measured(source, start) as run:
        groups = _groups(run, paths=False, chosen=_chosen(run, species, particles))
        number = _lags(groups, lags)
        found = np.array([autocorrelation(velocity, number) for velocity in groups.velocities])
        time = groups.interval * np.arange(number)
        values, errors = means_of(found)
        expected: dict[str, Any] = {}
        if gas := run.moving_fluid:
            rate = float(theory.velocity_decay_rate(**gas.parameters))
            curve = gas.temperature / gas.mass * np.exp(-rate * time)
            expected = {"theory": (curve, math.nan), "source": "Enskog, exact initial decay"}
        about: dict[str, Any] = {
            "units": "length^2 / time^2",
            "long_name": "velocity autocorrelation",
            **expected,
        }
        return observable("velocity_autocorrelation", _lag(time), values, errors, **about)


def diffusion_coefficient(
    source: Source, start: float | None = None, species: int | None = None, per_axis: bool = False
) -> Observable:
    """D in length^2 / time, by the rise of the mean-squared displacement from 12 to 24 collisions a particle.

    Of a periodic container the mean over axes, a scalar; of one with walls, or `per_axis`, that along each
    periodic axis, (axis,): across walls displacements are bounded, and there is none. Arguments and
    condition of zero momentum as in `mean_squared_displacement`; a species needs 16 particles that move.
    Theory: of spheres in a periodic cube, Erpenbeck and Wood's with the shift of Yeh and Hummer, half of
    which is its uncertainty.

    Raises SceneError without a periodic axis; for discs whose momentum lasts longer than these collisions, so
    that their squared displacement grows like t ln t; where the slope from 6 to 12 collisions is another one,
    so that there is no D; and for runs that are too short, or have too few frames.
    """
    with measured(source, start) as run:
        if not run.periodic.any():
            rule = "has no periodic axis: displacements between walls are bounded, and there is no D"
            raise SceneError("container.boundary", run.scene.container.boundary, rule)
        require_spheres(run, run.conserved)
        chosen = _chosen(run, species, None)
        if len(chosen) < GROUPS:
            raise SceneError("species", species, f"an error needs {GROUPS} moving particles or more")
        stride = _stride(run)
        lags = lags_of_slopes(run, stride)
        lasting = _lasting_momentum(run, lags[1] * stride)
        require_spheres(run, lasting)
        slopes = _slopes(_groups(run, about=lasting, chosen=chosen), lags)[..., run.periodic]
        along = _axes(run, run.periodic)
        if run.periodic.all() and not per_axis:
            slopes, along = slopes.mean(axis=2), {}
        _require_constant(slopes)
        values, errors = means_of(slopes[:, 1])
        about: dict[str, Any] = {
            "units": "length^2 / time",
            "long_name": "diffusion coefficient D",
            **_theory_of_d(run),
        }
        return observable("diffusion_coefficient", along, values, errors, **about)


def _chosen(run: Run, species: int | None, particles: Sequence[int] | None) -> np.ndarray:
    """`selected`; of all particles 16 or more must move."""
    if species is None and particles is None:
        _require_groups(run)
    return selected(run, species, particles)


def _require_groups(run: Run) -> None:
    """Raise SceneError for too few moving particles."""
    count = int(run.moving.sum())
    if count < GROUPS:
        raise SceneError("count", count, f"an error needs {GROUPS} moving particles or more")


def require_spheres(run: Run, lasting: np.ndarray) -> None:
    """Raise SceneError for discs whose total momentum lasts along an axis."""
    if run.dimension == 2 and lasting.any():
        rule = "discs have no diffusion coefficient: their squared displacement grows like t ln t"
        raise SceneError("container.lengths", run.scene.container.lengths, rule)


def linear_lags(rate: float, interval: float) -> tuple[int, int, int]:
    """After how many frames, `interval` apart, a particle has had 6, 12 and 24 collisions: before the window
    of D, at its start and at its end. rate: its collisions per time."""
    first, middle, last = (math.ceil(k * LINEAR_FROM / rate / interval) for k in (0.5, 1.0, 2.0))
    return first, middle, last


def lags_of_slopes(run: Run, stride: int = 1) -> tuple[int, int, int]:
    """The `linear_lags` of a run, of which every so many frames are taken, no two of them equal. Raises
    SceneError for too few frames."""
    interval = float(np.diff(run.time).mean()) * stride
    collisions = float(run.increments("collisions").sum())
    duration = float(run.time[-1] - run.time[0])
    rate = 2.0 * collisions / (run.moving.sum() * duration)
    if rate * (duration + interval) < 4.0 * LINEAR_FROM:
        rule = f"must cover {4.0 * LINEAR_FROM:g} collisions of a particle or more"
        raise SceneError("duration", duration, rule)
    first, middle, last = linear_lags(rate, interval)
    middle = max(middle, first + 1)
    last = max(last, middle + 1)
    if len(run.time) < 2 * last * stride:
        short = 0.5 * LINEAR_FROM
        rule = f"is too long: frames {short / rate:.3g} apart, the time of {short:g} collisions, suffice"
        raise SceneError("sample_interval", interval, rule)
    return first, middle, last


def _lasting_momentum(run: Run, lag: int) -> np.ndarray:
    """(d,) along which axes the total momentum of the moving particles is kept for so many frames: where it
    is conserved, and where more than half of it is left, as with a few obstacles among many particles."""
    momentum = np.einsum("tnd,n->td", run.velocities[:, run.moving], run.masses[run.moving])
    left = (momentum[lag:] * momentum[:-lag]).mean(axis=0)
    return run.conserved | (run.periodic & (left > 0.5 * (momentum**2).mean(axis=0)))


def _slopes(groups: _Groups, lags: tuple[int, ...]) -> np.ndarray:
    """(G, stretches, d) of the squared displacements between consecutive lags, over two."""
    squares = np.array(
        [[((path[lag:] - path[:-lag]) ** 2).mean(axis=(0, 1)) for lag in lags] for path in groups.paths]
    )
    return 0.5 * np.diff(squares, axis=1) / (groups.interval * np.diff(lags))[:, None]


def _require_constant(slopes: np.ndarray) -> None:
    """Raise SceneError if the slope of the second stretch differs from that of the first, (G, 2, ...), by
    more than `_CONSTANT` of it, beyond its error."""
    early, late = np.atleast_2d(slopes.mean(axis=0).T).T
    change, error = means_of(slopes[:, 1] - slopes[:, 0])
    beyond = np.abs(change) - _CONSTANT * np.abs(early) - _SIGNIFICANT * error
    if (beyond > 0.0).any():
        n = int(np.argmax(beyond))
        rule = (
            f"there is none: the slope of the squared displacement, over 2, changes from {early[n]:.3g} "
            f"before {LINEAR_FROM:g} collisions to {late[n]:.3g} after them; measure msd"
        )
        raise SceneError("D", "not constant", rule)


def _theory_of_d(run: Run) -> dict[str, Any]:
    gas, sides = run.moving_fluid, run.scene.container.lengths
    if gas is None or gas.dimension == 2 or np.ptp(sides) > 1e-6 * sides[0]:
        return {}
    if gas.packing_fraction > theory.ERPENBECK_WOOD_HIGHEST:
        return {}
    expected = theory.diffusion_in_cube(gas.packing_fraction, sides[0], **gas.particle)
    return {"theory": expected, "source": "Erpenbeck and Wood, Yeh and Hummer"}


def _axes(run: Run, chosen: np.ndarray | slice = slice(None)) -> dict[str, Any]:
    return {"axis": (np.array(list("xyz"[: run.dimension]))[chosen], {"long_name": "axis"})}


def _lag(time: np.ndarray) -> dict[str, Any]:
    return {"lag": (time, {"units": "time", "long_name": "lag"})}


def _lags(groups: _Groups, lags: int | None) -> int:
    frames = len(groups.velocities[0])
    number = max(2, frames // 2) if lags is None else count_of("lags", lags, least=2)
    if number > frames:
        raise SceneError("lags", lags, f"there are {frames} frames")
    return number


def _groups(
    run: Run, paths: bool = True, about: np.ndarray | None = None, chosen: np.ndarray | None = None
) -> _Groups:
    """The chosen ones of the moving particles in groups, or, of fewer than `GROUPS`, as many stretches of the
    run, about the centre of mass along the axes `about` (d,), by default those along which its velocity is
    conserved.

    There its square for a particle of mass m is 1 - m / M of that without this condition, M the mass of all.
    """
    moving, stride = run.moving, _stride(run)
    steps = np.diff(run.time)
    if np.ptp(steps) > 1e-6 * steps.mean():
        raise SceneError("time", "frames at uneven times", "a correlation needs even ones")
    about = run.conserved if about is None else about
    masses = run.masses[moving]
    chosen = np.arange(len(masses)) if chosen is None else chosen
    others = masses.sum() - masses[chosen]
    if about.any() and not (others > 0.0).all():
        raise SceneError("count", len(masses), "a single particle keeps its velocity")
    free = np.where(about, np.sqrt(masses.sum() / np.where(others > 0.0, others, 1.0))[:, None], 1.0)

    def parts(values: np.ndarray) -> list[np.ndarray]:
        centre = np.einsum("tnd,n->td", values, masses) / masses.sum()
        motion = free * (values[:, chosen] - np.where(about, centre, 0.0)[:, None])
        if len(chosen) >= GROUPS:
            return [motion[:, part] for part in _alike(run.species[moving][chosen])]
        length = len(motion) // GROUPS
        if length < 4:
            rule = f"an error of fewer than {GROUPS} particles needs {4 * GROUPS} frames or more"
            raise SceneError("frames", len(motion), rule)
        return [motion[first : first + length] for first in range(0, GROUPS * length, length)]

    return _Groups(
        paths=parts(unwrapped(run)[::stride, moving]) if paths else [],
        velocities=parts(run.velocities[::stride, moving]),
        interval=float(steps.mean()) * stride,
    )


def _alike(species: np.ndarray) -> list[np.ndarray]:
    """Which particles, of these species (M,), are in each group. Groups of a mixture have the same
    composition: else the difference between species, which no longer run reduces, would be their scatter."""
    if np.ptp(species) == 0:
        return np.array_split(np.arange(len(species)), GROUPS)
    order = np.argsort(species, kind="stable")
    return [order[first::GROUPS] for first in range(GROUPS)]


def _stride(run: Run) -> int:
    """The number of frames of which one is taken."""
    return -(-len(run.time) // MOST_FRAMES)


def unwrapped(run: Run) -> np.ndarray:
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
