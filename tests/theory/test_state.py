import math
import subprocess
import sys

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

import gaspart as gp
from gaspart import theory
from gaspart.theory.state import adiabatic_temperature, constant_enthalpy_factor

EQUATIONS = {2: ["henderson", "liu"], 3: ["carnahan_starling", "kolafa_1986", "kolafa_labik_malijevsky"]}
NAMED = [(dimension, name) for dimension, names in EQUATIONS.items() for name in names]


def coefficients_of(function, order):
    """Taylor coefficients at 0, by a polynomial through Chebyshev points of a short interval."""
    eta = 0.1 * (1.0 - np.cos(np.pi * (np.arange(40) + 0.5) / 40)) / 2.0
    fit = np.polynomial.Polynomial.fit(eta, function(eta), 14).convert()
    return fit.coef[:order]


@pytest.mark.parametrize(("dimension", "name"), NAMED)
def test_equations_reproduce_the_table(dimension, name, table):
    rows = table(f"eos_{dimension}d")
    np.testing.assert_allclose(getattr(theory, name)(rows["packing_fraction"]), rows[name], rtol=5e-7)


@pytest.mark.parametrize(("dimension", "name"), NAMED)
def test_equations_have_the_exact_second_and_nearly_the_third_coefficient(dimension, name):
    series = coefficients_of(getattr(theory, name), 3)
    exact, _ = theory.virial_coefficients(dimension)
    np.testing.assert_allclose(series[:2], exact[:2], rtol=1e-5)
    assert series[2] == pytest.approx(exact[2], rel=0.05)


def test_discs_reference_reproduces_the_table(table):
    rows = table("eos_2d")
    computed = theory.compressibility_factor(rows["packing_fraction"], 2)
    np.testing.assert_allclose(computed, rows["virial_with_tail"], rtol=5e-6)


def test_spheres_reference_gives_the_virial_coefficients_to_b6():
    # The fit's claim: B2 to B6 reproduced. x = eta / (1 - eta) expanded to fifth order.
    x = np.array([0.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    series, power = np.zeros(6), np.eye(6)[0]
    for coefficient in (1.0, 4.0, 6.0, 2.3647684, -0.8698551, 1.1062803):
        series += coefficient * power
        power = np.convolve(power, x)[:6]
    exact, uncertainty = theory.virial_coefficients(3, 6)
    assert np.all(np.abs(series - exact) <= 3.0 * uncertainty + 1e-6)
    eta = np.array([0.01, 0.05])
    computed = theory.compressibility_factor(eta, 3)
    np.testing.assert_allclose(computed, theory.partial_sum(eta, 10, 3), rtol=1e-8)


@pytest.mark.parametrize("dimension", [2, 3])
def test_uncertainty_covers_the_virial_series_where_that_is_sharp(dimension):
    eta = np.linspace(0.0, {2: 0.2, 3: 0.17}[dimension], 41)
    reference = theory.compressibility_factor(eta, dimension)
    uncertainty = theory.compressibility_uncertainty(eta, dimension)
    shift = np.abs(reference - theory.partial_sum(eta, 10, dimension))
    assert np.all(shift <= uncertainty + 1e-14)
    assert np.all(uncertainty <= 1e-5 * reference)


def test_uncertainty_covers_what_the_series_of_discs_lacks_near_freezing():
    """P sigma^2 / kT = 7.9893 and 8.5209 at 0.67 and 0.68 (224 and 870 discs of Li and others 2022,
    continued to infinity as 1/N), and that of coexistence, 9.185."""
    for eta, pressure in ((0.67, 7.9893), (0.68, 8.5209), (0.70, 9.185)):
        expected = pressure * math.pi / 4 / eta
        lacking = theory.compressibility_factor(eta, 2) - expected
        assert 0.0 < lacking <= 1.1 * theory.compressibility_uncertainty(eta, 2)


def test_van_der_waals_is_exact_to_b2_only():
    for dimension in (2, 3):
        exact, _ = theory.virial_coefficients(dimension)
        series = coefficients_of(lambda eta, d=dimension: theory.van_der_waals(eta, d), 3)
        assert series[1] == pytest.approx(exact[1], rel=1e-4)
        assert series[2] == pytest.approx(exact[1] ** 2, rel=1e-2)
    with pytest.raises(ValueError, match="packing_fraction"):
        theory.van_der_waals(0.25, 3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_contact_value_is_one_in_the_dilute_limit_and_continuous(dimension):
    exact, _ = theory.virial_coefficients(dimension)
    assert theory.contact_value(0.0, dimension) == 1.0
    assert theory.contact_value(1e-8, dimension) == pytest.approx(1.0, abs=1e-6)
    slope = (theory.contact_value(1e-4, dimension) - 1.0) / 1e-4
    assert slope == pytest.approx(exact[2] / exact[1], rel=1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_finite_size_correction_has_the_exact_first_order(dimension):
    # N (N - 1) / 2 pairs: B2 of the canonical ensemble carries the factor (N - 1) / N, at every N.
    count, eta = 50, 1e-3
    second = 2.0 ** (dimension - 1)
    canonical = theory.finite_size_correction(eta, dimension, count, "canonical")
    assert canonical == pytest.approx(-second * eta / count, rel=5e-3)
    dynamics = theory.finite_size_correction(eta, dimension, count, "dynamics")
    assert abs(dynamics) < 5e-3 * abs(canonical)


@pytest.mark.parametrize("dimension", [2, 3])
def test_finite_size_correction_agrees_with_the_derivatives_of_the_series(dimension):
    # Independent evaluation: exact derivatives of the polynomial to B10, where that is enough.
    coefficients, _ = theory.virial_coefficients(dimension)
    pressure = np.polynomial.Polynomial(np.concatenate([[0.0], coefficients]))
    eta, count = 0.1, 200
    expected = -eta / (2.0 * count) * pressure.deriv(2)(eta) / pressure.deriv(1)(eta)
    computed = theory.finite_size_correction(eta, dimension, count, "canonical")
    assert computed == pytest.approx(expected, rel=1e-5)


def test_finite_size_correction_refuses_nonsense():
    with pytest.raises(ValueError, match="ensemble"):
        theory.finite_size_correction(0.1, 2, 100, "grand")
    with pytest.raises(ValueError, match="count"):
        theory.finite_size_correction(0.1, 2, 1)


def test_the_reference_ends_where_the_fluid_does():
    for dimension, beyond in ((2, 0.71), (3, 0.55)):
        with pytest.raises(ValueError, match="packing_fraction"):
            theory.compressibility_factor(beyond, dimension)
    with pytest.raises(ValueError, match="packing_fraction"):
        theory.compressibility_factor(-0.1, 3)


def test_density_and_packing_fraction_are_inverse():
    assert theory.particle_volume(2, 2.0) == pytest.approx(np.pi)
    assert theory.particle_volume(3, 2.0) == pytest.approx(4.0 / 3.0 * np.pi)
    density = theory.number_density(0.3, 3, 0.4)
    assert theory.packing_fraction(density, 3, 0.4) == pytest.approx(0.3, rel=1e-15)
    assert theory.number_density(theory.CLOSE_PACKING[3], 3) == pytest.approx(np.sqrt(2.0))


def test_importing_theory_loads_nothing_heavy():
    code = (
        "import sys; from gaspart import theory; theory.compressibility_factor(0.3, 2); theory.relaxation(3);"
        "print([m for m in ('scipy', 'pandas', 'xarray', 'numba', 'matplotlib') if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"


def test_sound_in_a_dilute_gas():
    """sqrt(5/3) and sqrt(2) in units of the thermal speed."""
    assert theory.speed_of_sound(1e-4, 3) == pytest.approx((5 / 3) ** 0.5, rel=1e-3)
    assert theory.speed_of_sound(1e-4, 2) == pytest.approx(2**0.5, rel=1e-3)


def test_an_adiabat_is_that_of_the_ideal_gas_and_of_each_small_step():
    """Dilute: (V0/V)^(2/d). Otherwise each small step obeys dT / T = 2/d Z d eta / eta."""
    for dimension in (2, 3):
        dilute = adiabatic_temperature(np.array([1e-6, 4e-6]), 1e-6, dimension)
        assert dilute == pytest.approx([1.0, 4.0 ** (2.0 / dimension)], rel=1e-4)
        eta = np.geomspace(0.01, 0.4, 20_001)
        middle = np.sqrt(eta[1:] * eta[:-1])
        steps = theory.compressibility_factor(middle, dimension) * np.diff(np.log(eta))
        expected = np.exp(2.0 / dimension * steps.sum())
        assert adiabatic_temperature(0.4, 0.01, dimension) == pytest.approx(expected, rel=1e-7)
        assert adiabatic_temperature(0.01, 0.4, dimension) == pytest.approx(1.0 / expected, rel=1e-7)
    with pytest.raises(gp.SceneError, match="packing_fraction"):
        adiabatic_temperature(0.9, 0.1, 2)


@pytest.mark.parametrize(("dimension", "eta"), [(2, 0.1), (2, 0.4), (3, 0.1), (3, 0.4)])
def test_the_factor_at_constant_enthalpy_is_that_of_its_integral_over_the_volume(dimension, eta):
    """Q(V) from the pressure at constant N and V, to first order in 1/N; 1/N^2 is neglected."""
    count, freedom = 1000, 1000 * dimension
    z = theory.compressibility_factor(eta, dimension)
    pressure, enthalpy = z, 0.5 * freedom + count * z  # k_B T and N / V are 1 at the mean
    volume = count * np.linspace(0.8, 1.2, 4001)
    dense = eta * count / volume
    shift = theory.finite_size_correction(dense, dimension, count, ensemble="canonical")
    slope = count / volume * (theory.compressibility_factor(dense, dimension) + shift)
    logarithm = cumulative_trapezoid(slope, volume, initial=0.0)
    logarithm += (0.5 * freedom - 1.0) * np.log(enthalpy - pressure * volume)
    weight = np.exp(logarithm - logarithm.max())
    mean = float(weight @ volume / weight.sum())
    temperature = 2.0 * (enthalpy - pressure * mean) / freedom
    own = eta * count / mean
    factor = pressure * mean / (count * temperature * theory.compressibility_factor(own, dimension))
    expected = float(constant_enthalpy_factor(own, dimension, count))
    assert expected > 1.0001
    assert factor == pytest.approx(expected, abs=0.02 * (expected - 1.0))


def test_a_dilute_gas_behind_a_piston_is_ideal():
    assert constant_enthalpy_factor(1e-4, 3, 100) == pytest.approx(1.01, abs=1e-5)


def test_the_compressibility_of_a_dilute_gas():
    assert theory.reduced_compressibility(0.0, 3) == pytest.approx(1.0, abs=1e-3)
    series = 1.0 + 8.0 * 0.01 + 30.0 * 0.01**2
    assert theory.reduced_compressibility(0.01, 3) == pytest.approx(1.0 / series, rel=1e-3)
