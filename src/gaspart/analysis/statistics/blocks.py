"""Correlated series: error of the mean, test of this error with blocks, and autocorrelation time."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from gaspart.analysis.estimate import Estimate

# Validation of arguments.


def series_of(name: str, values: ArrayLike, shortest: int) -> np.ndarray:
    """Return `values` as a float64 series; raise ValueError if it is too short or not finite."""
    values = np.asarray(values, dtype=float)
    if values.ndim != 1 or values.size < shortest:
        raise ValueError(f"{name}: shape {values.shape} (must be a series of at least {shortest} values)")
    if not np.all(np.isfinite(values)):
        raise ValueError(f"{name}: not all values are finite")
    return values


def positive_errors(errors: ArrayLike, size: int) -> np.ndarray:
    """Return `errors` broadcast to (size,); raise ValueError unless positive and finite."""
    errors = np.broadcast_to(np.asarray(errors, dtype=float), (size,))
    if not np.all((errors > 0.0) & np.isfinite(errors)):
        raise ValueError("errors: must be positive and finite")
    return errors


def positive_freedoms(freedoms: ArrayLike, size: int) -> np.ndarray:
    """Return degrees of freedom broadcast to (size,); raise ValueError unless positive. The degrees of
    freedom may be infinite.
    """
    freedoms = np.broadcast_to(np.asarray(freedoms, dtype=float), (size,))
    if not np.all(freedoms > 0.0):
        raise ValueError("freedoms: must be positive")
    return freedoms


ORDER = 1.25
"""Order of the autoregressive process that is fitted to n samples, divided by the cube root of n."""
_ROUNDING = 1e-12
"""Relative difference below which samples count as equal. It allows for the rounding error of differences of
sums.
"""


@dataclass(frozen=True)
class CorrelatedMean:
    """Mean of a correlated series, with errors from blocks. `errors[k]` is the standard error from blocks of
    `lengths[k]` samples. `flat` is True if, beyond some block length, the error no longer grows by more than
    its own uncertainty. The series is then long enough. `block_length` is the shortest block length for which
    this holds, and `blocks` is the number of blocks of this length.
    """

    estimate: Estimate
    block_length: int
    blocks: int
    lengths: np.ndarray
    errors: np.ndarray
    flat: bool


def correlated_mean(series: ArrayLike, minimum_blocks: int = 16, fitted: int = 1) -> CorrelatedMean:
    """Compute the mean and standard error of a stationary correlated series. `fitted`: number of parameters
    that were fitted to the series, including its mean; for the residuals of a polynomial, the number of its
    coefficients. The squared error is the spectrum at frequency 0 divided by the length. It is computed from
    an autoregressive process that is fitted to the series, and whose order grows as the cube root of the
    length (Berk, Ann. Stat. 2, 489 (1974)). The error is correct for independent, correlated and
    anticorrelated series. Its own uncertainty, from the fitted coefficients, is expressed as degrees of
    freedom: 13 for 200 independent samples. The degrees of freedom are at most the number of changes between
    consecutive samples. A constant series gives no information on its error: the error is 0 with one degree
    of freedom. Blocks show whether the series is long enough (Flyvbjerg and Petersen, J. Chem. Phys. 91, 461
    (1989)). The error from blocks of 1, 2, 4 ... samples grows until the blocks are independent. The error
    from n blocks has the relative uncertainty 1 / sqrt(2 (n-1)). The error is flat from the shortest block
    length that satisfies a condition: every greater block length gives an error that is larger at most by its
    own uncertainty. The error from these blocks is not used as the result, because it is the first error that
    is not clearly too small. On average it would be too small by 5 to 40 % for 16 to 300 autocorrelation
    times. At least `minimum_blocks` (>= 4) samples are needed. Samples at the start that do not fill a block
    do not belong to any block.
    """
    if minimum_blocks < 4:
        raise ValueError(f"minimum_blocks: {minimum_blocks} (must be at least 4)")
    series = series_of("series", series, minimum_blocks)
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
    spectrum, freedom = _spectrum(series, fitted)
    error = math.sqrt(spectrum / series.size)
    return CorrelatedMean(
        estimate=Estimate(series.mean(), error, freedom),
        block_length=lengths[chosen],
        blocks=counts[chosen],
        lengths=np.array(lengths),
        errors=errors,
        flat=flat,
    )


def slow_mean(series: ArrayLike, minimum_blocks: int = 16) -> Estimate:
    """Compute the mean of a series whose correlations may decay as 1/t, and its error. Particles cross a
    container at all speeds, and slow particles stay in it for a long time. So without collisions, the
    correlation of the number of particles inside decays with the time difference t as L / t, where L is the
    length of the container. The sum of these correlations grows as the logarithm of the length of the run. An
    autoregressive fit of finite order does not include this growth. Therefore the squared error of the mean
    of blocks, multiplied by the block length, is fitted by a linear function of the logarithm of this length.
    The fit uses blocks between a quarter of the longest length and the longest length. The fit is
    extrapolated to the length of the series. The result is the larger of this error and the error of
    `correlated_mean`.
    """
    plain = correlated_mean(series, minimum_blocks)
    squares, own = plain.errors**2, plain.estimate
    if squares.size < 3:
        return own
    slope = max(0.0, float(squares[-1] - squares[-3])) / math.log(4.0)
    number = np.size(series) // plain.lengths[-1]
    error = math.sqrt(squares[-1] + slope * math.log(number))
    if error <= own.error:
        return own
    return Estimate(own.value, error, min(own.freedom, number - 1.0))


def autocorrelation_time(series: ArrayLike) -> float:
    """Compute the integrated autocorrelation time in samples: 1/2 + the sum of rho(k). The autocorrelation
    time is 1/2 for independent samples, and smaller for anticorrelated samples. For n samples, the squared
    error of the mean from `correlated_mean` is the variance times 2 time / n. So the series is equivalent to
    n / (2 time) independent samples. For a constant series the result is 1/2.
    """
    series = series_of("series", series, 4)
    spectrum = _spectrum(series)[0]
    return 0.5 * spectrum / float(series.var()) if spectrum > 0.0 else 0.5


def count_changes(series: np.ndarray) -> int:
    """Count the changes between consecutive samples that are larger than rounding errors."""
    return int(np.count_nonzero(np.abs(np.diff(series)) > _ROUNDING * np.abs(series).max()))


def common_freedom(series: np.ndarray) -> float:
    """Compute common degrees of freedom for the errors of several similarly correlated series. If the
    estimated correlation time of a series is too small by chance, its error is too small and its number of
    degrees of freedom too large. The mean autocorrelation of all series therefore gives a common number of
    degrees of freedom. For 40 cells of a dense fluid over 13 correlation times, 1.8 % of the values deviate
    by more than three standard deviations if each series has its own number of degrees of freedom. If this
    number is limited to the common number, only 0.7 % do so (`tests/analysis/test_small_numbers.py`).
    `series`: (n, m), m series of n samples; constant series are ignored. The result is infinite if all series
    are constant.
    """
    number = len(series)
    centred = series - series.mean(axis=0)
    variances = (centred**2).mean(axis=0)
    centred = centred[:, variances > 0.0] / np.sqrt(variances[variances > 0.0])
    if not centred.size:
        return math.inf
    lags = range(_order(number) + 1)
    covariances = np.array([(centred[: number - lag] * centred[lag:]).sum() for lag in lags]) / centred.size
    first, _ = _autoregression(covariances)
    _, variance = _autoregression(covariances + first / number)
    return number / (1.0 + 2.0 * variance)


def _order(number: int) -> int:
    """Return the order of the autoregressive process that is fitted to `number` samples."""
    return round(ORDER * number ** (1.0 / 3.0))


def _spectrum(series: np.ndarray, fitted: int = 1) -> tuple[float, float]:
    """Compute the sum of the autocovariances of a series over all lags. The degrees of freedom of this
    estimate are also returned. Autocovariances relative to the measured mean are too small by their sum
    divided by the number n of samples. So a first estimate of this sum divided by n is added to them, and the
    fit is repeated. Relative to a fit with `fitted` parameters, they are too small by about this number times
    as much.
    """
    number = series.size
    order = _order(number)
    centred = series - series.mean()
    changes = count_changes(series)
    if not changes:
        return 0.0, 1.0
    covariances = np.array([centred[: number - lag] @ centred[lag:] for lag in range(order + 1)]) / number
    first, _ = _autoregression(covariances)
    total, variance = _autoregression(covariances + fitted * first / number)
    return total, min(number / (1.0 + 2.0 * variance), float(changes))


def _autoregression(covariances: np.ndarray) -> tuple[float, float]:
    """Compute the spectrum at frequency 0 of an autoregressive process, S = E / A^2. `covariances` are the
    autocovariances of the process. The relative variance of A is also returned: n times the variance of A
    divided by A^2. In the recursion of Levinson and Durbin, E is the variance of the prediction error, and A
    is 1 minus the sum of the coefficients. The covariance matrix of the coefficients is E / n times the
    inverse covariance matrix of the values. The sum of the elements of this inverse is the sum of A^2 / E
    over the lower orders.
    """
    coefficients = np.zeros(0)
    unpredicted, rest, inverse = float(covariances[0]), 1.0, 0.0
    for order in range(1, covariances.size):
        inverse += rest**2 / unpredicted
        predicted = coefficients @ covariances[order - 1 : 0 : -1]
        partial = (covariances[order] - predicted) / unpredicted
        remaining = unpredicted * (1.0 - partial**2)
        if remaining <= 1e-12 * covariances[0]:  # the earlier values predict the series up to rounding
            break
        coefficients = np.append(coefficients - partial * coefficients[::-1], partial)
        unpredicted, rest = remaining, rest * (1.0 - partial)
    return unpredicted / rest**2, unpredicted * inverse / rest**2


# Tests of samples against a distribution.


@dataclass(frozen=True)
class Histogram:
    """Counts in bins that have the same expected count, and their chi-square."""

    chi_square: float
    degrees_of_freedom: int
    p_value: float
    counts: np.ndarray
    expected: float


def histogram_chi_square(samples: ArrayLike, cdf: Callable[[np.ndarray], Any], bins: int) -> Histogram:
    """Compute chi-square of independent samples against a distribution with cumulative function `cdf`. No
    parameter of the distribution is fitted. The bins divide the values of cdf(samples), which are uniform on
    [0, 1], into equal intervals. So all bins have the same probability. At least 5 samples per bin are
    required.
    """
    from scipy.special import chdtrc

    samples = series_of("samples", samples, 1)
    if bins < 2 or samples.size < 5 * bins:
        raise ValueError(f"bins: {bins} (at least 2, with 5 or more of the {samples.size} samples each)")
    counts = np.bincount(np.minimum((cdf(samples) * bins).astype(int), bins - 1), minlength=bins)
    expected = samples.size / bins
    chi_square = float(np.sum((counts - expected) ** 2) / expected)
    return Histogram(chi_square, bins - 1, float(chdtrc(bins - 1, chi_square)), counts, expected)
