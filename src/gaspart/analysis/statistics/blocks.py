"""Correlated series: the error of their mean, whether blocks confirm it, and their autocorrelation time."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics.inputs import series_of


@dataclass(frozen=True)
class CorrelatedMean:
    """The mean of a correlated series, and what blocks say of its error; `errors[k]` is the standard error
    from blocks of `lengths[k]` samples.

    `flat`: the error from blocks no longer grows with their length beyond its own uncertainty, so that the
    series is long enough; from blocks of `block_length` on, of which there are `blocks`.
    """

    estimate: Estimate
    block_length: int
    blocks: int
    lengths: np.ndarray
    errors: np.ndarray
    flat: bool


def correlated_mean(series: ArrayLike, minimum_blocks: int = 16) -> CorrelatedMean:
    """Mean and standard error of a stationary correlated series.

    The error is that of n / (2 t) independent samples, t the autocorrelation time. The sum of correlations
    about a measured mean is too small by the part (2 W + 1) / n, W its window, for which it is corrected; and
    the squared error is uncertain by the part sqrt(2 (2 W + 1) / n), as with n / (2 W + 1) degrees of freedom
    (Wolff, Comput. Phys. Commun. 156, 143 (2004)).

    Whether the series is long enough is decided by blocks (Flyvbjerg and Petersen, J. Chem. Phys. 91, 461
    (1989)): the error from blocks of 1, 2, 4 ... samples grows until they are independent; that from n of
    them is uncertain by the part 1 / sqrt(2 (n-1)). It is flat from the shortest length on that no longer
    length exceeds by more than the uncertainty of the longer one. The error at that length is not taken: the
    first one that is not clearly too small is too small on average, by 5 to 40 % with 16 to 300
    autocorrelation times. Needs minimum_blocks (>= 4) samples; a remainder at the start that fills no block
    is left out of the blocks.
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
    time, window = _correlation(series)
    share = (2 * window + 1) / series.size
    error = float(series.std() * math.sqrt(2.0 * time * (1.0 + share) / series.size))
    if share > 0.25:  # correlated over so much of the series that the sum means little
        error = max(error, float(errors[-1]))
    return CorrelatedMean(
        estimate=Estimate(series.mean(), error, 1.0 / share),
        block_length=lengths[chosen],
        blocks=counts[chosen],
        lengths=np.array(lengths),
        errors=errors,
        flat=flat,
    )


def autocorrelation_time(series: ArrayLike) -> float:
    """Integrated autocorrelation time 1/2 + sum of rho(k), in samples: 1/2 for independent ones.

    The sum ends at the first k >= 6 times the result (Sokal's self-consistent window; Madras and Sokal 1988).
    A series of n samples holds n / (2 time) independent ones. A constant series has none of its own: 1/2.
    """
    return _correlation(series_of("series", series, 4))[0]


def _correlation(series: np.ndarray) -> tuple[float, int]:
    """The autocorrelation time of a series, and the window of its sum."""
    centred = series - series.mean()
    size = 1 << (2 * series.size - 1).bit_length()
    spectrum = np.abs(np.fft.rfft(centred, size)) ** 2
    correlation = np.fft.irfft(spectrum, size)[: series.size]
    if correlation[0] <= 0.0:
        return 0.5, 0
    times = 0.5 + np.concatenate([[0.0], np.cumsum(correlation[1:] / correlation[0])])
    reached = np.flatnonzero(np.arange(series.size) >= 6.0 * times)
    window = int(reached[0]) if reached.size else series.size - 1
    return float(max(0.5, times[window])), window
