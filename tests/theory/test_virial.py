import numpy as np
import pytest
from scipy.integrate import quad

from gaspart import theory
from gaspart.theory.virial import linear_tail, partial_sum_uncertainty


def overlap(distance, dimension):
    """Volume common to two exclusion balls (radius 1 for diameter 1) whose centres are `distance` apart."""
    if dimension == 2:
        return 2.0 * np.arccos(distance / 2.0) - distance / 2.0 * np.sqrt(4.0 - distance**2)
    return np.pi / 12.0 * (4.0 + distance) * (2.0 - distance) ** 2


@pytest.mark.parametrize("dimension", [2, 3])
def test_second_and_third_coefficient_are_the_cluster_integrals(dimension):
    surface = {2: 2.0 * np.pi, 3: 4.0 * np.pi}[dimension]
    second = 0.5 * quad(lambda r: surface * r ** (dimension - 1), 0.0, 1.0)[0]
    third = quad(lambda r: surface * r ** (dimension - 1) * overlap(r, dimension), 0.0, 1.0)[0] / 3.0
    volume = theory.particle_volume(dimension)
    coefficients, _ = theory.virial_coefficients(dimension)
    assert coefficients[1] == pytest.approx(second / volume, rel=1e-12)
    assert coefficients[2] == pytest.approx(third / volume**2, rel=1e-10)


@pytest.mark.parametrize(("dimension", "ratio"), [(2, 0.532231807025), (3, 0.286949505982)])
def test_fourth_coefficient_is_the_published_one(dimension, ratio):
    coefficients, uncertainties = theory.virial_coefficients(dimension)
    assert coefficients[3] / coefficients[1] ** 3 == pytest.approx(ratio, rel=1e-10)
    assert np.all(uncertainties[:4] == 0.0)
    assert np.all(uncertainties[4:] > 0.0)


@pytest.mark.parametrize("dimension", [2, 3])
def test_partial_sums_reproduce_the_table(dimension, table):
    rows = table(f"eos_{dimension}d")
    computed = theory.partial_sum(rows["packing_fraction"], 10, dimension)
    np.testing.assert_allclose(computed, rows["virial_to_b10"], rtol=5e-7)


@pytest.mark.parametrize("dimension", [2, 3])
def test_tail_continues_the_coefficients_on_a_straight_line(dimension):
    coefficients, _ = theory.virial_coefficients(dimension)
    slope = coefficients[9] - coefficients[8]
    terms = [(coefficients[9] + k * slope) * 0.4 ** (9 + k) for k in range(1, 200)]
    assert linear_tail(0.4, dimension) == pytest.approx(sum(terms), rel=1e-12)


def test_partial_sum_uncertainty_is_that_of_the_uncertain_coefficients():
    _, uncertainties = theory.virial_coefficients(3)
    assert partial_sum_uncertainty(0.3, 4, 3) == 0.0
    assert partial_sum_uncertainty(0.3, 5, 3) == pytest.approx(uncertainties[4] * 0.3**4)


def test_arguments_out_of_range_are_refused():
    with pytest.raises(ValueError, match="dimension = 4"):
        theory.virial_coefficients(4)
    with pytest.raises(ValueError, match="order: 11"):
        theory.partial_sum(0.1, 11, 2)
    with pytest.raises(ValueError, match="packing_fraction"):
        theory.partial_sum([0.1, np.nan], 3, 2)


def test_coefficients_cannot_be_changed_by_a_caller():
    coefficients, _ = theory.virial_coefficients(2)
    with pytest.raises(ValueError, match="read-only"):
        coefficients[1] = 0.0
