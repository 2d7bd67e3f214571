import numpy as np
import pytest

from gaspart import theory


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_chemical_potential_is_that_of_the_equation_of_state(dimension):
    # Gibbs and Duhem: d(eta Z) / d eta = 1 + eta d mu_excess / d eta.
    eta = np.linspace(0.01, 0.5, 30)
    low, high = (theory.excess_chemical_potential(eta + d, dimension) for d in (-1e-3, 1e-3))
    z_low, z_high = ((eta + d) * theory.compressibility_factor(eta + d, dimension) for d in (-1e-3, 1e-3))
    assert (z_high - z_low) / 2e-3 == pytest.approx(1.0 + eta * (high - low) / 2e-3, rel=1e-4)
    assert theory.excess_chemical_potential(1e-4, dimension) == pytest.approx(2.0**dimension * 1e-4, rel=1e-3)


@pytest.mark.parametrize("eta", [1e-7, 1e-4, 0.05, 0.6])
def test_the_packing_fraction_at_an_activity_is_found_again(eta):
    activity = eta * np.exp(theory.excess_chemical_potential(eta, 2))
    assert theory.packing_fraction_at(activity, 2) == pytest.approx(eta, rel=1e-5)


def test_it_is_the_virial_series_and_carnahan_and_starling():
    # Virial series: mu_ex = sum of n/(n-1) b_n eta^(n-1); Carnahan and Starling's closed form when dense.
    exact, _ = theory.virial_coefficients(3, 6)
    series = sum(n / (n - 1) * exact[n - 1] * 0.05 ** (n - 1) for n in range(2, 7))
    assert theory.excess_chemical_potential(0.05, 3) == pytest.approx(series, rel=1e-5)
    eta = 0.35
    starling = (8.0 * eta - 9.0 * eta**2 + 3.0 * eta**3) / (1.0 - eta) ** 3
    assert theory.excess_chemical_potential(eta, 3) == pytest.approx(starling, rel=4e-3)
