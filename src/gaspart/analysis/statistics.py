"""Statistics of simulations: errors of correlated series, fits with covariance, tests of distributions.

Everywhere: `error` is one standard deviation of the estimate; errors given to a fit are standard deviations
of independent Gaussian scatter; arrays are one-dimensional and of equal length unless stated. Probabilities
`p_value` are those of a chi-square at least as large if the model holds. Inputs that are too short, of
unequal length or not finite raise ValueError.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats


@dataclass(frozen=True)
class Estimate:
    """A value and its standard error, from `count` independent numbers."""

    value: float
    error: float
    count: int


@dataclass(frozen=True)
class Combination:
    """Weighted mean of independent values, and whether their own errors explain their scatter."""

    value: float
    error: float
    chi_square: float
    degrees_of_freedom: int
    p_value: float


@dataclass(frozen=True)
class BlockAverage:
    """Mean of a correlated series; `errors[k]` is the standard error from blocks of `lengths[k]` samples.

    `flat`: the error no longer grows with the block length beyond its own uncertainty, so `error` can be
    trusted.
    """

    mean: float
    error: float
    block_length: int
    blocks: int
    lengths: np.ndarray
    errors: np.ndarray
    flat: bool


@dataclass(frozen=True)
class Fit:
    """Parameters of a linear least-squares fit. Without errors given there is no test: p_value is NaN."""

    values: np.ndarray
    covariance: np.ndarray
    chi_square: float
    degrees_of_freedom: int
    p_value: float
    residuals: np.ndarray

    @property
    def errors(self) -> np.ndarray:
        """Standard errors of the parameters."""
        return np.sqrt(np.diag(self.covariance))


@dataclass(frozen=True)
class PowerLaw:
    """y = amplitude x^exponent."""

    exponent: float
    exponent_error: float
    amplitude: float
    amplitude_error: float
    chi_square: float
    degrees_of_freedom: int
    p_value: float


@dataclass(frozen=True)
class Histogram:
    """Counts in bins of equal expected count, and their chi-square."""

    chi_square: float
    degrees_of_freedom: int
    p_value: float
    counts: np.ndarray
    expected: float


@dataclass(frozen=True)
class Optimum:
    """Place of a minimum with its 95 % interval, the cost there, and whether it lies between the points."""

    location: float
    low: float
    high: float
    cost: float
    interior: bool


def _series(name: str, values: ArrayLike, shortest: int) -> np.ndarray:
    values = np.asarray(values, dtype=float)
    if values.ndim != 1 or values.size < shortest:
        raise ValueError(f"{name}: shape {values.shape} (must be a series of at least {shortest} values)")
    if not np.all(np.isfinite(values)):
        raise ValueError(f"{name}: not all values are finite")
    return values


def _positive_errors(errors: ArrayLike, size: int) -> np.ndarray:
    errors = np.broadcast_to(np.asarray(errors, dtype=float), (size,))
    if not np.all((errors > 0.0) & np.isfinite(errors)):
        raise ValueError("errors: must be positive and finite")
    return errors


def mean_of(values: ArrayLike) -> Estimate:
    """Mean of independent numbers and its standard error from their scatter (N - 1). At least two."""
    values = _series("values", values, 2)
    return Estimate(float(values.mean()), float(values.std(ddof=1) / math.sqrt(values.size)), values.size)


def combine(values: ArrayLike, errors: ArrayLike) -> Combination:
    """Mean weighted by 1 / error^2, with the chi-square of the values about it."""
    values = _series("values", values, 1)
    weights = 1.0 / _positive_errors(errors, values.size) ** 2
    mean = float(np.sum(weights * values) / weights.sum())
    chi_square = float(np.sum(weights * (values - mean) ** 2))
    freedom = values.size - 1
    p_value = float(stats.chi2.sf(chi_square, freedom)) if freedom else math.nan
    return Combination(mean, float(weights.sum() ** -0.5), chi_square, freedom, p_value)


def block_average(series: ArrayLike, minimum_blocks: int = 16) -> BlockAverage:
    """Mean and standard error of a stationary correlated series, by blocks of doubling length.

    Flyvbjerg and Petersen, J. Chem. Phys. 91, 461 (1989): the error from blocks of 1, 2, 4 ... samples grows
    until the blocks are independent. With n blocks it is itself uncertain by the fraction 1 / sqrt(2 (n-1)).
    The result is the error at the shortest length that no longer length exceeds by more than that uncertainty
    of the longer one (`flat`); if there is none, or only the longest, the longest, and `flat` is False.
    Needs minimum_blocks (>= 4) samples; a remainder at the start that fills no block is left out.
    """
    if minimum_blocks < 4:
        raise ValueError(f"minimum_blocks: {minimum_blocks} (must be at least 4)")
    series = _series("series", series, minimum_blocks)
    lengths, errors, counts = [], [], []
    length = 1
    while series.size // length >= minimum_blocks:
        count = series.size // length
        blocks = series[series.size - count * length :].reshape(count, length).mean(axis=1)
        lengths.append(length)
        counts.append(count)
        errors.append(blocks.std(ddof=1) / math.sqrt(count))
        length *= 2
    errors = np.array(errors)
    own = errors / np.sqrt(2.0 * (np.array(counts) - 1.0))
    chosen, flat = len(errors) - 1, False
    for k in range(len(errors) - 1):
        if np.all(errors[k + 1 :] - own[k + 1 :] <= errors[k]):
            chosen, flat = k, True
            break
    return BlockAverage(
        mean=float(series.mean()),
        error=float(errors[chosen]),
        block_length=lengths[chosen],
        blocks=counts[chosen],
        lengths=np.array(lengths),
        errors=errors,
        flat=flat,
    )


def autocorrelation_time(series: ArrayLike, window: float = 6.0) -> float:
    """Integrated autocorrelation time 1/2 + sum of rho(k), in samples: 1/2 for independent ones.

    The sum ends at the first k >= window * time (Sokal's self-consistent window; Madras and Sokal 1988). A
    series of n samples holds n / (2 time) independent ones. A constant series has none of its own: 1/2.
    """
    series = _series("series", series, 4)
    centred = series - series.mean()
    size = 1 << (2 * series.size - 1).bit_length()
    spectrum = np.abs(np.fft.rfft(centred, size)) ** 2
    correlation = np.fft.irfft(spectrum, size)[: series.size]
    if correlation[0] <= 0.0:
        return 0.5
    times = 0.5 + np.concatenate([[0.0], np.cumsum(correlation[1:] / correlation[0])])
    reached = np.flatnonzero(np.arange(series.size) >= window * times)
    return float(max(0.5, times[reached[0] if reached.size else -1]))


def fit_linear(design: ArrayLike, y: ArrayLike, errors: ArrayLike | None = None) -> Fit:
    """Least-squares fit of y = design @ values (design: (points, parameters)), weighted by 1 / errors^2.

    With errors: covariance from them, and a chi-square test of the model. Without: all points count alike,
    and the covariance is scaled by the residuals' scatter (so there is no test). Raises ValueError if there
    are fewer points than parameters (or as many, without errors), or the columns are dependent.
    """
    y = _series("y", y, 1)
    design = np.asarray(design, dtype=float)
    if design.ndim != 2 or design.shape[0] != y.size or not np.all(np.isfinite(design)):
        raise ValueError(f"design: shape {design.shape} (must be ({y.size}, parameters) and finite)")
    freedom = y.size - design.shape[1]
    if freedom < (1 if errors is None else 0):
        raise ValueError(f"y: {y.size} points are too few for {design.shape[1]} parameters")
    scale = np.ones(y.size) if errors is None else _positive_errors(errors, y.size)
    weighted = design / scale[:, None]
    # Columns are brought to one length: powers of a small x differ by many decades.
    lengths = np.linalg.norm(weighted, axis=0)
    if np.any(lengths == 0.0) or np.linalg.matrix_rank(weighted / lengths) < design.shape[1]:
        raise ValueError("design: its columns are not independent")
    left, singular, right = np.linalg.svd(weighted / lengths, full_matrices=False)
    inverse = (right.T / singular) / lengths[:, None]
    values = inverse @ (left.T @ (y / scale))
    covariance = inverse @ inverse.T
    residuals = y - design @ values
    chi_square = float(np.sum((residuals / scale) ** 2))
    if errors is None:
        return Fit(values, covariance * chi_square / freedom, math.nan, freedom, math.nan, residuals)
    p_value = float(stats.chi2.sf(chi_square, freedom)) if freedom else math.nan
    return Fit(values, covariance, chi_square, freedom, p_value, residuals)


def fit_polynomial(
    x: ArrayLike,
    y: ArrayLike,
    errors: ArrayLike | None = None,
    powers: Sequence[int] = (0, 1),
    fixed: Mapping[int, float] | None = None,
) -> Fit:
    """Fit y = sum of values[i] x^powers[i] plus the terms held fixed, {power: coefficient}; see `fit_linear`.

    The result does not include the uncertainty of the fixed coefficients: repeat the fit with them shifted to
    see it.
    """
    x = _series("x", x, 1)
    y = _series("y", y, 1)
    if x.size != y.size:
        raise ValueError(f"x, y: {x.size} and {y.size} values (must be as many)")
    held = sum(coefficient * x**power for power, coefficient in (fixed or {}).items())
    return fit_linear(np.stack([x**power for power in powers], axis=1), y - held, errors)


def fit_power_law(x: ArrayLike, y: ArrayLike, errors: ArrayLike | None = None) -> PowerLaw:
    """Fit y = amplitude x^exponent as a line of ln y against ln x (x, y > 0; errors: of y); see `fit_linear`.

    The errors become errors / y of the logarithm, good while they are below some 20 %.
    """
    x = _series("x", x, 2)
    y = _series("y", y, 2)
    if x.size != y.size or np.any(x <= 0.0) or np.any(y <= 0.0):
        raise ValueError("x, y: must be as many, and positive")
    relative = None if errors is None else _positive_errors(errors, y.size) / y
    # About the middle of ln x the two parameters are nearly independent; the amplitude is carried back to x =
    # 1.
    middle = np.log(x).mean()
    fit = fit_polynomial(np.log(x) - middle, np.log(y), relative)
    exponent = float(fit.values[1])
    to_one = np.array([1.0, -middle])
    amplitude = math.exp(fit.values @ to_one)
    return PowerLaw(
        exponent=exponent,
        exponent_error=float(fit.errors[1]),
        amplitude=amplitude,
        amplitude_error=amplitude * math.sqrt(to_one @ fit.covariance @ to_one),
        chi_square=fit.chi_square,
        degrees_of_freedom=fit.degrees_of_freedom,
        p_value=fit.p_value,
    )


def histogram_chi_square(samples: ArrayLike, cdf: Callable[[np.ndarray], Any], bins: int) -> Histogram:
    """Chi-square of independent samples against a distribution without fitted parameters, given by its `cdf`.

    The bins have equal probability: cdf(samples) is uniform on [0, 1]. At least 5 samples a bin.
    """
    samples = _series("samples", samples, 1)
    if bins < 2 or samples.size < 5 * bins:
        raise ValueError(f"bins: {bins} (at least 2, with 5 or more of the {samples.size} samples each)")
    counts = np.bincount(np.minimum((cdf(samples) * bins).astype(int), bins - 1), minlength=bins)
    expected = samples.size / bins
    chi_square = float(np.sum((counts - expected) ** 2) / expected)
    return Histogram(chi_square, bins - 1, float(stats.chi2.sf(chi_square, bins - 1)), counts, expected)


def bootstrap(
    function: Callable[..., float], samples: ArrayLike, repeats: int = 1000, seed: int = 0
) -> Estimate:
    """function(samples) with its standard error from resampled data (with replacement, along axis 0).

    `seed`: of the resampling; the same seed gives the same error. `function` returns one number.
    """
    samples = np.asarray(samples)
    if samples.shape[0] < 2:
        raise ValueError(f"samples: {samples.shape[0]} (must be at least 2)")
    generator = np.random.default_rng(seed)
    draws = generator.integers(0, samples.shape[0], size=(repeats, samples.shape[0]))
    scatter = np.std([function(samples[draw]) for draw in draws], ddof=1)
    return Estimate(float(function(samples)), float(scatter), samples.shape[0])


def jackknife(function: Callable[..., Any], *samples: ArrayLike) -> tuple[Any, Any]:
    """function(means of the samples) with its standard error, each block left out in turn.

    samples: arrays whose axis 0 runs over the same n independent blocks (at least two); `function` takes
    their means over blocks and returns a number or an array. For smooth functions the error is right to first
    order, correlations between the samples included (Tukey 1958). Returns (value, error), arrays.
    """
    series = [np.asarray(sample, dtype=float) for sample in samples]
    blocks = series[0].shape[0]
    if blocks < 2 or any(sample.shape[0] != blocks for sample in series):
        raise ValueError(f"samples: {[len(sample) for sample in series]} blocks (as many, and at least 2)")
    sums = [sample.sum(axis=0) for sample in series]
    partial = np.array(
        [
            function(
                *((total - sample[k]) / (blocks - 1) for total, sample in zip(sums, series, strict=True))
            )
            for k in range(blocks)
        ]
    )
    error = np.sqrt((blocks - 1) / blocks * ((partial - partial.mean(axis=0)) ** 2).sum(axis=0))
    return np.asarray(function(*(total / blocks for total in sums)), dtype=float), error


def optimum(x: ArrayLike, cost: ArrayLike, errors: ArrayLike | None = None, within: float = 3.0) -> Optimum:
    """Where a cost is least: a parabola of ln cost against ln x, through the points near the minimum.

    Taken are the points whose cost is below `within` times the least one (at least four, the cheapest
    first). The 95 % interval is Fieller's: all u for which the parabola's slope at u is compatible with 0,
    which stays right when the curvature is uncertain (the interval may then be infinite: low = 0, high =
    inf). errors: of the cost; without, the scatter about the parabola. `interior`: the parabola opens upwards
    and its minimum lies between the points. If it does not, the location is the cheapest point's, and low and
    high are 0 and inf: no minimum was measured.
    """
    x = _series("x", x, 4)
    cost = _series("cost", cost, 4)
    if x.size != cost.size or np.any(x <= 0.0) or np.any(cost <= 0.0):
        raise ValueError("x, cost: must be as many, and positive")
    cheapest = np.argsort(cost, kind="stable")
    near = np.sort(cheapest[: max(4, np.count_nonzero(cost < within * cost.min()))])
    if np.unique(x[near]).size < 3:
        raise ValueError("x: needs at least three different values near the minimum")
    middle = np.log(x[near]).mean()
    u = np.log(x[near]) - middle
    relative = None if errors is None else _positive_errors(errors, cost.size)[near] / cost[near]
    fit = fit_polynomial(u, np.log(cost[near]), relative, powers=(0, 1, 2))
    level, slope, curvature = fit.values
    freedom = fit.degrees_of_freedom
    quantile = stats.t.ppf(0.975, freedom) if errors is None else stats.norm.ppf(0.975)
    vertex = -0.5 * slope / curvature if curvature > 0.0 else math.nan
    if not u.min() < vertex < u.max():
        best = cheapest[0]
        return Optimum(float(x[best]), 0.0, math.inf, float(cost[best]), False)
    low, high = _fieller(slope, curvature, fit.covariance[1:, 1:], quantile)
    least = math.exp(level + 0.5 * slope * vertex)
    return Optimum(math.exp(vertex + middle), math.exp(low + middle), math.exp(high + middle), least, True)


def _fieller(slope: float, curvature: float, covariance: np.ndarray, quantile: float) -> tuple[float, float]:
    """Interval of u where slope + 2 curvature u differs from 0 by at most `quantile` standard errors."""
    # (slope + 2 c u)^2 <= q^2 (V_ss + 4 V_sc u + 4 V_cc u^2): a quadratic in u.
    square = quantile**2
    a = 4.0 * (curvature**2 - square * covariance[1, 1])
    b = 4.0 * (slope * curvature - square * covariance[0, 1])
    c = slope**2 - square * covariance[0, 0]
    discriminant = b**2 - 4.0 * a * c
    if a <= 0.0 or discriminant < 0.0:
        return -math.inf, math.inf
    root = math.sqrt(discriminant)
    return (-b - root) / (2.0 * a), (-b + root) / (2.0 * a)
