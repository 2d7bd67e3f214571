"""Contact values of few particles: exact, by the table, and by the expansion with its remainder."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart import theory
from gaspart.theory.finite_size import finite_size_remainder, insertion_potential, pair_contact_value
from gaspart.theory.tables import insertion_finite_size_correction

KNOWN = [(3, 108, 0.5113, 13.74, 0.03), (3, 108, 0.47, 10.562, 0.020)]
"""Z of other runs of the event-driven engine: dimension, number, packing fraction, Z and its error."""


@pytest.mark.parametrize(("dimension", "count", "eta", "known", "error"), KNOWN)
def test_z_of_a_number_is_that_of_other_runs(dimension, count, eta, known, error):
    value, uncertainty = theory.finite_contact_value(eta, dimension, count)
    scale = 2.0 ** (dimension - 1) * eta * (1.0 - 1.0 / count)
    assert abs(1.0 + scale * value - known) < 4.0 * math.hypot(error, scale * uncertainty)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_remainder_covers_the_table(dimension):
    rows = theory.small_systems("contact_value", dimension)
    rows = rows[(rows["count"] >= 4)]
    side = (rows["count"] * theory.particle_volume(dimension) / rows.packing_fraction) ** (1.0 / dimension)
    rows, side = rows[side >= 2.2], side[side >= 2.2]
    eta, count = rows.packing_fraction, rows["count"]
    excess = theory.compressibility_factor(eta, dimension) - 1.0
    shifts = [theory.finite_size_correction(x, dimension, int(n)) for x, n in zip(eta, count, strict=True)]
    expansion = (excess + shifts) / (2.0 ** (dimension - 1) * eta)
    known = np.hypot(theory.compressibility_uncertainty(eta, dimension) / excess, (shifts / excess) ** 2)
    left = finite_size_remainder(eta, dimension, side)
    z = (rows.value / expansion - 1.0) / np.sqrt(left**2 + known**2 + (rows.error / expansion) ** 2)
    assert len(rows) > 30 and np.abs(z).max() < 4.0 and 0.5 < np.sqrt(np.mean(z**2)) < 1.3


@pytest.mark.parametrize("dimension", [2, 3])
def test_two_particles_have_a_closed_form(dimension):
    assert pair_contact_value(0.1, dimension) == pytest.approx(1.0 / (1.0 - 2.0 ** (dimension - 1) * 0.1))
    rows = theory.small_systems("contact_value", dimension)
    rows = rows[rows["count"] == 2]
    for row in rows[rows.packing_fraction < 0.37] if dimension == 3 else rows:
        exact = float(pair_contact_value(row.packing_fraction, dimension))
        assert abs(row.value - exact) < 4.0 * row.error
    assert theory.finite_contact_value(0.1, dimension, 2)[1] == 0.0


def test_nothing_is_stated_where_the_expansion_fails():
    with pytest.raises(gp.SceneError, match="uncertain by .* nothing is stated above 10 %"):
        theory.finite_contact_value(0.5, 3, 7)
    with pytest.raises(gp.SceneError, match="count = 1"):
        theory.finite_contact_value(0.1, 3, 1)
    with pytest.raises(gp.SceneError, match="uncertain by"):
        insertion_potential(0.49, 3, 8, 2.04)


def test_insertion_beside_one_particle_is_exact_and_uncertain_beside_many():
    assert insertion_potential(0.05, 3, 1, 2.2) == (-math.log(1.0 - 0.4), 0.0)
    value, error = insertion_potential(0.3, 3, 500, 9.55)
    known = float(theory.excess_chemical_potential(0.3, 3) + insertion_finite_size_correction(0.3, 3, 500))
    assert value == pytest.approx(known) and 0.0 < error < 1e-3 * value
    assert insertion_potential(0.45, 3, 64, 4.21)[1] > 20.0 * error
