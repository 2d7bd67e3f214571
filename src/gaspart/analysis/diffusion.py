"""The diffusion coefficient, from the paths of particles.

Its uncertainty is the scatter of groups of particles, which are taken as independent, or, of fewer particles
than groups, that of as many stretches of the run.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from gaspart.analysis import series
from gaspart.analysis.conditions import DISCS, GROUPS
from gaspart.analysis.expected.described import described
from gaspart.analysis.flow import FLOW
from gaspart.analysis.motion import Groups, axes_of, groups_of, stride_of
from gaspart.analysis.observable import Observable, observable
from gaspart.analysis.observables import require_defined
from gaspart.analysis.run import Run, Source, open_run, selected
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.keys.values import number

LINEAR_FROM = 12.0
"""Collisions per particle, from which on the mean-squared displacement grows evenly, if there is a D."""
_CONSTANT = 0.06  # of a slope: what it may change, as by the slow decay of correlations in a fluid
_SIGNIFICANT = 4.0  # standard errors of 15 degrees of freedom: exceeded by chance once in a thousand


def diffusion_coefficient(
    source: Source,
    start: float | None = None,
    species: int | None = None,
    particles: Sequence[int] | None = None,
    per_axis: bool = False,
    lag: float | None = None,
    about: str = FLOW,
) -> Observable:
    """D in length^2 / time, by the rise of the mean-squared displacement from 12 to 24 collisions a particle.

    Of a periodic container the mean over axes, a scalar; of one with walls, or `per_axis`, that along each
    periodic axis, (axis,): across walls displacements are bounded, and there is none. species, particles,
    about, and the condition of zero momentum: as in `mean_squared_displacement`; of fewer than 16 particles,
    such as one tracer, each of 16 stretches of the run must be long enough.

    lag: the time at which half of the slope of the mean-squared displacement along an axis is taken instead,
    from the frames before and after it. That is the integral of the velocity autocorrelation until then,
    which exists where D does not: of discs, and between walls.

    Theory: of spheres in a periodic cube, Erpenbeck and Wood's with the shift of Yeh and Hummer, half of
    which is its uncertainty; at a lag that of the mean-squared displacement. Raises SceneError without a
    periodic axis; for runs that are too short, or have too few frames; and, without a lag, for discs whose
    momentum lasts longer than these collisions, so that their squared displacement grows like t ln t, and
    where the slope from 6 to 12 collisions is another one, so that there is no D.
    """
    with open_run(source, start, about=about) as run:
        require_defined("D", run.scene, species=species, particles=particles, lag=lag, about=about)
        chosen = selected(run, species, particles)
        stride = stride_of(run, len(chosen))
        if lag is not None:  # frames so near that the slope is that at the lag
            stride = min(stride, max(1, int(number("lag", lag, "must be a time") / (4.0 * run.interval))))
        parts = GROUPS if len(chosen) < GROUPS else 1
        lags = lags_of_slopes(run, stride, parts) if lag is None else _lags_about(run, lag, stride, parts)
        lasting = _lasting_momentum(run, lags[1] * stride)
        if lag is None:
            require_spheres(run, lasting)
        of_mean = lasting & (run.about == FLOW)
        groups = groups_of(run, about=of_mean, chosen=chosen, stride=stride)
        slopes = _slopes(groups, lags)[..., run.periodic]
        along = axes_of(run, run.periodic)
        if run.periodic.all() and not per_axis:
            slopes, along = slopes.mean(axis=2), {}
        if lag is None:
            _require_constant(slopes, groups.sizes)
        values, errors = means_of(slopes[:, -1], groups.sizes)
        ends = None if lag is None else groups.interval * np.array(lags)
        return observable("diffusion_coefficient", along, values, errors, **_about(run, ends))


def _about(run: Run, ends: np.ndarray | None) -> dict[str, Any]:
    """Units, label and theory, of the slope between the lags `ends` (2,) if they are given."""
    about = described("D", run, ends)
    if ends is not None:
        about["long_name"] += f" at the lag {ends.mean():.4g}"
    return about


def _lags_about(run: Run, lag: float, stride: int, parts: int) -> tuple[int, int]:
    """The numbers of frames before and after a lag. Raises SceneError for one that is shorter than the time
    between frames, or longer than half of each of the equal parts of a run."""
    interval = run.interval * stride
    frames = len(run.time[::stride]) // parts
    longest = (frames // 2 - 1) * interval
    rule = f"must be between {interval:.4g}, the time between frames, and {longest:.4g}"
    middle = round(lag / interval)
    if not 1 <= middle < frames // 2:
        raise SceneError("lag", lag, rule)
    return middle - 1, middle + 1


def require_spheres(run: Run, lasting: np.ndarray) -> None:
    """Raise SceneError for discs whose total momentum lasts along an axis."""
    if run.dimension == 2 and lasting.any():
        raise SceneError("container.lengths", run.scene.container.lengths, DISCS)


def linear_lags(rate: float, interval: float) -> tuple[int, int, int]:
    """After how many frames, `interval` apart, a particle has had 6, 12 and 24 collisions: before the window
    of D, at its start and at its end. rate: its collisions per time."""
    first, middle, last = (math.ceil(k * LINEAR_FROM / rate / interval) for k in (0.5, 1.0, 2.0))
    return first, middle, last


def lags_of_slopes(run: Run, stride: int = 1, parts: int = 1) -> tuple[int, int, int]:
    """The `linear_lags` of a run, of which every so many frames are taken, no two of them equal; parts: that
    a run has, in each of which they must be. Raises SceneError for too few frames."""
    interval = run.interval * stride
    duration = float(run.time[-1] - run.time[0])
    rate = float(series.collisions(run).sum()) / duration
    if rate * (duration / parts + interval) < 4.0 * LINEAR_FROM:
        rule = f"must cover {parts * 4.0 * LINEAR_FROM:g} collisions of a particle or more"
        raise SceneError("duration", duration, rule)
    first, middle, last = linear_lags(rate, interval)
    middle = max(middle, first + 1)
    last = max(last, middle + 1)
    if len(run.time) // parts < 2 * last * stride:
        short = 0.5 * LINEAR_FROM
        rule = f"is too long: frames {short / rate:.3g} apart, the time of {short:g} collisions, suffice"
        raise SceneError("sample_interval", interval, rule)
    return first, middle, last


def _lasting_momentum(run: Run, lag: int) -> np.ndarray:
    """(d,) along which axes the total momentum of the moving particles is kept for so many frames: where it
    is conserved, and where more than half of it is left, as with a few obstacles among many particles."""
    velocities = run.motion.velocities if run.flow_axes else run.velocities[:, run.moving]
    momentum = np.einsum("tnd,n->td", velocities, run.masses[run.moving])
    left = (momentum[lag:] * momentum[:-lag]).mean(axis=0)
    return run.conserved | (run.periodic & (left > 0.5 * (momentum**2).mean(axis=0)))


def _slopes(groups: Groups, lags: tuple[int, ...]) -> np.ndarray:
    """(G, stretches, d) of the squared displacements between consecutive lags, over two."""
    squares = np.array(
        [
            [((path[lag:] - path[: len(path) - lag]) ** 2).mean(axis=(0, 1)) for lag in lags]
            for path in groups.paths
        ]
    )
    return 0.5 * np.diff(squares, axis=1) / (groups.interval * np.diff(lags))[:, None]


def _require_constant(slopes: np.ndarray, sizes: list[int]) -> None:
    """Raise SceneError if the slope of the second stretch differs from that of the first, (G, 2, ...), by
    more than `_CONSTANT` of it, beyond its error. sizes (G,): numbers of particles."""
    early, late = np.atleast_2d(means_of(slopes, sizes)[0].T).T
    change, error = means_of(slopes[:, 1] - slopes[:, 0], sizes)
    beyond = np.abs(change) - _CONSTANT * np.abs(early) - _SIGNIFICANT * error
    if (beyond > 0.0).any():
        n = int(np.argmax(beyond))
        rule = (
            f"there is none: the slope of the squared displacement, over 2, changes from {early[n]:.3g} "
            f"before {LINEAR_FROM:g} collisions to {late[n]:.3g} after them; measure msd"
        )
        raise SceneError("D", "not constant", rule)
