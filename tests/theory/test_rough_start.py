"""Rough discs whose spins are 0 at first: the table, and the program that computed it."""

import numpy as np
import pytest

from gaspart import theory
from gaspart.theory.boltzmann import rough_start
from gaspart.theory.granular import ROUGH_START_UNCERTAINTY


def test_the_table_is_that_of_the_program():
    inertia, count = 0.5, 20_000
    s, difference = rough_start(count, 2.4, inertia, seed=9)
    maxwell = np.exp(-3.0 * inertia / (1.0 + inertia) ** 2 * s)
    excess = (difference - maxwell)[(s > 1.8) & (s < 2.4)].mean()
    tabulated = float(np.mean(theory.rough_start_excess(inertia, np.array([1.8, 2.0, 2.2, 2.4]))))
    # 10 times fewer discs; that Maxwellian velocities throughout would give 0 is beyond its scatter.
    assert excess == pytest.approx(tabulated, abs=3.0 * ROUGH_START_UNCERTAINTY * np.sqrt(1.0 + 10.0))
    assert tabulated > 3.0 * ROUGH_START_UNCERTAINTY


def test_it_starts_at_nothing_and_states_where_it_was_not_computed():
    assert theory.rough_start_excess(0.5, 0.0) == 0.0
    assert np.isnan(theory.rough_start_excess(0.5, 100.0))
    assert np.isnan(theory.rough_start_excess(0.3, np.array([0.0, 1.0]))).all()
