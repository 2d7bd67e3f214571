"""Direct simulations of homogeneous gases, and the tables that they have made or confirm."""

import numpy as np
import pytest

from gaspart import theory
from gaspart.theory.boltzmann import homogeneous_gas, rough_discs, rough_start
from gaspart.theory.granular import ROUGH_START_UNCERTAINTY


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_tables_of_relaxation_are_those_of_the_program(dimension):
    count = 40_000
    gas = homogeneous_gas(count, dimension, 3.6, seed=4)
    table = theory.relaxation(dimension)
    for s in (0.6, 1.2, 2.4, 3.6):
        at = np.searchsorted(gas.collisions, s) - 1
        where = float(gas.collisions[at])
        # <v^8> of a Maxwellian bounds the scatter of <v^4>: 4 sigma of so many particles, and the time step
        assert gas.kurtosis[at] == pytest.approx(table.kurtosis(where), abs=4.0 * 2.5 / count**0.5)
        assert gas.never_hit[at] == pytest.approx(table.never_hit(where), abs=4.0 * 0.5 / count**0.5)
    assert gas.energy == pytest.approx(np.ones(len(gas.energy)), rel=1e-10)


def test_the_cumulant_of_a_cooling_gas_is_that_of_the_program():
    gas = homogeneous_gas(40_000, 2, 10.0, restitution=0.5, seed=5)
    late = gas.collisions > 4.0  # steady from there on
    cumulant = 0.5 * gas.kurtosis[late].mean() - 1.0
    # The theory is of first order in a2, 0.08 here, and too high by some of it at a restitution this low.
    assert 0.5 * theory.fourth_cumulant(0.5, 2) < cumulant < theory.fourth_cumulant(0.5, 2)
    rate = -np.polyfit(gas.collisions[late], np.log(gas.energy[late]), 1)[0]
    assert rate == pytest.approx(float(theory.cooling_rate(0.5, 2)), rel=0.01)


def test_the_table_of_rough_cooling_is_that_of_the_program():
    ratios = rough_discs(10_000, 20.0, 0.5, 0.0, seed=6)
    late = ratios[len(ratios) * 2 // 5 :]
    ((_, _, _, tabulated, error),) = [row for row in theory.rough_cooling() if row[1] == 0.0]
    # the table is of 24 times as many discs (6 gases of 40 000), over 40 collisions of a disc instead of 12
    assert late.mean() == pytest.approx(tabulated, abs=3.0 * error * np.sqrt(1.0 + 24.0 * 40.0 / 12.0))


def test_perfectly_rough_discs_keep_equipartition():
    assert rough_discs(20_000, 1.0, 0.5, 1.0, seed=7) == pytest.approx(1.0, abs=0.04)


@pytest.mark.parametrize("tangential", [-0.5, 0.0, 0.5, 0.8])
def test_rough_discs_that_cool_have_less_spin_than_if_they_were_maxwellian(tangential):
    ((*_, ratio, error),) = [row for row in theory.rough_cooling() if row[1] == tangential]
    assert 0.95 < (ratio + 3.0 * error) / theory.rough_ratio(0.5, tangential) < 1.001


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
