"""The speed on several cores by Amdahl's law, with threads that take time to begin."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

SLABS = {"DSMC, Enskog": 8**3 * 64}
"""The engine of which threads share collisions by slabs of cells, and the number of particles from which on
two threads have one each at a time (docs/dsmc.md). Fewer do not share them, and more threads share them
unevenly, which Amdahl's law does not know."""


def speed_up(cores: ArrayLike, count: ArrayLike, serial: float, overhead: float) -> np.ndarray:
    """Compute the speed-up of p cores for N particles by Amdahl's law.

    It is 1 / (s + (1 - s) / p + N_0 / N).

    The law is from (AFIPS Conf. Proc. 30, 483 (1967)).

    serial : fraction s of the work that one core does alone.
    overhead : N_0, number of particles whose work on one core takes the time in which threads are begun and
        awaited.
    """
    shared, waited = (1.0 - serial) / np.asarray(cores), overhead / np.asarray(count)
    return np.asarray(1.0 / (serial + shared + waited))
