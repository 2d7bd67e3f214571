"""Random numbers in kernels, from a key, a particle and its number of draws.

Therefore they do not depend on the order of events, or on anything else. All numbers are computed from the
random words with only +, -, x, / and the square root, as in `random`.
"""

from math import frexp, sqrt

import numpy as np

from gaspart.kernels.compile.policy import helper, kernel
from gaspart.kernels.physics.logarithm import LN2, LOG_SERIES

_M0, _M1 = np.uint64(0xD2E7470EE14C6C93), np.uint64(0xCA5A826395121157)
_W0, _W1 = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBB67AE8584CAA73B)
_HALF, _LOW, _ROUNDS = np.uint64(32), np.uint64(0xFFFFFFFF), 10
_SPARE = np.uint64(12)  # number of bits of a word that a uniform number does not use


@helper
def _product(a, b):
    """Return the 128 bits of a b as (high, low) words."""
    a_high, a_low, b_high, b_low = a >> _HALF, a & _LOW, b >> _HALF, b & _LOW
    low = a_low * b_low
    middle = a_high * b_low + (low >> _HALF)
    other = a_low * b_high + (middle & _LOW)
    return a_high * b_high + (middle >> _HALF) + (other >> _HALF), a * b


@kernel
def random_words(key, particle, number, block):
    """Return four random words of 64 bits by Philox4x64-10. The generator is by Salmon, Moraes, Dror & Shaw,
    SC11 (2011). `key`: (2,), words of the seed. `particle` and `number` and `block`: counter.
    """
    c0, c1, c2, c3 = np.uint64(block), np.uint64(number), np.uint64(particle), np.uint64(0)
    k0, k1 = key[0], key[1]
    for _ in range(_ROUNDS):
        high0, low0 = _product(_M0, c0)
        high1, low1 = _product(_M1, c2)
        c0, c1, c2, c3 = high1 ^ c1 ^ k0, low1, high0 ^ c3 ^ k1, low0
        k0 += _W0
        k1 += _W1
    return c0, c1, c2, c3


@helper
def uniform(random_bits):
    """Convert the 52 highest bits of a word to a number above 0 and below 1."""
    return (np.float64(random_bits >> _SPARE) + 0.5) * 2.0**-52


@kernel
def log_of(x):
    """Compute ln x of a positive number, with the same bits as `random.natural_log`."""
    mantissa, exponent = frexp(x)
    if mantissa < 0.7071067811865476:
        mantissa = 2.0 * mantissa
        exponent -= 1
    s = (mantissa - 1.0) / (mantissa + 1.0)
    square = s * s
    total = 0.0
    for n in range(len(LOG_SERIES) - 1, -1, -1):
        total = total * square + LOG_SERIES[n]
    return exponent * LN2 + 2.0 * s * total


@kernel
def flux_speed(key, particle, number):
    """Draw the normal speed v with density v exp(-v^2/2) of a particle that leaves a wall, in sqrt(kT/m)."""
    random_bits, _, _, _ = random_words(key, particle, number, 0)
    return sqrt(-2.0 * log_of(uniform(random_bits)))


@kernel
def normal_pair(key, particle, number, block):
    """Draw two standard normal numbers by Marsaglia's polar method. Also returns the first unused block of
    random words. `block`: first block to use, at least 1, because `flux_speed` uses block 0.
    """
    while True:
        words = random_words(key, particle, number, block)
        block += 1
        for n in (0, 2):
            u, v = 2.0 * uniform(words[n]) - 1.0, 2.0 * uniform(words[n + 1]) - 1.0
            s = u * u + v * v
            if s < 1.0:  # and above 0, because u and v are odd multiples of 2^-52
                factor = sqrt(-2.0 * log_of(s) / s)
                return u * factor, v * factor, block
