"""What a run gives in each interval between its frames, and in blocks of them."""

from __future__ import annotations

import numpy as np


def over(values: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """(K, ...) sums of values (T - 1, ...) of intervals between the frames `ends` (K + 1,)."""
    return np.add.reduceat(values[: ends[-1]], ends[:-1], axis=0)
