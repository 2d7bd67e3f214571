import math

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import claim
from scipy.special import stdtr

from gaspart.reproduction.claims import (
    UNVERIFIED,
    Claim,
    Estimate,
    judge,
)

COMMON = {"source": "theory", "fails_if": "it is not"}


def test_uncertainties_are_propagated():
    three, four = Estimate(3.0, 0.3), Estimate(4.0, 0.4)
    assert three + four == Estimate(7.0, 0.5)
    assert three - four == Estimate(-1.0, 0.5)
    assert -three == Estimate(-3.0, 0.3)
    product, ratio = three * four, three / four
    assert product.value == 12.0
    assert product.error == pytest.approx(12.0 * math.hypot(0.1, 0.1))
    assert ratio.value == 0.75
    assert ratio.error == pytest.approx(0.75 * math.hypot(0.1, 0.1))
    estimate = Estimate(3.0, 0.5)  # a plain number is exact
    assert estimate + 1.0 == Estimate(4.0, 0.5)
    assert estimate - np.float64(1.0) == Estimate(2.0, 0.5)
    assert estimate * -2.0 == Estimate(-6.0, 1.0)
    assert estimate / xr.DataArray(-2.0) == Estimate(-1.5, 0.25)


def test_a_deviation_of_few_samples_is_students():
    few = Claim(claim="Z", measured=Estimate(4.0, 1.0, 3), expected=0.0, required=2.0, **COMMON)
    # P(|t| > 4) with 3 degrees of freedom is 0.0280: 2.197 standard deviations of a Gaussian
    assert few.p_value == pytest.approx(0.0280, abs=1e-4)
    assert few.deviation_sigma == pytest.approx(2.197, abs=2e-3)
    assert judge([few]) == ["agrees"]
    known = Claim(claim="Z", measured=Estimate(4.0, 1.0), expected=0.0, required=2.0, **COMMON)
    assert judge([known]) == ["disagrees"]
    for far in (1e3, -1e6):
        strange = Claim(claim="Z", measured=Estimate(far, 1.0, 40), expected=0.0, required=2.0, **COMMON)
        assert math.isfinite(strange.deviation_sigma) and strange.deviation_sigma * far > 0.0


def test_an_allowance_needs_a_source():
    with pytest.raises(ValueError, match=r"allowance_source: empty \(the allowance 0\.1"):
        Claim(claim="Z", measured=Estimate(1.0), expected=Estimate(1.0, 0.1), required=1.0, **COMMON)
    cited = claim(1.0, expected=Estimate(1.0, 0.1))
    assert cited.allowance_source
    assert not cited.is_scattered
    assert claim(1.0, 0.01, expected=Estimate(1.0, 0.001)).is_scattered


def test_only_tests_of_values_scatter_as_gaussians():
    assert claim().is_scattered and claim().form == "value"
    band = Claim.within(claim="Z", measured=Estimate(1.0, 0.1), expected=1.0, half_width=1.0, **COMMON)
    joint = Claim.joint(claim="Z", deviations=[1.0, 1.0], **COMMON)
    assert (band.form, joint.form) == ("bound", "distribution")
    others = claim(kind="reproduction"), claim(error=math.nan), claim(error=0.0), claim(no_verdict=UNVERIFIED)
    assert not any(one.is_scattered for one in (band, joint, *others))


def test_a_chi_square_whose_uncertainty_comes_from_few_samples_is_fishers():
    """With one deviation it is Student's t, and with many samples the chi-square itself."""
    few = Claim.chi_square(claim="Z", chi_square=9.0, degrees_of_freedom=1, error_freedom=7, **COMMON)
    assert few.p_value == pytest.approx(2.0 * 2.0 * stdtr(7, -3.0))  # two-sided, |t| > 3
    many = Claim.chi_square(claim="Z", chi_square=9.0, degrees_of_freedom=4, error_freedom=1e9, **COMMON)
    exact = Claim.chi_square(claim="Z", chi_square=9.0, degrees_of_freedom=4, **COMMON)
    assert many.deviation_sigma == pytest.approx(exact.deviation_sigma, abs=1e-6)


def test_deviation_combines_both_uncertainties():
    assert claim(1.05, 0.03, expected=Estimate(1.0, 0.04)).deviation_sigma == pytest.approx(1.0)
    assert claim(0.95, 0.05).deviation_sigma == pytest.approx(-1.0)
    assert math.isnan(claim(expected=math.nan).deviation_sigma)


def test_bounds():
    def least(value):
        measured = Estimate(value, 0.001)
        return judge([Claim.at_least(claim="d", measured=measured, bound=0.60, required=0.01, **COMMON)])

    def most(value):
        measured = Estimate(value, 0.001)
        return judge([Claim.at_most(claim="d", measured=measured, bound=0.60, required=0.01, **COMMON)])

    assert [least(value) for value in (0.61, 0.598, 0.59)] == [["agrees"], ["inconclusive"], ["disagrees"]]
    assert [most(value) for value in (0.59, 0.602, 0.61)] == [["agrees"], ["inconclusive"], ["disagrees"]]


def test_a_band():
    def within(*measured, **others):
        others = {"claim": "exponent", "expected": 1.0, "half_width": 0.05} | COMMON | others
        return Claim.within(measured=Estimate(*measured), **others)

    exponent = within(1.03, 0.01)
    assert exponent.deviation_sigma == 0.0
    assert exponent.required == pytest.approx(0.025)
    assert exponent.claim == "exponent (within 0.95 to 1.05)"
    assert judge([exponent]) == ["agrees"]
    beyond = within(1.09, 0.01)
    assert beyond.deviation_sigma == pytest.approx(4.0)
    assert judge([beyond]) == ["disagrees"]
    assert judge([within(1.0, 0.03)]) == ["inconclusive"]
    assert judge([within(2.0, 0.03)]) == ["disagrees"]
    assert judge([within(1.0, 0.03, required=0.03)]) == ["agrees"]


def test_exact_numbers_have_no_spread():
    assert judge([claim(3.0, 0.0, 0.0, 3.0)]) == ["agrees"]
    assert judge([claim(4.0, 0.0, 0.0, 3.0)]) == ["disagrees"]
    assert claim(2.0, 0.0, 0.0, 3.0).deviation_sigma == -math.inf


def test_chi_square_claim_is_two_sided():
    def of(value):
        return Claim.chi_square(claim="Maxwell", chi_square=value, degrees_of_freedom=100, **COMMON)

    assert of(100.0).measured.value == 1.0
    assert abs(of(99.33).deviation_sigma) < 0.01  # the median
    assert judge([of(100.0)]) == ["agrees"]
    assert judge([of(160.0)]) == ["disagrees"]
    assert of(160.0).deviation_sigma > 3.0
    assert judge([of(50.0)]) == ["disagrees"]
    assert of(50.0).deviation_sigma < -3.0
    assert judge([of(1e5)]) == ["disagrees"]


def test_joint_deviations_are_judged_by_their_chi_square():
    deviations = np.array([[1.0, -2.0], [0.5, 0.0]])
    joint = Claim.joint(claim="Z", deviations=xr.DataArray(deviations), **COMMON)
    text = "Z (chi-square per degree of freedom)"
    assert joint == Claim.chi_square(claim=text, chi_square=5.25, degrees_of_freedom=4, **COMMON)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "guess"}, "kind: 'guess'"),
        ({"text": " "}, "claim: empty"),
        ({"source": ""}, "source: empty"),
        ({"fails_if": ""}, "fails_if: empty"),
        ({"required": -1.0}, "required: -1"),
    ],
)
def test_malformed_claims_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        claim(**change)
