"""Means of independent numbers, and functions of means by resampling."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics.fits import Values, fit_linear
from gaspart.analysis.statistics.inputs import series_of


@dataclass(frozen=True)
class Combination:
    """Weighted mean of independent values, and whether their own errors explain their scatter; see `Fit`."""

    value: float
    error: float
    freedom: float
    chi_square: float
    degrees_of_freedom: int
    error_freedom: float
    p_value: float

    @property
    def estimate(self) -> Estimate:
        """The mean, with its uncertainty."""
        return Estimate(self.value, self.error, self.freedom)


def mean_of(values: ArrayLike) -> Estimate:
    """Mean of N independent numbers, at least two, and its standard error from their scatter, which has N - 1
    degrees of freedom."""
    values = series_of("values", values, 2)
    error = float(values.std(ddof=1) / math.sqrt(values.size))
    return Estimate(float(values.mean()), error, values.size - 1)


def average(estimates: Estimate | Sequence[Estimate]) -> Estimate:
    """Mean of independent estimates, or of those of one array along its first axis, that count alike, with
    their own uncertainties."""
    return sum(estimates, Estimate(0.0)) / len(estimates)


def means_of(samples: ArrayLike, sizes: ArrayLike | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Means over axis 0 of N independent samples (N, ...), and their standard errors from the scatter.

    sizes (N,): how many alike things each sample is the mean of. The means are then those over all of them,
    however they are divided, and the variance of a sample is in inverse proportion to its size.
    """
    values = np.asarray(samples)
    if sizes is None or np.ptp(sizes) == 0.0:
        return values.mean(axis=0), values.std(axis=0, ddof=1) / math.sqrt(len(values))
    weights = np.asarray(sizes, dtype=float)
    mean = np.average(values, axis=0, weights=weights)
    variance = np.average((values - mean) ** 2, axis=0, weights=weights) / (len(values) - 1.0)
    return mean, np.sqrt(variance)


def steady_mean(series: ArrayLike, *changes: ArrayLike) -> Estimate:
    """Mean of a current into and out of a store, from its averages in K blocks of time.

    changes: (K,) each, by how much a bounded quantity, such as the energy stored, has changed during each
    block. What a block stores, another one gives back: blocks anticorrelate, and their scatter exceeds that
    of the long-time mean. So the blocks are regressed on the changes (least squares), which leaves the
    current of blocks without a change; it differs from the plain mean by a bounded amount over the length of
    the run. Degrees of freedom: K - 1 - len(changes). Raises ValueError as `fit_linear`.
    """
    series = series_of("series", series, 2)
    design = [np.ones(series.size)]
    for change in changes:
        change = series_of("change", change, 2)
        if np.ptp(change) > 0.0:  # nothing is stored
            design.append(change / np.abs(change).max())
    fit = fit_linear(np.stack(design, axis=1), series)
    return Estimate(fit.values[0], fit.errors[0], fit.degrees_of_freedom)


def combine(values: Values, errors: ArrayLike | None = None, freedoms: ArrayLike = math.inf) -> Combination:
    """Mean weighted by 1 / error^2, with the chi-square of the values about it; see `fit_linear`."""
    number = len(values) if isinstance(values, Estimate) else np.size(values)
    fit = fit_linear(np.ones((number, 1)), values, errors, freedoms)
    mean = fit.estimate(0)
    return Combination(
        value=mean.value,
        error=mean.error,
        freedom=mean.freedom,
        chi_square=fit.chi_square,
        degrees_of_freedom=fit.degrees_of_freedom,
        error_freedom=fit.error_freedom,
        p_value=fit.p_value,
    )


def combine_estimates(estimates: Estimate | Sequence[Estimate]) -> Estimate:
    """Mean of independent estimates, or of the elements of one, weighted by 1 / error^2; NaN of none."""
    one = estimates if isinstance(estimates, Estimate) else Estimate.stack(estimates)
    return combine(one).estimate if one else Estimate(math.nan, math.nan)


def bootstrap(function: Callable[..., float], samples: ArrayLike, repeats: int = 1000) -> Estimate:
    """function(samples) with its standard error from resampled data (with replacement, along axis 0).

    The same samples give the same error. `function` returns one number. Resampled
    means of n samples scatter by the fraction sqrt(1 - 1/n) of the standard error, which is divided by it;
    the error has n - 1 degrees of freedom (Efron and Tibshirani, An introduction to the bootstrap (1993),
    section 5.3).
    """
    samples = np.asarray(samples)
    if samples.shape[0] < 2:
        raise ValueError(f"samples: {samples.shape[0]} (must be at least 2)")
    generator = np.random.default_rng(0)
    draws = generator.integers(0, samples.shape[0], size=(repeats, samples.shape[0]))
    scatter = np.std([function(samples[draw]) for draw in draws], ddof=1)
    number = samples.shape[0]
    return Estimate(float(function(samples)), float(scatter) * math.sqrt(number / (number - 1.0)), number - 1)


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
