import numpy as np
import pytest

from gaspart import theory


def transform(g, wave_number, eta):
    """S(k) of g(r), (n,), from the diameter to five, by the trapezoid rule."""
    r = np.linspace(1.0, 4.9, len(g))
    beyond = np.trapezoid((g - 1.0) * r * np.sin(wave_number * r), r) / wave_number
    inside = (np.sin(wave_number) - wave_number * np.cos(wave_number)) / wave_number**3
    return 1.0 + 24.0 * eta * (beyond - inside)


@pytest.mark.parametrize(
    ("g", "s"),
    [
        (theory.percus_yevick_rdf, theory.percus_yevick_structure_factor),
        (theory.verlet_weis_rdf, theory.verlet_weis_structure_factor),
    ],
)
@pytest.mark.parametrize("eta", [0.02, 0.1, 0.2])
def test_the_structure_factor_is_the_transform_of_the_distribution(g, s, eta):
    values = g(np.linspace(1.0, 4.9, 40_001), eta)
    for k in (0.5, 3.0, 8.0):
        assert s(k, eta) == pytest.approx(transform(values, k, eta), abs=3e-4)


@pytest.mark.parametrize("eta", [0.05, 0.3, 0.49])
def test_percus_and_yevicks_contact_value_and_compressibility(eta):
    contact = (theory.percus_yevick_virial(eta) - 1.0) / (4.0 * eta)
    assert theory.percus_yevick_rdf(1.0, eta) == pytest.approx(contact, rel=1e-9)
    step = 1e-5
    high, low = ((eta + d) * theory.percus_yevick_compressibility(eta + d) for d in (step, -step))
    zero = theory.percus_yevick_structure_factor(0.0, eta)
    assert zero == pytest.approx(2.0 * step / (high - low), rel=1e-7)
    assert zero == pytest.approx((1.0 - eta) ** 4 / (1.0 + 2.0 * eta) ** 2, rel=1e-12)


@pytest.mark.parametrize("eta", [0.05, 0.3, 0.49])
def test_verlet_and_weis_have_carnahan_and_starlings_contact_value_and_compressibility(eta):
    contact = (theory.carnahan_starling(eta) - 1.0) / (4.0 * eta)
    assert theory.verlet_weis_rdf(1.0, eta) == pytest.approx(contact, rel=1e-9)
    step = 1e-5
    high, low = ((eta + d) * theory.carnahan_starling(eta + d) for d in (step, -step))
    near = theory.verlet_weis_structure_factor(np.array([0.0, 0.01]), eta)
    assert near == pytest.approx(2.0 * step / (high - low), rel=2e-4)


def test_to_first_order_both_are_the_overlap_of_two_spheres():
    """g(r) = 1 + rho times the volume common to two spheres of radius 1, r apart; c(r) is -1 inside."""
    eta, r = 1e-4, np.array([1.0, 1.5, 1.9, 2.1])
    common = np.where(r < 2.0, 8.0 - 6.0 * r + 0.5 * r**3, 0.0)
    for g in (theory.percus_yevick_rdf, theory.verlet_weis_rdf):
        assert g(r, eta) - 1.0 == pytest.approx(eta * common, abs=3e-7)
    assert theory.percus_yevick_rdf(0.99, eta) == 0.0 == theory.verlet_weis_rdf(0.99, eta)


def test_values_outside_their_range_are_refused():
    with pytest.raises(ValueError, match="up to 5 diameters"):
        theory.percus_yevick_rdf(5.1, 0.3)
    with pytest.raises(ValueError, match="must be above 0"):
        theory.verlet_weis_rdf(1.5, 0.0)
    with pytest.raises(ValueError, match="wave_number = -1"):
        theory.percus_yevick_structure_factor(-1.0, 0.3)
