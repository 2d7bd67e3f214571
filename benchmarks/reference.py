"""What the machine itself can do: by these two numbers a timing is carried from one machine to another."""

from __future__ import annotations

import time

import numba
import numpy as np

WORDS = 1 << 24
"""Of 8 bytes, so that no cache holds them."""


def copy_bandwidth(words: int = WORDS, repeats: int = 5) -> float:
    """GB/s of a copy, read and written bytes together; the median of the repeats."""
    source, target = np.ones(words), np.empty(words)
    seconds = []
    for _ in range(repeats + 1):  # the first touches the memory
        start = time.perf_counter()
        np.copyto(target, source)
        seconds.append(time.perf_counter() - start)
    return 16e-9 * words / float(np.median(seconds[1:]))


@numba.njit
def _follow(following, steps):
    at = 0
    for _ in range(steps):
        at = following[at]
    return at


def read_latency(words: int = WORDS, steps: int = 1_000_000, repeats: int = 5) -> float:
    """ns of a read whose address the one before holds, anywhere in memory; the median of the repeats."""
    order = np.random.default_rng(1).permutation(words)
    following = np.empty(words, dtype=np.int64)
    following[order] = np.roll(order, -1)  # one ring through all words
    _follow(following, 1)
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        _follow(following, steps)
        seconds.append(time.perf_counter() - start)
    return 1e9 * float(np.median(seconds)) / steps
