"""Sums of counters that are as accurate after 1e10 events as after 1e6.

A plain float64 sum loses digits as it grows. The event-driven engine adds in a fixed order. It stores the
rounding errors of the additions in a second number (Neumaier, ZAMM 54, 39 (1974)). The time-stepped engine
adds in an order that depends on slots and threads. Therefore it sums integers, for which the order does not
matter. In both cases a sum consists of two numbers. Checkpoints contain both numbers, so that the sum does
not depend on interruptions of a run.
"""

import math

import numpy as np

from gaspart.kernels.compile.policy import inner_helper

_COARSE, _FINE = 2.0**-28, 2.0**-57  # units in the largest term; 64 bits hold 2^35 such terms


@inner_helper
def add(sums, n, x):
    """Add x to entry n of sums (K, 2), and the rounding error to column 1. The rounding errors are exact
    (Knuth, The Art of Computer Programming 2, 4.2.2). After M additions the error is at most 2^-53 + (M
    2^-53)^2 times the sum of all |x|.
    """
    before = sums[n, 0]
    after = before + x
    added = after - before
    sums[n, 0] = after
    sums[n, 1] += (before - (after - added)) + (x - added)


@inner_helper
def add_whole(sum_, x, largest):
    """Add x to a sum (2,) of integers, which count a coarse and a fine unit. The fine unit counts the
    remainder. `largest`: power of two that few terms exceed. So all operations except rint are exact, and the
    quotient is the same for all terms.
    """
    units = x * (1.0 / largest / _COARSE)
    coarse = np.rint(units)
    sum_[0] += np.int64(coarse)
    sum_[1] += np.int64(np.rint((units - coarse) * (_COARSE / _FINE)))


def values(sums: np.ndarray) -> np.ndarray:
    """Return the values (...) of sums (..., 2) made by `add`."""
    return sums[..., 0] + sums[..., 1]


def net(*sums: np.ndarray) -> float:
    """Return the total of several sums, rounded once. If large sums cancel, the remainder is exact."""
    return math.fsum(np.concatenate([array.ravel() for array in sums]))


def whole_parts(sums: np.ndarray, largest: float) -> np.ndarray:
    """Convert sums (..., 2) of `add_whole` to float64, both parts separately."""
    return sums * np.array([largest * _COARSE, largest * _FINE])
