"""Correlated series: the error of their mean from blocks, and their autocorrelation time."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from gaspart.analysis.statistics.inputs import series_of


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
    return BlockAverage(
        mean=float(series.mean()),
        error=float(errors[chosen]),
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
    series = series_of("series", series, 4)
    centred = series - series.mean()
    size = 1 << (2 * series.size - 1).bit_length()
    spectrum = np.abs(np.fft.rfft(centred, size)) ** 2
    correlation = np.fft.irfft(spectrum, size)[: series.size]
    if correlation[0] <= 0.0:
        return 0.5
    times = 0.5 + np.concatenate([[0.0], np.cumsum(correlation[1:] / correlation[0])])
    reached = np.flatnonzero(np.arange(series.size) >= 6.0 * times)
    return float(max(0.5, times[reached[0] if reached.size else -1]))
