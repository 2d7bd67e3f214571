"""Random numbers of the collisions: a function of a key, the step, the cell and the trial, and of nothing
else."""

import numpy as np

from gaspart.kernels.compile.policy import inner_helper
from gaspart.kernels.physics.logarithm import LN2, LOG_SERIES

_M0, _M1 = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
_W0, _W1 = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)
_LOW, _HALF, _ROUNDS = np.uint64(0xFFFFFFFF), np.uint64(32), 10
_BLOCK_BITS = np.uint64(8)  # of the counter's last word; what is above counts steps
_TABLE_BITS = 7
_WORD = 2.0**-32


def _natural_log(x: float) -> float:
    """ln x of a number near 1, by +, -, x and / alone."""
    s = (x - 1.0) / (x + 1.0)
    total = 0.0
    for coefficient in reversed(LOG_SERIES):
        total = total * s * s + coefficient
    return 2.0 * s * total


_CENTRES = [1.0 + (n + 0.5) / 2**_TABLE_BITS for n in range(2**_TABLE_BITS)]
_INVERSES = np.array([1.0 / x for x in _CENTRES])
_LOGS = np.array([_natural_log(x / 1.5) + _natural_log(1.2) + _natural_log(1.25) for x in _CENTRES])
"""Logarithms of numbers from 1 to 2, and inverses, at the centres of 128 equal parts."""


@inner_helper
def words_of(key, step, cell, trial, block):
    """Four random words of 32 bits, each in 64: Philox4x32-10 (Salmon, Moraes, Dror & Shaw, SC11 (2011)).

    key: (2,) words of 32 bits; step below 2^53, cell and trial below 2^32, block below 2^8: the counter.
    """
    number = np.uint64(step)
    c0, c1, c2 = np.uint64(trial), np.uint64(cell), number & _LOW
    c3 = ((number >> _HALF) << _BLOCK_BITS) | np.uint64(block)
    k0, k1 = np.uint64(key[0]), np.uint64(key[1])
    for _ in range(_ROUNDS):
        one, other = _M0 * c0, _M1 * c2
        c0, c1 = (other >> _HALF) ^ c1 ^ k0, other & _LOW
        c2, c3 = (one >> _HALF) ^ c3 ^ k1, one & _LOW
        k0 = (k0 + _W0) & _LOW
        k1 = (k1 + _W1) & _LOW
    return c0, c1, c2, c3


@inner_helper
def fraction(word):
    """A number above 0 and below 1, from a word of 32 bits."""
    return (np.float64(word) + 0.5) * _WORD


@inner_helper
def below(word, count):
    """A whole number from 0 to count - 1, from a word of 32 bits; the chances differ by count / 2^32."""
    return np.int64((word * np.uint64(count)) >> _HALF)


@inner_helper
def waiting_time(word):
    """An exponential random number of mean 1, from a word of 32 bits: -ln of `fraction`, to 1e-12.

    The word's leading bits choose an entry of a table, and a series does the rest.
    """
    bits = np.float64(np.float64(word) + 0.5).view(np.int64)
    exponent = (bits >> 52) - 1023
    entry = (bits >> (52 - _TABLE_BITS)) & ((1 << _TABLE_BITS) - 1)
    mantissa = np.int64((bits & ((1 << 52) - 1)) | (1023 << 52)).view(np.float64)
    r = mantissa * _INVERSES[entry] - 1.0
    series = r * (1.0 - r * (0.5 - r * (1.0 / 3.0 - r * (0.25 - r * 0.2))))
    return (32 - exponent) * LN2 - (_LOGS[entry] + series)
