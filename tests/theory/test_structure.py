import numpy as np
import pytest

from gaspart import theory
from gaspart.theory.structure import percus_yevick_rdf, percus_yevick_structure_factor
from gaspart.theory.tables import chemical_potential_uncertainty, insertion_finite_size_correction


def transform(g, wave_number, eta):
    """S(k) of g(r), (n,), from the diameter to five, by the trapezoid rule."""
    r = np.linspace(1.0, 4.9, len(g))
    beyond = np.trapezoid((g - 1.0) * r * np.sin(wave_number * r), r) / wave_number
    inside = (np.sin(wave_number) - wave_number * np.cos(wave_number)) / wave_number**3
    return 1.0 + 24.0 * eta * (beyond - inside)


@pytest.mark.parametrize(
    ("g", "s"),
    [
        (percus_yevick_rdf, percus_yevick_structure_factor),
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
    contact = ((1.0 + 2.0 * eta + 3.0 * eta**2) / (1.0 - eta) ** 2 - 1.0) / (4.0 * eta)  # virial route
    assert percus_yevick_rdf(1.0, eta) == pytest.approx(contact, rel=1e-9)
    step = 1e-5
    near = np.array([eta + step, eta - step])
    high, low = near * (1.0 + near + near**2) / (1.0 - near) ** 3  # compressibility route
    zero = percus_yevick_structure_factor(0.0, eta)
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
    for g in (percus_yevick_rdf, theory.verlet_weis_rdf):
        assert g(r, eta) - 1.0 == pytest.approx(eta * common, abs=3e-7)
    assert percus_yevick_rdf(0.99, eta) == 0.0 == theory.verlet_weis_rdf(0.99, eta)


def test_values_outside_their_range_are_refused():
    with pytest.raises(ValueError, match="up to 5 diameters"):
        percus_yevick_rdf(5.1, 0.3)
    with pytest.raises(ValueError, match="must be above 0"):
        theory.verlet_weis_rdf(1.5, 0.0)
    with pytest.raises(ValueError, match="wave_number = -1"):
        percus_yevick_structure_factor(-1.0, 0.3)


BULK = theory.number_density(0.35, 3)


def test_the_functional_obeys_the_contact_theorem():
    # Its pressure follows from its bulk alone, the density at the wall from the profile: an exact sum rule.
    _, density = theory.white_bear_slit(BULK, 8.0)
    assert density[0] == pytest.approx(theory.white_bear_pressure(BULK), rel=3e-4)
    assert density[0] == pytest.approx(density[-1], rel=1e-6)


def test_far_from_the_walls_the_functional_has_its_bulk():
    place, density = theory.white_bear_slit(BULK, 11.0, 0.02)
    middle = np.abs(place - 5.0) < 1.0
    assert density[middle].mean() == pytest.approx(BULK, rel=2e-3)


def test_first_order_of_the_profile_is_exact():
    # A wall keeps half of a sphere's surroundings free of others: rho(0) / rho_b = 1 + (2 pi / 3) rho_b.
    bulk = 0.01
    _, density = theory.white_bear_slit(bulk, 6.0)
    assert density[0] / bulk == pytest.approx(1.0 + 2.0 * np.pi / 3.0 * bulk, abs=4e-4)


def test_no_slit_narrower_than_a_sphere():
    with pytest.raises(ValueError, match="width"):
        theory.white_bear_slit(BULK, 1.0)


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
    assert chemical_potential_uncertainty(eta, 3) == pytest.approx(4.3e-6 * whole, rel=0.4)


def test_fewer_pairs_change_the_chance_of_an_insertion():
    """To second order in the density: P_N = 1 - N c_1 / V + N (N - 1) c_2 / V^2 exactly."""
    eta, count = 0.01, 50
    _, second, third, *_ = theory.virial_coefficients(3, 4)[0]
    c_2 = 0.5 * (2.0 * second) ** 2 - 1.5 * third
    chances = [1.0 - 2.0 * second * eta + pairs * c_2 * eta**2 for pairs in (1.0, 1.0 - 1.0 / count)]
    exact = np.log(chances[0] / chances[1])
    assert insertion_finite_size_correction(eta, 3, count) == pytest.approx(exact, rel=0.15)
