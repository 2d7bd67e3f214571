"""Statistical checks: independent samples, speeds, contact values and diffusion of a trajectory.

Velocities change by collisions, and positions change by flights. So the relaxation of velocities is measured
by the number of collisions, and the relaxation of positions by the distance that particles have moved. Both
measures require neither times nor a law of motion, so files of all programs can be used.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from gaspart import theory
from gaspart.analysis.diffusion import linear_lags, settled_slope
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.expected.equilibrium import with_discretisation
from gaspart.analysis.expected.transport import diffusion_in_cube
from gaspart.analysis.flow import sum_squares
from gaspart.analysis.pairs import pair_counts
from gaspart.analysis.statistics import histogram_chi_square, mean_of
from gaspart.inspection.frames import Frames
from gaspart.inspection.verdict import Check, compare_with_theory
from gaspart.scene.facts import Gas
from gaspart.scene.sizes import ball_volume
from gaspart.theory.bulk import EXACT, collision_rate
from gaspart.theory.diffusion import ERPENBECK_WOOD_HIGHEST
from gaspart.theory.speeds import kurtosis_scatter

UNEVEN = 20.0
"""Power of a long wave above which a gas is not uniform. It is 1 on average for independent particles, and
exceeds the limit by chance once in 1e8.
"""
_UNEVEN_MEAN, _MEAN_OF = 6.0, 20
"""The same for the mean over so many frames, which finds waves that oscillate while they decay. In 240 runs
in equilibrium the highest mean was 5.3.
"""
_CHANGED = 0.05  # minimum change of a velocity that counts, in root-mean-square speeds


def count_collisions(frames: Frames) -> np.ndarray:
    """Compute a lower bound of the collisions (T,) per particle since the first frame. Between consecutive
    frames the bound is the smaller of two numbers. The first is -ln of the fraction of particles whose
    velocity has not changed (except by reflections at walls). The second is -(d/2) ln of the correlation of
    velocities, which decays as exp(-2s/d) in s collisions. The first number is too large with a thermostat,
    which slightly changes all velocities; the second is too large with walls.
    """
    velocities = frames.velocities
    assert velocities is not None, "requires velocities"
    square = frames.squares.total
    least = 0.5 / frames.count
    small = np.maximum(_CHANGED**2 * square / frames.count, np.finfo(float).tiny)
    changed, products = np.zeros(len(velocities) - 1), np.zeros(len(velocities) - 1)
    for n, (before, after) in enumerate(pairwise(velocities)):
        apart = np.zeros(frames.count)
        for v, w, periodic in zip(before.T, after.T, frames.periodic, strict=True):
            apart += (w - v if periodic else np.abs(w) - np.abs(v)) ** 2
        changed[n] = (apart > small[n + 1]).mean()
        products[n] = np.vdot(before, after)
    correlation = products / np.maximum(np.sqrt(square[1:] * square[:-1]), np.finfo(float).tiny)
    unhit = -np.log(np.clip(1.0 - changed, least, 1.0))
    kept = -0.5 * frames.dimension * np.log(np.clip(correlation, least, 1.0))
    return np.concatenate([[0.0], np.cumsum(np.minimum(unhit, kept))]) + 0.0  # avoids -0


def independent(times: np.ndarray, rate: float) -> float:
    """Compute the number of independent samples in a mean over frames at `times`. If the correlation of a
    property decays as exp(-rate t), the number is 1 / mean of exp(-rate |t_i - t_j|) over all pairs i, j.
    """
    total, before = 0.0, 0.0  # sum of the correlations of earlier frames with this one
    for decay in np.exp(-rate * np.diff(times, prepend=times[0])):
        before *= decay
        total += 1.0 + 2.0 * before
        before += 1.0
    return len(times) ** 2 / total


def decorrelated_frames(paths: Iterable[np.ndarray], distance: float, first: int = 0) -> list[int]:
    """Return frames from `first` on, between which particles have moved by `distance`. The root mean square
    displacement between consecutive returned frames is at least this distance. `paths` are the displacements
    (N, d) since frame 0 in each frame.
    """
    chosen, before = list[int](), np.zeros(0)
    for n, moved in enumerate(paths):
        if n == first or (n > first and sum_squares(moved - before).mean() >= distance**2):
            chosen.append(n)
            before = moved
    return chosen


def first_relaxed_frame(frames: Frames) -> int | None:
    """Return the first frame in which the rms displacement is the distance between neighbours, or None."""
    moved = (sum_squares(path).mean() for path in frames.paths())
    return next((n for n, square in enumerate(moved) if square >= frames.spacing**2), None)


def describe_motion(frames: Frames) -> str:
    """Return the reason why positions have not relaxed."""
    moved = deque(frames.paths(), maxlen=1)[0]
    there, distance = math.sqrt(float(sum_squares(moved).mean())), frames.spacing
    return (
        f"particles must move by {distance:.3g} after the first frame, to relax; they have moved {there:.2g}"
    )


def is_uneven(frames: Frames, numbers: Sequence[int] | np.ndarray, energy: bool = False) -> bool:
    """Return True if the density, or that of the thermal energy, has long waves in the frames `numbers`."""
    chosen = np.unique(np.linspace(0, len(numbers) - 1, _MEAN_OF).astype(int))
    powers = [
        density_modulation(frames, n, frames.peculiar_squares(n) if energy else None)
        for n in np.asarray(numbers)[chosen]
    ]
    return bool(max(powers[0], powers[-1]) > UNEVEN or np.mean(powers) > _UNEVEN_MEAN)


def density_modulation(frames: Frames, n: int, of: np.ndarray | None = None) -> float:
    """Compute the largest power of the two longest density waves along each axis. The power is computed for
    the particle density in frame n. If `of` (N,) is passed, it is computed for the density of this property
    minus the mean of the property.
    """
    weights = np.ones(frames.count) if of is None else of - of.mean()
    total = float((weights**2).sum())
    if total == 0.0:
        return 0.0
    largest = 0.0
    for x, side, periodic in zip(frames.positions[n].T, frames.lengths, frames.periodic, strict=True):
        phase = np.pi * (2.0 if periodic else 1.0) * x / side
        cosine, sine = np.cos(phase), np.sin(phase)
        # longest wave, and half its length by the double-angle formulas
        waves = [cosine @ weights, (2.0 * cosine**2 - 1.0) @ weights]
        others = [sine @ weights, (2.0 * sine * cosine) @ weights]
        powers = np.square(waves) + np.square(others) if periodic else 2.0 * np.square(waves)
        largest = max(largest, float(powers.max()))
    return largest / total


# Checks of speeds against Maxwell's distribution and its kurtosis, after enough collisions.


SPEEDS = "speed law", "kurtosis of speeds"
"""Names of the checks of speeds."""
RESIDUE = 0.25
"""Deviation of the kurtosis that may remain from the initial state, divided by its scatter in one frame."""
RARE = 1e-4
"""Probability below which the check of the distribution fails."""
_MOST_SKEWED = 1.0  # maximum skewness of a mean at which its probability is sufficiently well known


def why_not_speeds(frames: Frames) -> str | None:
    """Return the reason why speeds cannot be checked, or None."""
    if frames.velocities is None:
        return frames.no_velocities
    if not frames.squares.moving.any() and not any(np.any(each) for each in frames.velocities):
        return "all velocities are 0"
    if not np.isfinite(frames.squares.total).all() and not all(
        np.isfinite(each).all() for each in frames.velocities
    ):
        return "not all velocities are finite"
    if frames.gas is None:
        return "particles differ, or are moved by more than elastic contacts"
    if frames.part:
        return "the file has some of the particles only"
    if frames.count < 2:
        return "one particle has no distribution"
    return None


def judge_speeds(frames: Frames) -> list[Check]:
    """Check the distribution of speeds in the last frame, and its kurtosis in all relaxed frames. A deviation
    of the kurtosis decays with the slowest rate of the homogeneous Boltzmann equation. The test of Maxwell's
    distribution also requires relaxed positions. For spheres at a packing fraction of 0.3 that were inserted
    at random with Maxwellian velocities, the kurtosis deviates for some time: by -0.0044(5) after 6
    collisions per particle, -0.0029(5) after 10 and -0.0003(13) after 15. After 15 collisions the spheres
    have moved by the distance between neighbours. With the same velocities but relaxed positions, the first
    deviation is -0.0006(7).
    """
    names = SPEEDS
    if reason := why_not_speeds(frames):
        return [Check(name, None, reason) for name in names]
    series, expected = frames.squares.kurtosis, _expected_kurtosis(frames)
    clock, rate = count_collisions(frames), theory.KURTOSIS_RELAXATION_RATE[frames.dimension]
    scatter, skewness = kurtosis_scatter(frames.dimension, frames.count)
    excess = max(abs(series[0] - expected), scatter)
    relaxation = math.log(excess / (RESIDUE * scatter)) / rate
    if clock[-1] < relaxation:
        reason = (
            f"needs {relaxation:.3g} collisions of a particle after the first frame, to relax; there are"
            f" {clock[-1]:.3g}"
        )
        return [Check(name, None, reason) for name in names]
    moved = first_relaxed_frame(frames)
    if moved is None:
        return [Check(name, None, describe_motion(frames)) for name in names]
    first = max(int(np.argmax(clock >= relaxation)), moved)
    if is_uneven(frames, range(first, len(series)), energy=True):
        return [Check(name, None, "the temperature is not uniform: not relaxed") for name in names]
    samples = independent(clock[first:], rate)
    kurtosis = Estimate(series[first:].mean(), scatter / math.sqrt(samples))
    skewness /= math.sqrt(samples)
    if skewness > _MOST_SKEWED:
        text = f"{samples:.2g} independent samples of {frames.count} particles are too few"
        return [_law(frames), Check(names[1], None, text)]
    basis = f"Maxwell's; {samples:.3g} independent samples of {frames.count} particles"
    deviation = _normal((kurtosis.value - expected) / kurtosis.error, skewness)
    return [_law(frames), compare_with_theory(names[1], kurtosis, Estimate(expected), basis, deviation)]


def _law(frames: Frames) -> Check:
    """Check the speeds in the last frame against Maxwell's distribution at their own temperature."""
    bins = min(30, frames.count // 10)
    if bins < 4:
        return Check("speed law", None, f"{frames.count} particles are too few for a histogram")
    square = frames.peculiar_squares(-1)
    temperature = float(frames.temperatures[-1])
    result = histogram_chi_square(
        np.sqrt(square), lambda v: theory.maxwell_cdf(v, frames.dimension, temperature), bins
    )
    text = f"chi-square {result.chi_square:.3g} of {result.degrees_of_freedom} about Maxwell's, last frame"
    return Check("speed law", result.p_value > RARE, f"{text} (p = {result.p_value:.2g})")


def _expected_kurtosis(frames: Frames) -> float:
    """Compute the equilibrium kurtosis at fixed energy (exact). As in `theory.kurtosis`, except that <v_k^2>
    along a periodic axis is reduced by the factor 1 - 1/N.
    """
    parts = np.where(frames.periodic, 1.0 - 1.0 / frames.count, 1.0)
    freedoms = frames.count * parts.sum()
    return float((1.0 + 2.0 * (parts**2).sum() / parts.sum() ** 2) * freedoms / (freedoms + 2.0))


def _normal(deviation: float, skewness: float) -> float:
    """Return the normal deviation with the same probability as a deviation of a skewed distribution. Above
    the mean the gamma distribution is used (Wilson and Hilferty, Proc. Natl. Acad. Sci. 17, 684 (1931)).
    """
    if deviation <= 0.0:
        return deviation
    return 6.0 / skewness * (math.cbrt(1.0 + 0.5 * skewness * deviation) - 1.0) + skewness / 6.0


# Pair distribution at contact, g(sigma), from positions alone; it gives Z = 1 + 2^(d-1) eta g(sigma).
#
# g(r) in thin shells from contact to 1.3 diameters is fitted by a polynomial of degree 4 in r. Its value at
# contact is a linear combination of the counts in the shells. So each frame gives one number, and blocks of
# frames give the error. A cubic polynomial has 0.7 times this error, but gives too low values: by 0.8 % of
# g(sigma) at a packing fraction of 0.45, 1.7 % at 0.49, 2.2 % at 0.511 and 2.5 % at 0.52 (each +- 0.3 %, 500
# spheres).


WIDTH = 0.3
"""Total width of all shells in diameters."""
_SHELLS, _DEGREE = 15, 4
FIT_ERROR = 0.005
"""Bound on the relative error of the fit. Differences from the values by collisions in the same runs, in %:
for 500 spheres at packing fractions 0.4, 0.45, 0.49, 0.511 and 0.52 -0.4(7), -0.2(5), -0.2(4), -0.4(4),
-0.6(4); for 500 discs at 0.5, 0.6 and 0.69 0.2(1.3), -0.6(9), -0.8(6).
"""


def contact_values(frames: Frames) -> np.ndarray:
    """Compute g(sigma) (T,) in each frame, for equal particles in a periodic container."""
    sigma, (edges, coefficients, _) = frames.diameter, _contact_fit(frames)
    assert sigma is not None, "see `_contact_fit`"
    inner = round(_SHELLS / WIDTH)  # number of intervals of the width of a shell within a diameter
    values = []
    for positions in frames.positions:
        counts = pair_counts(positions[None], frames.lengths, inner + _SHELLS, sigma * edges[-1])
        shells = counts[inner:]
        # pairs that rounding moved below contact belong to the first shell
        if below := counts[:inner].sum():
            shells[0] += below - pair_counts(positions[None], frames.lengths, 1, sigma * (1.0 - 1e-5))[0]
        values.append(coefficients @ shells)
    return np.array(values)


def has_too_few_contacts(frames: Frames) -> bool:
    """Return True if there are too few pairs near contact for an error of `contact_values`. If this mean is
    small, the average over frames has a skewed distribution. Without any pair, the scatter is 0.
    """
    _, coefficients, pairs = _contact_fit(frames)
    variance, third = (len(frames.positions) * (coefficients**k @ pairs) for k in (2, 3))
    return bool(abs(third) > _MOST_SKEWED * variance**1.5)


def _contact_fit(frames: Frames) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return edges of shells in diameters, coefficients of counts, and ideal-gas counts."""
    n, d, sigma = frames.count, frames.dimension, frames.diameter
    assert sigma is not None, "requires equal particles"
    edges = 1.0 + WIDTH * np.linspace(0.0, 1.0, _SHELLS + 1)
    volumes = ball_volume(d) * np.diff(edges**d)
    pairs = 0.5 * n * (n / np.prod(frames.lengths / sigma)) * volumes
    return edges, _at_contact(edges, volumes, d) / pairs, pairs


def _at_contact(edges: np.ndarray, volumes: np.ndarray, dimension: int) -> np.ndarray:
    """Return the coefficients (shells,) of a polynomial's value at r = 1 from its means."""
    nodes, weights = np.polynomial.legendre.leggauss(_DEGREE + dimension)
    radii = 0.5 * (edges[1:] + edges[:-1])[:, None] + 0.5 * np.diff(edges)[:, None] * nodes
    weights = weights * radii ** (dimension - 1)
    weights /= weights.sum(axis=1, keepdims=True)
    powers = np.stack([(weights * (radii - 1.0) ** k).sum(axis=1) for k in range(_DEGREE + 1)], axis=1)
    scale = np.sqrt(volumes)  # counts in larger shells are more accurate
    return np.linalg.pinv(powers * scale[:, None])[0] * scale


# Diffusion coefficient of spheres from a trajectory, and from theory for the same number and cube.


_GROUPS = 32
_NUMBERS = 2_000_000  # numbers of the paths that are in memory at once


def why_not(frames: Frames) -> str | None:
    """Return the reason why D cannot be measured, such as unequal particles or no velocities, or None."""
    if frames.dimension == 2:
        return "discs have none: the displacement's square grows like t ln t"
    if frames.time is None or not all(frames.periodic):
        return "needs times (--time-step) and a periodic container"
    cubic = np.ptp(frames.lengths) <= 1e-6 * frames.lengths[0]
    if not cubic or frames.packing_fraction > ERPENBECK_WOOD_HIGHEST:
        return "needs a fluid in a cube"
    if diffusion_in_cube(_gas(frames), float(frames.lengths[0]), frames.engine, frames.scene) is None:
        return "no theory states it in so short a cube, whose images order the fluid"
    interval = np.diff(frames.time)
    if len(interval) == 0 or np.ptp(interval) > 1e-3 * interval.mean():
        return "needs frames at even times"
    if max(np.abs(step).max() for step in frames.steps()) > 0.45 * frames.lengths[0]:
        return "frames are too far apart to follow a particle across the boundary"
    _, first, last = _lags(frames)
    if last - first < 1 or len(interval) < 2 * last:
        start = first * interval.mean()
        return f"needs frames closer than {start:.2g} over a time of {4.0 * start:.2g} or more"
    return None


def groups_of(frames: Frames) -> int:
    """Return the number of groups of particles whose scatter gives the error."""
    return min(frames.count, _GROUPS)


def diffusion(frames: Frames) -> tuple[Estimate, tuple[float, float]]:
    """Measure D from the first slope of the mean-squared displacement that no longer changes. `gaspart
    measure` uses the same method. Returns D and the first and last lag of the slope, in collisions of a
    particle. Raises SceneError if the slope still changes at the longest lags. For zero total momentum of N
    particles, D is (N - 1) / N of its value without this condition. The result is corrected for this factor.
    The error is the scatter of groups of particles.
    """
    length, n = len(frames.positions), frames.count
    lags = _lags(frames)
    while 4 * lags[-1] <= length:
        lags = [*lags, 2 * lags[-1]]
    squares = np.empty((len(lags), n))
    size = max(1, _NUMBERS // (length * frames.dimension))
    for first in range(0, n, size):  # paths of some particles, because those of all are many
        part = slice(first, first + size)
        way = np.array(list(frames.paths(part)))
        squares[:, part] = [((way[lag:] - way[:-lag]) ** 2).sum(axis=2).mean(axis=0) for lag in lags]
    times = _interval(frames) * np.diff(lags)
    rises = np.diff(squares, axis=0) / (6.0 * times[:, None]) * n / (n - 1.0)
    groups = np.array([part.mean(axis=1) for part in np.array_split(rises, groups_of(frames), axis=1)])
    number, tail = settled_slope(groups)
    estimate, rate = mean_of(groups[:, number]), _rate(frames) * _interval(frames)
    window = rate * lags[number], rate * lags[number + 1]
    return Estimate(estimate.value, math.hypot(estimate.error, float(tail)), estimate.freedom), window


def expected_diffusion(frames: Frames, window: tuple[float, float]) -> tuple[float, float, str]:
    """Return the theoretical D in this cube, for the file's engine, its uncertainty and its source."""
    gas, engine, scene = _gas(frames), frames.engine, frames.scene
    prediction = diffusion_in_cube(gas, float(frames.lengths[0]), engine, scene, window)
    assert prediction is not None, "see `why_not`"
    prediction = with_discretisation(prediction, engine, scene, "paths")
    return prediction.value, prediction.error, prediction.source


def _interval(frames: Frames) -> float:
    """Return the mean time between frames."""
    assert frames.time is not None, "see `why_not`"
    return float(np.diff(frames.time).mean())


def _gas(frames: Frames) -> Gas:
    assert frames.gas is not None, "see `why_not_speeds`"
    return frames.gas


def _rate(frames: Frames) -> float:
    """Return the collisions per time of a particle, from theory."""
    return collision_rate(_gas(frames), frames.engine.equation if frames.engine else EXACT)


def _lags(frames: Frames) -> list[int]:
    """Return the first lags of slopes in frames, without duplicates."""
    first, middle, last = linear_lags(_rate(frames), _interval(frames))
    middle = max(middle, first + 1)
    return [first, middle, max(last, middle + 1)]
