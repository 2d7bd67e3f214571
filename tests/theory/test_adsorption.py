import numpy as np
import pytest

from gaspart.theory import adsorption
from gaspart.theory.potential import packing_fraction_at


def test_the_ratio_is_that_of_two_boltzmann_integrals():
    """The density along the normal is e^depth within the well and 1 outside."""
    x = (np.arange(30000) + 0.5) * 1e-4
    density = np.where(x < 0.5, np.exp(1.3), 1.0)
    expected = density[x < 0.5].sum() / density[x > 0.5].sum()
    assert adsorption.well_ratio(1.3, 0.5, 2.5) == pytest.approx(expected, rel=1e-12)


def test_the_model_gives_its_own_length_back_and_no_constant_of_planck():
    temperature = np.array([0.5, 1.0, 2.0])
    ratio = adsorption.well_ratio(2.0 / temperature, 0.2, 1.8)
    length = adsorption.length_in_langmuirs_formula(ratio, 2.0 / temperature, 1.8)
    assert length == pytest.approx([0.2] * 3, rel=1e-13)
    planck = adsorption.planck_constant(length, 3.0, temperature)
    assert planck == pytest.approx(0.2 * np.sqrt(6.0 * np.pi * temperature))


def test_scaled_particle_theory_is_exact_to_the_second_order_and_near_the_reference():
    """ln(z / eta) = 4 eta + ... (B2 = 2 v of discs); d ln z / d ln eta = d(eta Z)/d eta, Z = (1 - eta)^-2."""
    eta = 1e-5
    assert np.log(adsorption.scaled_particle_activity(eta) / eta) == pytest.approx(4.0 * eta, rel=1e-4)
    for eta in (0.1, 0.3, 0.5):
        step = 1e-5
        low, high = adsorption.scaled_particle_activity(np.array([eta - step, eta + step]))
        slope = eta * np.log(high / low) / (2.0 * step)
        assert slope == pytest.approx((1.0 + eta) / (1.0 - eta) ** 3, rel=1e-6)
        reference = packing_fraction_at(adsorption.scaled_particle_activity(eta), 2)
        assert reference == pytest.approx(eta, rel=0.015)


def test_langmuirs_coverage():
    assert adsorption.langmuir_coverage([0.0, 1.0, 3.0]) == pytest.approx([0.0, 0.5, 0.75])


def test_the_flux_is_normalised_and_its_slow_share_is_its_integral():
    v = (np.arange(80000) + 0.5) * 1e-4
    density = adsorption.flux_density(v) * 1e-4
    assert density.sum() == pytest.approx(1.0, rel=1e-8)
    assert adsorption.slow_flux_share(1.0) == pytest.approx(density[v < 1.0].sum(), rel=1e-6)
