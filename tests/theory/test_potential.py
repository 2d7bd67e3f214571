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


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_free_energy_is_that_of_the_chemical_potential(dimension):
    """Its derivative, times the packing fraction, is Z - 1; its mean over smaller ones that of mu."""
    eta, step = 0.4, 1e-3
    high, low = (theory.excess_free_energy(eta + d, dimension) for d in (step, -step))
    excess = theory.compressibility_factor(eta, dimension) - 1.0
    assert eta * (high - low) / (2.0 * step) == pytest.approx(excess, rel=1e-4)
    below = np.linspace(0.0, eta, 2001)
    mean = np.trapezoid(theory.excess_chemical_potential(below, dimension), below) / eta
    assert theory.excess_free_energy(eta, dimension) == pytest.approx(mean, rel=1e-5)


def test_the_uncertainty_of_the_chemical_potential_is_that_of_z():
    """With an uncertainty that is a constant part of Z: that part of the integral too."""
    eta = 0.4  # where it is 4.3e-6 of Z, but for low densities
    whole = theory.compressibility_factor(eta, 3) + theory.excess_free_energy(eta, 3)
    assert theory.chemical_potential_uncertainty(eta, 3) == pytest.approx(4.3e-6 * whole, rel=0.4)


def test_fewer_pairs_change_the_chance_of_an_insertion():
    """To second order in the density: P_N = 1 - N c_1 / V + N (N - 1) c_2 / V^2 exactly."""
    eta, count = 0.01, 50
    _, second, third, *_ = theory.virial_coefficients(3, 4)[0]
    c_2 = 0.5 * (2.0 * second) ** 2 - 1.5 * third
    chances = [1.0 - 2.0 * second * eta + pairs * c_2 * eta**2 for pairs in (1.0, 1.0 - 1.0 / count)]
    exact = np.log(chances[0] / chances[1])
    assert theory.insertion_finite_size_correction(eta, 3, count) == pytest.approx(exact, rel=0.15)
