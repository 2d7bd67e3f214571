"""The diffusion coefficient, from the paths of particles.

Its uncertainty is the scatter of groups of particles, which are taken as independent.
"""

from __future__ import annotations

import math

import numpy as np

from gaspart.analysis.conditions import DISCS
from gaspart.analysis.expected.described import described
from gaspart.analysis.motion import Groups, axes_of, groups_of, stride_of
from gaspart.analysis.observable import Observable, observable
from gaspart.analysis.observables import require_defined
from gaspart.analysis.run import Run, Source, open_run, selected
from gaspart.analysis.statistics import means_of
from gaspart.errors import SceneError
from gaspart.scene.faces import mean_velocity

LINEAR_FROM = 12.0
"""Collisions per particle, from which on the mean-squared displacement grows evenly, if there is a D."""
_CONSTANT = 0.06  # of a slope: what it may change, as by the slow decay of correlations in a fluid
_SIGNIFICANT = 4.0  # standard errors of 15 degrees of freedom: exceeded by chance once in a thousand


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
    with open_run(source, start) as run:
        require_defined("D", run.scene, species=species)
        chosen = selected(run, species, None)
        stride = stride_of(run)
        lags = lags_of_slopes(run, stride)
        lasting = _lasting_momentum(run, lags[1] * stride)
        require_spheres(run, lasting)
        groups = groups_of(run, about=lasting, chosen=chosen)
        slopes = _slopes(groups, lags)[..., run.periodic]
        along = axes_of(run, run.periodic)
        if run.periodic.all() and not per_axis:
            slopes, along = slopes.mean(axis=2), {}
        _require_constant(slopes, groups.sizes)
        values, errors = means_of(slopes[:, 1], groups.sizes)
        return observable("diffusion_coefficient", along, values, errors, **described("D", run))


def require_spheres(run: Run, lasting: np.ndarray) -> None:
    """Raise SceneError for discs whose total momentum lasts along an axis."""
    if run.dimension == 2 and lasting.any():
        raise SceneError("container.lengths", run.scene.container.lengths, DISCS)


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
    velocities = run.velocities[:, run.moving] - np.array(mean_velocity(run.scene))
    momentum = np.einsum("tnd,n->td", velocities, run.masses[run.moving])
    left = (momentum[lag:] * momentum[:-lag]).mean(axis=0)
    return run.conserved | (run.periodic & (left > 0.5 * (momentum**2).mean(axis=0)))


def _slopes(groups: Groups, lags: tuple[int, ...]) -> np.ndarray:
    """(G, stretches, d) of the squared displacements between consecutive lags, over two."""
    squares = np.array(
        [[((path[lag:] - path[:-lag]) ** 2).mean(axis=(0, 1)) for lag in lags] for path in groups.paths]
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
