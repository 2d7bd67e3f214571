"""Means of independent numbers, and functions of means by resampling."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics.inputs import positive_errors, series_of


@dataclass(frozen=True)
class Combination:
    """Weighted mean of independent values, and whether their own errors explain their scatter."""

    value: float
    error: float
    chi_square: float
    degrees_of_freedom: int
    p_value: float


def mean_of(values: ArrayLike) -> Estimate:
    """Mean of independent numbers and its standard error from their scatter (N - 1). At least two."""
    values = series_of("values", values, 2)
    return Estimate(float(values.mean()), float(values.std(ddof=1) / math.sqrt(values.size)))


def combine(values: ArrayLike, errors: ArrayLike) -> Combination:
    """Mean weighted by 1 / error^2, with the chi-square of the values about it."""
    values = series_of("values", values, 1)
    weights = 1.0 / positive_errors(errors, values.size) ** 2
    mean = float(np.sum(weights * values) / weights.sum())
    chi_square = float(np.sum(weights * (values - mean) ** 2))
    freedom = values.size - 1
    p_value = float(stats.chi2.sf(chi_square, freedom)) if freedom else math.nan
    return Combination(mean, float(weights.sum() ** -0.5), chi_square, freedom, p_value)


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
    return Estimate(float(function(samples)), float(scatter))


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
