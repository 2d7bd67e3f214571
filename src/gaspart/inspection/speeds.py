"""Checks of speeds: Maxwell's distribution, and its kurtosis, once collisions have brought it about."""

from __future__ import annotations

import math

import numpy as np

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import histogram_chi_square
from gaspart.inspection.frames import Frames
from gaspart.inspection.samples import UNEVEN, collided, density_modulation, independent
from gaspart.inspection.verdict import Check, compared

SPEEDS = "speed law", "kurtosis of speeds"
"""Names of the checks of speeds."""
RESIDUE = 0.25
"""Deviation of the kurtosis that may remain from the initial state, over its scatter in one frame."""
RARE = 1e-4
"""Probability below which the check of the distribution fails."""
_MOST_SKEWED = 1.0  # skewness of a mean whose probability is known well enough


def why_not_speeds(frames: Frames) -> str | None:
    """The reason why speeds cannot be checked; None if they can."""
    if frames.velocities is None:
        return frames.no_velocities
    if not np.any(frames.velocities):
        return "all velocities are 0"
    if not np.isfinite(frames.velocities).all():
        return "not all velocities are finite"
    if frames.gas is None:
        return "particles differ, or are moved by more than elastic contacts"
    if frames.part:
        return "the file has some of the particles only"
    if frames.count < 2:
        return "one particle has no distribution"
    return None


def judge_speeds(frames: Frames) -> list[Check]:
    """Checks of the distribution of speeds in the last frame, and of its kurtosis in all relaxed ones.

    The clock is that of `samples.collided`. A deviation of the kurtosis decays by its slowest rate of the
    homogeneous Boltzmann equation; what the first frame has of it is known from that frame.
    """
    names = SPEEDS
    if reason := why_not_speeds(frames):
        return [Check(name, None, reason) for name in names]
    series, expected = _kurtosis(frames), _expected_kurtosis(frames)
    clock, rate = collided(frames), theory.KURTOSIS_RELAXATION_RATE[frames.dimension]
    scatter, skewness = theory.kurtosis_scatter(frames.dimension, frames.count)
    excess = max(abs(series[0] - expected), scatter)
    needed = math.log(excess / (RESIDUE * scatter)) / rate
    if clock[-1] < needed:
        reason = (
            f"needs {needed:.3g} collisions of a particle after the first frame, to relax; there are"
            f" {clock[-1]:.3g}"
        )
        return [Check(name, None, reason) for name in names]
    first = int(np.argmax(clock >= needed))
    if any(density_modulation(frames, n, _squares(frames, n)) > UNEVEN for n in (first, len(series) - 1)):
        return [Check(name, None, "the temperature is not uniform: not relaxed") for name in names]
    samples = independent(clock[first:], rate)
    found = Estimate(series[first:].mean(), scatter / math.sqrt(samples))
    skewness /= math.sqrt(samples)
    if skewness > _MOST_SKEWED:
        text = f"{samples:.2g} independent samples of {frames.count} particles are too few"
        return [_law(frames), Check(names[1], None, text)]
    basis = f"Maxwell's; {samples:.3g} independent samples of {frames.count} particles"
    deviation = _normal((found.value - expected) / found.error, skewness)
    return [_law(frames), compared(names[1], found, Estimate(expected), basis, deviation)]


def _law(frames: Frames) -> Check:
    """The last frame's speeds against Maxwell's law, of their own temperature."""
    bins = min(30, frames.count // 10)
    if bins < 4:
        return Check("speed law", None, f"{frames.count} particles are too few for a histogram")
    square = _squares(frames, -1)
    temperature = float(frames.temperatures[-1])
    found = histogram_chi_square(
        np.sqrt(square), lambda v: theory.maxwell_cdf(v, frames.dimension, temperature), bins
    )
    text = f"chi-square {found.chi_square:.3g} of {found.degrees_of_freedom} about Maxwell's, last frame"
    return Check("speed law", found.p_value > RARE, f"{text} (p = {found.p_value:.2g})")


def _squares(frames: Frames, n: int) -> np.ndarray:
    """(N,) squared speeds in a frame, about the centre of mass along periodic axes."""
    return np.asarray((frames.motion.velocities[n] ** 2).sum(axis=1))


def _kurtosis(frames: Frames) -> np.ndarray:
    """(T,) <v^4> / <v^2>^2; 1 in a frame in which all are at rest."""
    values = []
    for n in range(len(frames.positions)):
        square = _squares(frames, n)
        mean = square.mean()
        values.append((square**2).mean() / mean**2 if mean > 0.0 else 1.0)
    return np.array(values)


def _expected_kurtosis(frames: Frames) -> float:
    """In equilibrium at fixed energy, and zero momentum along periodic axes (exact).

    As `theory.kurtosis`; along a periodic axis <v_k^2> is the part 1 - 1/N of that along another one.
    """
    parts = np.where(frames.periodic, 1.0 - 1.0 / frames.count, 1.0)
    freedoms = frames.count * parts.sum()
    return float((1.0 + 2.0 * (parts**2).sum() / parts.sum() ** 2) * freedoms / (freedoms + 2.0))


def _normal(deviation: float, skewness: float) -> float:
    """The normal deviation of the same probability as one above the mean of a skewed distribution, by that of
    the gamma distribution (Wilson and Hilferty, Proc. Natl. Acad. Sci. 17, 684 (1931)); unchanged below it,
    where the tail is the shorter one."""
    if deviation <= 0.0:
        return deviation
    return 6.0 / skewness * (math.cbrt(1.0 + 0.5 * skewness * deviation) - 1.0) + skewness / 6.0
