"""The random numbers of collisions."""

import math

import numpy as np
import pytest

from gaspart.kernels.dsmc import model as draws


@pytest.mark.parametrize(
    ("key", "counter", "expected"),
    [
        ((0, 0), (0, 0, 0, 0), (0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8)),
        (
            (0xFFFFFFFF, 0xFFFFFFFF),
            (0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF),
            (0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD),
        ),
        (
            (0xA4093822, 0x299F31D0),
            (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344),
            (0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1),
        ),
    ],
)
def test_words_are_those_of_philox(key, counter, expected):
    """The known answers of the authors' library Random123 (kat_vectors), philox4x32 10."""
    trial, cell, low, high = counter
    step, block = low + (high >> 8 << 32), high & 0xFF
    found = draws.words_of.py_func(np.array(key, np.uint32), step, cell, trial, block)
    assert tuple(int(word) for word in found) == expected


def test_waiting_times_are_minus_the_logarithm():
    words = [0, 1, 2, 3, 77, 2**16, 2**31 - 1, 2**31, 2**32 - 2, 2**32 - 1]
    words += np.random.default_rng(1).integers(0, 2**32, 300).tolist()
    for word in words:
        expected = -math.log((word + 0.5) / 2**32)
        assert draws.waiting_time.py_func(np.uint64(word)) == pytest.approx(expected, rel=1e-12, abs=3e-13)
