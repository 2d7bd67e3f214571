"""Tests of samples against a distribution."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import chdtrc

from gaspart.analysis.statistics.inputs import series_of


@dataclass(frozen=True)
class Histogram:
    """Counts in bins of equal expected count, and their chi-square."""

    chi_square: float
    degrees_of_freedom: int
    p_value: float
    counts: np.ndarray
    expected: float


def histogram_chi_square(samples: ArrayLike, cdf: Callable[[np.ndarray], Any], bins: int) -> Histogram:
    """Chi-square of independent samples against a distribution without fitted parameters, given by its `cdf`.

    The bins have equal probability: cdf(samples) is uniform on [0, 1]. At least 5 samples a bin.
    """
    samples = series_of("samples", samples, 1)
    if bins < 2 or samples.size < 5 * bins:
        raise ValueError(f"bins: {bins} (at least 2, with 5 or more of the {samples.size} samples each)")
    counts = np.bincount(np.minimum((cdf(samples) * bins).astype(int), bins - 1), minlength=bins)
    expected = samples.size / bins
    chi_square = float(np.sum((counts - expected) ** 2) / expected)
    return Histogram(chi_square, bins - 1, float(chdtrc(bins - 1, chi_square)), counts, expected)
