"""Exact sums of float64 numbers of any size, independent of the order of addition.

A sum is a row of whole numbers, the digits of a number in base 2^32 (Kulisch, Computer Arithmetic and
Validity (2013), ch. 8): digit n counts units of 2^(32 n - 1074), so that the digits hold every float64. Each
term is added to three of them, without a carry. The last number of a row counts the terms since the last
carry; carries are made in time, so that nothing overflows and nothing is rounded. Sums of threads are added
digit by digit.
"""

from __future__ import annotations

import math

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, kernel

DIGITS = 68
WIDTH = DIGITS + 1
"""Number of whole numbers of a sum: its digits, the last of which has the sign, and the count of terms."""
_BITS, _LOWEST = 32, -1074
_MASK, _FRACTION, _HIDDEN, _EXPONENT = 2**32 - 1, 2**52 - 1, 2**52, 2**11 - 1
_MOST_TERMS = 2**29  # a term adds less than 2^33 to a digit
UNITS = np.array([math.ldexp(1.0, _BITS * n + _LOWEST) if n < 66 else 0.0 for n in range(DIGITS)])
"""Units of the digits; the units of the highest two, which only carries reach, are above any float64."""


@inner_helper
def carry(total):
    """Carry, so that each digit except the last is from 0 to 2^32 - 1."""
    above = np.int64(0)
    for n in range(DIGITS - 1):
        digit = total[n] + above
        above = digit >> _BITS
        total[n] = digit & _MASK
    total[DIGITS - 1] += above
    total[DIGITS] = 0


@inner_helper
def add_exact(total, x):
    """Add a finite number to a sum (WIDTH,)."""
    word = np.float64(x).view(np.int64)
    exponent, mantissa = (word >> 52) & _EXPONENT, word & _FRACTION
    if exponent > 0:
        mantissa |= _HIDDEN
        exponent -= 1
    n, shift = exponent >> 5, exponent & 31
    low, high = (mantissa & _MASK) << shift, (mantissa >> _BITS) << shift
    middle = (low >> _BITS) + (high & _MASK)
    if word < 0:
        total[n] -= low & _MASK
        total[n + 1] -= middle
        total[n + 2] -= high >> _BITS
    else:
        total[n] += low & _MASK
        total[n + 1] += middle
        total[n + 2] += high >> _BITS
    total[DIGITS] += 1
    if total[DIGITS] >= _MOST_TERMS:
        carry(total)


@inner_helper
def _magnitude(total):
    """Replace the digits of a sum by the digits of its absolute value; return its sign."""
    carry(total)
    if total[DIGITS - 1] >= 0:
        return 1.0
    for n in range(DIGITS):
        total[n] = -total[n]
    carry(total)
    return -1.0


@inner_helper
def _two_sum(a, b):
    """Return a + b, rounded, and the rounding error."""
    total = a + b
    added = total - a
    return total, (a - (total - added)) + (b - added)


@kernel
def join(parts, total):
    """Set total (K, WIDTH) to the sum of parts (threads, K, WIDTH), with carries.

    The digits then depend only on the value of the sum.
    """
    total[...] = 0
    for part in range(parts.shape[0]):
        for k in range(parts.shape[1]):
            carry(parts[part, k])
            for n in range(DIGITS):
                total[k, n] += parts[part, k, n]
            carry(total[k])


@kernel
def evaluate(sums, units, found):
    """Set found (K, 2) to the values of sums (K, WIDTH), whose digits are overwritten.

    A value is the nearest float64, and the remainder, to 2^-64 of the value.

    units : `UNITS`
    """
    for k in range(len(sums)):
        total = sums[k]
        sign, top = _magnitude(total), DIGITS - 1
        while top > 2 and total[top] == 0:
            top -= 1
        for n in range(top - 2):
            if total[n] != 0:
                total[top - 2] |= 1  # decides if the digits are half-way between two float64
        value = rest = 0.0
        for n in range(3):  # 65 bits at least, and few enough for two float64 to hold
            value, error = _two_sum(value, total[top - n] * units[top - n])
            rest += error
        value, rest = _two_sum(value, rest)
        found[k, 0], found[k, 1] = sign * value, sign * rest


def joined(parts: np.ndarray) -> np.ndarray:
    """Return the sum (..., WIDTH) over threads of (threads, ..., WIDTH)."""
    total = np.empty(parts.shape[1:], np.int64)
    join(parts.reshape(len(parts), -1, WIDTH), total.reshape(-1, WIDTH))
    return total


def exact_parts(parts: np.ndarray) -> np.ndarray:
    """Return the values (..., 2) of sums (threads, ..., WIDTH): nearest float64 and remainder."""
    total = joined(parts)
    found = np.empty((*total.shape[:-1], 2))
    evaluate(total.reshape(-1, WIDTH), UNITS, found.reshape(-1, 2))
    return found


# Running sums of the tally: as accurate after 1e10 events as after 1e6.
#
# A plain sum in float64 loses digits as it grows. The event-driven engine adds in one fixed order and stores
# the rounding error of each addition in addition to the sum (Neumaier, ZAMM 54, 39 (1974)). The time-stepped
# engine adds in an order that depends on slots and threads, so it sums integers, for which the order does not
# matter. Both forms are two numbers; both belong to the checkpoint, and do not depend on where a run is
# split.


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
    whole = np.rint(units)
    sum_[0] += np.int64(whole)
    sum_[1] += np.int64(np.rint((units - whole) * (_COARSE / _FINE)))


def values(sums: np.ndarray) -> np.ndarray:
    """Return the values (...) of sums (..., 2) of `add`."""
    return sums[..., 0] + sums[..., 1]


def net(*sums: np.ndarray) -> float:
    """Return the total of several sums, rounded once.

    The remainder after large sums cancel is exact.
    """
    return math.fsum(np.concatenate([one.ravel() for one in sums]))


def whole_parts(sums: np.ndarray, largest: float) -> np.ndarray:
    """Convert sums (..., 2) of `add_whole` to float64, part by part."""
    return sums * np.array([largest * _COARSE, largest * _FINE])
