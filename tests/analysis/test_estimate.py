"""Estimates of arrays: each element is propagated as a single number, bit by bit."""

import operator

import numpy as np
import pytest
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics import average, combine, combine_estimates, fit_polynomial

MANY = Estimate([2.0, -3.0, 0.5], [0.1, 0.0, 0.7], [3, np.inf, 12])
OTHER = Estimate([1.5, 4.0, 1e3], [0.2, 0.4, 0.0], [5, 7, np.inf])
OPERATIONS = [operator.add, operator.sub, operator.mul, operator.truediv]


@pytest.mark.parametrize("operation", OPERATIONS)
@pytest.mark.parametrize("other", [OTHER, OTHER[0], 2.5, np.array([2.5, -1.0, 3.0])])
def test_arithmetic_is_that_of_the_elements(operation, other):
    others = list(other) if isinstance(other, np.ndarray) or other is OTHER else [other] * 3
    assert list(operation(MANY, other)) == [operation(*pair) for pair in zip(MANY, others, strict=True)]
    assert list(operation(other, MANY)) == [
        operation(Estimate(one) if not isinstance(one, Estimate) else one, mine)
        for one, mine in zip(others, MANY, strict=True)
    ]


def test_welch_and_satterthwaite_by_hand():
    total = MANY[:1] + OTHER[:1]
    assert total.error[0] == pytest.approx(np.sqrt(0.05))
    assert total.freedom[0] == pytest.approx(0.05**2 / (0.1**4 / 3 + 0.2**4 / 5))


def test_deviations_are_those_of_the_elements():
    assert MANY.deviation.tolist() == [one.deviation for one in MANY]
    assert MANY.deviation[1] == -np.inf and 0.0 < MANY.deviation[0] < 20.0


def test_it_is_indexed_stacked_and_compared_as_its_elements():
    assert len(MANY) == 3 and MANY[[True, False, True]] == Estimate.stack([MANY[0], MANY[2]])
    assert MANY != OTHER and MANY[0] == Estimate(2.0, 0.1, 3) and hash(MANY[0]) == hash(Estimate(2.0, 0.1, 3))
    assert str(MANY[::2]) == "[2.00(10), 0.50(70)]"
    assert not Estimate.stack([]) and MANY and Estimate(0.0)
    with pytest.raises(TypeError):
        len(MANY[0])
    with pytest.raises(TypeError):
        hash(MANY)
    with pytest.raises(ValueError, match="read-only"):
        MANY.value[0] = 1.0


@pytest.mark.parametrize("wrong", [{"error": [0.1, -0.1]}, {"freedom": [1, 0]}])
def test_one_wrong_element_is_refused(wrong):
    with pytest.raises(ValueError, match="must"):
        Estimate([1.0, 2.0], **wrong)


def test_of_a_dataset_with_degrees_of_freedom_for_each_row():
    values, errors = np.arange(6.0).reshape(2, 3), np.full((2, 3), 0.1)
    dataset = xr.Dataset({"Z": (("gas", "bin"), values), "Z_error": (("gas", "bin"), errors)})
    assert Estimate.of(dataset, "Z") == Estimate(values, errors)
    dataset["Z_freedom"] = ("gas", [4.0, np.nan])  # NaN: not stated
    assert Estimate.of(dataset, "Z") == Estimate(values, errors, [[4.0], [np.inf]])


def test_means_and_fits_take_an_array():
    known = MANY[[0, 2]]
    assert combine_estimates(known) == combine_estimates(list(known)) == combine(known).estimate
    assert known.weights @ known.value == pytest.approx(combine_estimates(known).value)
    assert average(MANY) == average(list(MANY))
    assert np.isnan(combine_estimates([]).value)
    y = Estimate([1.0, 2.1, 2.9], [0.1, 0.2, 0.1], [3, 4, 5])
    fit = fit_polynomial([0, 1, 2], y)
    same = fit_polynomial([0, 1, 2], y.value, y.error, freedoms=y.freedom)
    assert fit.estimates == same.estimates and fit.estimate(1) == fit.estimates[1]
