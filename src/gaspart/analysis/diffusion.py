"""Diffusion coefficient from the paths of particles.

The uncertainty follows from the scatter between groups of particles, which are treated as independent. If
there are fewer particles than groups, the run is divided into as many blocks as there would be groups. The
error then follows from the scatter between the blocks.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np

from gaspart.analysis import series
from gaspart.analysis.conditions import DISCS, GROUPS
from gaspart.analysis.expected.equilibrium import describe
from gaspart.analysis.motion import axes_of
from gaspart.analysis.observable import LEAST_INTERVALS, Observable, observable, scalar, with_freedom
from gaspart.analysis.observables import require_defined
from gaspart.analysis.paths import Groups, groups_of, stride_of, unwrap_positions
from gaspart.analysis.run import Run, Source, open_run, select_particles
from gaspart.analysis.run_data import FLOW
from gaspart.analysis.statistics import correlated_mean, means_of
from gaspart.errors import SceneError
from gaspart.keys.values import number

LINEAR_FROM = 12.0
"""Lag from which the slope of the mean-squared displacement is examined, in collisions per particle."""
_WITHIN = 2.0
"""Maximum change of the slope, in standard errors, at which the slope counts as constant."""
_SLOW = 0.06
"""Maximum relative change of the slope that is attributed to the slow tail of the correlations."""
_BELOW = 3.0
"""Standard errors below 0 at which a value has a remark."""
_TAIL = 1.0 / (math.sqrt(2.0) - 1.0)
"""Sum of all further changes of the slope divided by its last change, if each lag is twice the previous one.
The missing part of D decreases with the lag as t^(-1/2).
"""


def diffusion_coefficient(
    source: Source,
    start: float | None = None,
    species: int | None = None,
    particles: Sequence[int] | None = None,
    per_axis: bool = False,
    lag: float | None = None,
    about: str = FLOW,
) -> Observable:
    """Measure the diffusion coefficient D from the slope of the mean-squared displacement.

    Slopes are computed between the lags of 6, 12, 24, 48 ... collisions of a particle, as far as the run
    permits. D is the first slope that agrees with the previous slope within two standard errors of their
    difference. If no slope agrees, but the last slope has changed by less than 6 %, only a slow tail is
    missing. D is then the last slope, and the estimated size of the tail is added to the error.

    D at a `lag` is the integral of the velocity autocorrelation up to this lag. This integral exists even if
    D does not exist, for example for discs and between walls.

    The theoretical D of spheres in a periodic cube is the result of Erpenbeck and Wood with the correction of
    Yeh and Hummer; its uncertainty is half of this correction. If a lag is passed, the theoretical value is
    the derivative of the theoretical mean-squared displacement.

    Parameters
    ----------
    particles : sequence of int, optional
        Measure only these particles, as in `mean_squared_displacement`. For fewer than 16 particles, such as
        a single tracer, the run is divided into 16 blocks, and each block must contain the lags.
    per_axis : bool, default False
        Measure D along each periodic axis instead of the mean over axes.
    lag : float, [time], optional
        Return half of the slope of the mean-squared displacement along an axis at this lag. The slope is
        computed from the lags of one frame less and one frame more.
    about : {"flow", "rest"}, default "flow"
        Frame of reference, as in `mean_squared_displacement`. With "rest", momentum does not count as
        conserved.

    Returns
    -------
    Observable
        D in [length^2/time]. The result is a scalar for a periodic container. For a container with walls, or
        with `per_axis`, it has one value for each periodic axis, (axis,). Along an axis with walls
        displacements are bounded, so D exists at a `lag` only; between walls along all axes it has one value
        for each. The variable `lags` contains the first and the last
        lag of the slope.

    Raises
    ------
    SceneError
        If there is neither a periodic axis nor a lag, if the run is too short, or if it has too few frames.
        If no lag is passed, also if the slope still changes at the longest lags, and for discs whose total
        momentum persists for more than 12 collisions. The squared displacement of such discs grows as t ln t.
    """
    with open_run(source, start, about=about) as run:
        require_defined("D", run.scene, species=species, particles=particles, lag=lag, about=about)
        chosen = select_particles(run, species, particles)
        stride = stride_of(run, len(chosen))
        if lag is not None:  # the frames are so close that their slope equals the slope at the lag
            stride = min(stride, max(1, int(number("lag", lag, "must be a time") / (4.0 * run.interval))))
        parts = GROUPS if len(chosen) < GROUPS else 1
        lags = _all_lags(run, stride, parts) if lag is None else _lags_about(run, lag, stride, parts)
        lasting = _lasting_momentum(run, lags[1] * stride)
        if lag is None:
            require_spheres(run, lasting)
        of_mean = lasting & (run.about == FLOW)
        groups = groups_of(run, about=of_mean, chosen=chosen, stride=stride)
        axes = run.periodic if run.periodic.any() else ~run.periodic  # none is periodic: at a lag only
        slopes = _slopes(groups, lags)[..., axes]
        along = axes_of(run, axes)
        if run.periodic.all() and not per_axis:
            slopes, along = slopes.mean(axis=2), {}
        times = groups.interval * np.array(lags)
        if lag is not None:
            values, errors = means_of(slopes[:, -1], groups.sizes)
            attributes = describe("D", run, times)
            attributes["long_name"] += f" at the lag {times.mean():.4g}"
            result = observable("diffusion_coefficient", along, values, errors, **attributes)
            return with_freedom(result, len(slopes) - 1.0)
        last, tail = settled_slope(slopes, groups.sizes)
        values, errors = means_of(slopes[:, last], groups.sizes)
        ends, rate = times[last : last + 2], _rate(run)
        attributes = describe("D", run, None, rate * ends)
        errors = np.hypot(errors, tail)
        result = observable("diffusion_coefficient", along, values, errors, **attributes)
        return _with_lags(with_freedom(result, len(slopes) - 1.0), ends, rate)


def _all_lags(run: Run, stride: int, parts: int) -> tuple[int, ...]:
    """Return the lags, in frames, of 6, 12, 24 ... collisions of a particle, up to half of one of `parts`
    parts.
    """
    return _extend_lags(lags_of_slopes(run, stride, parts), len(run.time) // (stride * parts))


def _extend_lags(lags: tuple[int, ...], frames: int) -> tuple[int, ...]:
    """Extend lags by doubling, up to half of the number of frames."""
    while 4 * lags[-1] <= frames:
        lags = (*lags, 2 * lags[-1])
    return lags


def _with_lags(result: Observable, ends: np.ndarray, rate: float) -> Observable:
    """Add to a result the first and the last lag of its slope."""
    collisions = " to ".join(f"{rate * end:.3g}" for end in ends)
    result.attrs["lags"] = ends
    note = f"by the slope between the lags {ends[0]:.4g} and {ends[1]:.4g}, {collisions} collisions"
    if (result.estimate < -_BELOW * result.error).any():
        note += "; particles that are bound, as in a crystal, have no D: such a slope may be below 0"
    result.attrs["note"] = note
    return result


def _rate(run: Run) -> float:
    """Return the number of collisions of a moving particle per time."""
    return float(series.collisions(run).sum() / (run.time[-1] - run.time[0]))


def _lags_about(run: Run, lag: float, stride: int, parts: int) -> tuple[int, ...]:
    """Return the lags one frame shorter and longer than a lag; SceneError if they are too short, or longer
    than half of a part.
    """
    interval = run.interval * stride
    frames = len(run.time[::stride]) // parts
    longest = (frames // 2 - 1) * interval
    rule = f"must be between {interval:.4g}, the time between frames, and {longest:.4g}: run longer"
    middle = round(lag / interval)
    if not 1 <= middle < frames // 2:
        raise SceneError("lag", lag, rule)
    return middle - 1, middle + 1


def require_spheres(run: Run, lasting: np.ndarray) -> None:
    """Raise SceneError for discs whose total momentum persists along an axis."""
    if run.dimension == 2 and lasting.any():
        raise SceneError("container.lengths", run.scene.container.lengths, DISCS)


def linear_lags(rate: float, interval: float) -> tuple[int, int, int]:
    """Return the lags, in frames, of 6, 12 (to test that the slope is constant) and 24 collisions of a
    particle.
    """
    first, middle, last = (math.ceil(k * LINEAR_FROM / rate / interval) for k in (0.5, 1.0, 2.0))
    return first, middle, last


def lags_of_slopes(run: Run, stride: int = 1, parts: int = 1) -> tuple[int, ...]:
    """Return the `linear_lags` of a run without duplicates."""
    interval = run.interval * stride
    duration, rate = float(run.time[-1] - run.time[0]), _rate(run)
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
    """Return a mask (d,) of the axes along which at least half of the total momentum persists for `lag`
    frames.
    """
    masses = run.masses[run.moving]
    if run.flow_axes:
        momentum = np.einsum("tnd,n->td", run.motion.velocities, masses)
    else:
        parts = (part.velocities[:, run.moving] for _, part in run.parts())
        momentum = np.concatenate([np.einsum("tnd,n->td", part, masses) for part in parts])
    correlation = (momentum[lag:] * momentum[:-lag]).mean(axis=0)
    return run.conserved | (run.periodic & (correlation > 0.5 * (momentum**2).mean(axis=0)))


def _slopes(groups: Groups, lags: tuple[int, ...]) -> np.ndarray:
    """Compute half of the slopes (G, stretches, d) of the squared displacements between consecutive lags."""
    squares = groups.means(
        lambda paths: np.array(
            [((paths[lag:] - paths[: len(paths) - lag]) ** 2).mean(axis=(0, 1)) for lag in lags]
        )
    )
    return 0.5 * np.diff(squares, axis=1) / (groups.interval * np.diff(lags))[:, None]


def settled_slope(slopes: np.ndarray, sizes: Sequence[int] | None = None) -> tuple[int, np.ndarray | float]:
    """Find the first slope that agrees with the previous one, among slopes at increasing lags. The slopes
    have the shape (G, K, ...). Returns the index of the slope and an estimate of the neglected tail. `sizes`
    (G,) are the numbers of particles in the groups. Raises SceneError if the last slopes change by more than
    a slow tail explains.
    """
    for k in range(1, slopes.shape[1]):
        change, error = means_of(slopes[:, k] - slopes[:, k - 1], sizes)
        if (np.abs(change) <= _WITHIN * error).all():
            return k, 0.0
    early, late = (np.atleast_1d(means_of(slopes[:, k], sizes)[0]) for k in (-2, -1))
    beyond = np.abs(np.atleast_1d(change)) - _WITHIN * np.atleast_1d(error) - _SLOW * np.abs(early)
    if (beyond > 0.0).any():
        n = int(np.argmax(beyond))
        rule = (
            f"the slope of the squared displacement, over 2, changes from {early[n]:.3g} to {late[n]:.3g} at "
            "the longest lags of this run: make a longer one, take the value at a lag (--lag), or measure msd"
        )
        raise SceneError("D", "not constant", rule)
    return k, _TAIL * np.abs(change)


# Mutual diffusion: diffusion of two species relative to each other.


def mutual_diffusion(source: Source, start: float | None = None) -> Observable:
    """Measure the Maxwell-Stefan coefficient of mutual diffusion of two species.

    X_1 and X_2 are the mean displacements of the species, and x_1 and x_2 their fractions of the N particles.
    Then

        D_12 = x_1 x_2 N / (2 d) d/dt <|X_1(t) - X_2(t)|^2>,

    Slopes are computed between the lags of 6, 12, 24, 48 ... collisions of a particle. The derivative is the
    first slope that agrees with the previous slope within two standard errors (E. Helfand, Phys. Rev. 119, 1
    (1960)) (R. Krishna and J. M. van Baten, Ind. Eng. Chem. Res. 44, 6939 (2005)). The attribute `lags`
    contains the two lags of this slope. The longest lag is a 32nd of the run, but at least 24 collisions. If
    no slope agrees, but the last slope has changed by less than 6 %, only a slow tail is missing. The
    estimated size of the tail is added to the error. Fick's coefficient is D_12 times the thermodynamic
    factor, which is 1 for species of one size. If the species differ only in their numbers, D_12 is exactly
    the D of a single particle. X_1 - X_2 is a single vector for any number of particles, so only longer runs
    are more accurate.

    Returns
    -------
    Observable
        D_12 in [length^2/time]. The theoretical value is Enskog's first approximation.

    Raises
    ------
    SceneError
        If there are not exactly two species; if there are fixed particles, walls or contacts that lose
        energy; for discs, for which the coefficient does not exist; if frames are too far apart or the run is
        too short; or if the slope still changes at the longest lags.
    """
    with open_run(source, start) as run:
        require_defined("mutual_diffusion", run.scene)
        lags = _extend_lags(lags_of_slopes(run), len(run.time) // GROUPS)
        first, second = (kind.count / run.count for kind in run.scene.species)
        factor = first * second * run.count / (2.0 * run.dimension * run.interval)
        rises = [factor * rise for rise in _rises(_separation(run), lags)]
        last, tail = _settled_rise(rises)
        edges = run.time[: len(rises[last]) + 1]
        result = scalar("mutual_diffusion", rises[last], edges, **describe("mutual_diffusion", run))
        result["mutual_diffusion_error"][...] = np.hypot(result.error, tail)
        return _with_lags(result, run.interval * np.array(lags[last : last + 2]), _rate(run))


def _rises(path: np.ndarray, lags: tuple[int, ...]) -> Iterator[np.ndarray]:
    """Yield the slopes of the squared change of a path between consecutive lags, per frame."""
    for early, late in itertools.pairwise(lags):
        number = len(path) - late
        yield (_squares(path, late) - _squares(path, early)[:number]) / (late - early)


def _settled_rise(rises: list[np.ndarray]) -> tuple[int, float]:
    """Find the first slope that no longer changes, by the criteria of `settled_slope`; return index
    and tail.
    """
    for k in range(1, len(rises)):
        changes = rises[k] - rises[k - 1][: len(rises[k])]
        if len(changes) < LEAST_INTERVALS:  # `scalar` then rejects the run
            return k, 0.0
        change = correlated_mean(changes, LEAST_INTERVALS).estimate
        if abs(change.deviation) <= _WITHIN:
            return k, 0.0
    early, late = (float(rise.mean()) for rise in rises[-2:])
    if abs(change.value) > _WITHIN * change.error + _SLOW * abs(early):
        rule = f"changes from {early:.3g} to {late:.3g} at the longest lags of this run: make a longer one"
        raise SceneError("mutual_diffusion", "not constant", rule)
    return k, _TAIL * abs(change.value)


def _separation(run: Run) -> np.ndarray:
    """Compute X_1 - X_2, the separation of the centres of two species, shape (T, d)."""
    members = [run.species == kind for kind in (0, 1)]
    centres = [[path[chosen].mean(axis=0) for chosen in members] for path in unwrap_positions(run)]
    return np.array([first - second for first, second in centres])


def _squares(path: np.ndarray, lag: int) -> np.ndarray:
    """Compute the squared change over a lag for each time origin, shape (T - lag,)."""
    return ((path[lag:] - path[:-lag]) ** 2).sum(axis=1)
