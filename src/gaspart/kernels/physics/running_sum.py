"""Running sums of the tally: as accurate after 1e10 events as after 1e6.

A plain sum in float64 loses digits as it grows. The event-driven engine adds in one fixed order and stores
the rounding error of each addition in addition to the sum (Neumaier, ZAMM 54, 39 (1974)). The time-stepped
engine adds in an order that depends on slots and threads, so it sums integers, for which the order does not
matter. Both forms are two numbers; both belong to the checkpoint, and do not depend on where a run is split.
"""

import math

import numpy as np

from gaspart.kernels.compile.policy import inner_helper

_COARSE, _FINE = 2.0**-28, 2.0**-57  # units in the largest term; each holds 2^35 such terms in 64 bits


@inner_helper
def add(sums, n, x):
    """Add x to sums (K, 2), at n, and its rounding error to their second column.

    The rounding errors are exact (Knuth, The Art of Computer Programming 2, 4.2.2). After M additions the
    relative error is at most 2^-53 + (M 2^-53)^2 of the sum of all |x|.
    """
    before = sums[n, 0]
    after = before + x
    added = after - before
    sums[n, 0] = after
    sums[n, 1] += (before - (after - added)) + (x - added)


@inner_helper
def add_whole(sum_, x, largest):
    """Add x to a sum (2,) of integers: multiples of a coarse and a fine unit.

    The fine unit counts the remainder.

    largest : power of two that few terms exceed, so that all operations except rint are exact, and the
        quotient is the same for all terms
    """
    units = x * (1.0 / largest / _COARSE)
    coarse = np.rint(units)
    sum_[0] += np.int64(coarse)
    sum_[1] += np.int64(np.rint((units - coarse) * (_COARSE / _FINE)))


def values(sums: np.ndarray) -> np.ndarray:
    """Return the values (...) of sums (..., 2) of `add`."""
    return sums[..., 0] + sums[..., 1]


def net(*sums: np.ndarray) -> float:
    """Return the total of several sums, rounded once.

    The remainder after large sums cancel is exact.
    """
    return math.fsum(np.concatenate([array.ravel() for array in sums]))


def whole_parts(sums: np.ndarray, largest: float) -> np.ndarray:
    """Convert sums (..., 2) of `add_whole` to float64, part by part."""
    return sums * np.array([largest * _COARSE, largest * _FINE])
