"""Exact sums of float64 numbers of any size, independent of the order of addition.

A sum is a row of integers, the digits of a number in base 2^32 (Kulisch, Computer Arithmetic and Validity
(2013), ch. 8). Digit n counts units of 2^(32 n - 1074), so the digits can represent every float64. Each term
is added to three of the digits, without carries. The last integer of a row counts the terms since the last
carry. Carries are performed before a digit can overflow, and nothing is rounded. Sums of threads are added
digit by digit.
"""

import math

import numpy as np

from gaspart.kernels.compile.policy import inner_helper, kernel

DIGITS = 68
WIDTH = DIGITS + 1
"""Number of integers in a sum: its digits, of which the last contains the sign, and the number of terms."""
_BITS, _LOWEST = 32, -1074
_MASK, _FRACTION, _HIDDEN, _EXPONENT = 2**32 - 1, 2**52 - 1, 2**52, 2**11 - 1
_MOST_TERMS = 2**29  # a term adds less than 2^33 to a digit
UNITS = np.array([math.ldexp(1.0, _BITS * n + _LOWEST) if n < 66 else 0.0 for n in range(DIGITS)])
"""Units of the digits. The units of the two highest digits, which only carries reach, exceed every float64.
"""


@inner_helper
def carry(total):
    """Perform carries, so that each digit except the last is between 0 and 2^32 - 1."""
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
    bits = np.float64(x).view(np.int64)
    exponent, mantissa = (bits >> 52) & _EXPONENT, bits & _FRACTION
    if exponent > 0:
        mantissa |= _HIDDEN
        exponent -= 1
    n, shift = exponent >> 5, exponent & 31
    low, high = (mantissa & _MASK) << shift, (mantissa >> _BITS) << shift
    middle = (low >> _BITS) + (high & _MASK)
    if bits < 0:
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
    """Return the rounded sum a + b and its rounding error."""
    total = a + b
    added = total - a
    return total, (a - (total - added)) + (b - added)


@kernel
def join(parts, total):
    """Set total (K, WIDTH) to the sum of parts (threads, K, WIDTH), with carries. Afterwards the digits
    depend only on the value of the sum.
    """
    total[...] = 0
    for part in range(parts.shape[0]):
        for k in range(parts.shape[1]):
            carry(parts[part, k])
            for n in range(DIGITS):
                total[k, n] += parts[part, k, n]
            carry(total[k])


@kernel
def evaluate(sums, units, values):
    """Set values (K, 2) to the values of sums (K, WIDTH), whose digits are overwritten. A value consists of
    the nearest float64 and the remainder, with a relative accuracy of 2^-64. `units`: `UNITS`.
    """
    for k in range(len(sums)):
        total = sums[k]
        sign, top = _magnitude(total), DIGITS - 1
        while top > 2 and total[top] == 0:
            top -= 1
        for n in range(top - 2):
            if total[n] != 0:
                total[top - 2] |= 1  # decides if the digits are exactly between two float64
        value = rest = 0.0
        for n in range(3):  # at least 65 bits, and few enough for two float64
            value, error = _two_sum(value, total[top - n] * units[top - n])
            rest += error
        value, rest = _two_sum(value, rest)
        values[k, 0], values[k, 1] = sign * value, sign * rest


def sum_over_threads(parts: np.ndarray) -> np.ndarray:
    """Return the sum (..., WIDTH) over threads of (threads, ..., WIDTH)."""
    total = np.empty(parts.shape[1:], np.int64)
    join(parts.reshape(len(parts), -1, WIDTH), total.reshape(-1, WIDTH))
    return total


def exact_parts(parts: np.ndarray) -> np.ndarray:
    """Return the values (..., 2) of sums (threads, ..., WIDTH): nearest float64 and remainder."""
    total = sum_over_threads(parts)
    values = np.empty((*total.shape[:-1], 2))
    evaluate(total.reshape(-1, WIDTH), UNITS, values.reshape(-1, 2))
    return values
