import numpy as np
import pytest

from gaspart import theory

SAME_FORMULA = {
    "contact_value": theory.contact_value,
    "collision_rate": theory.collision_rate,
    "mean_free_path": theory.mean_free_path,
    "diffusion": theory.enskog_diffusion,
}
SCALED = [
    (theory.collision_rate, lambda d, length, time, mass: 1.0 / time),
    (theory.enskog_diffusion, lambda d, length, time, mass: length**2 / time),
    (theory.enskog_viscosity, lambda d, length, time, mass: mass * length ** (2 - d) / time),
    (theory.enskog_bulk_viscosity, lambda d, length, time, mass: mass * length ** (2 - d) / time),
    (theory.enskog_conductivity, lambda d, length, time, mass: length ** (2 - d) / time),
]


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("name", SAME_FORMULA)
def test_reproduces_the_table(dimension, name, table):
    rows = table(f"enskog_{dimension}d")
    computed = SAME_FORMULA[name](rows["packing_fraction"], dimension)
    np.testing.assert_allclose(computed, rows[name], rtol=1e-5)


def test_transport_of_spheres_reproduces_the_table(table):
    rows = table("enskog_3d")
    eta = rows["packing_fraction"]
    np.testing.assert_allclose(theory.enskog_bulk_viscosity(eta, 3), rows["bulk_viscosity"], rtol=1e-5)
    # The table rounds the quadratic coefficient 0.7615 to 0.7614.
    np.testing.assert_allclose(theory.enskog_viscosity(eta, 3), rows["viscosity"], rtol=1.5e-4)
    np.testing.assert_allclose(theory.enskog_conductivity(eta, 3), rows["conductivity"], rtol=3e-5)


def test_transport_of_discs_against_the_table_and_its_slips(table):
    rows = table("enskog_2d")
    eta = rows["packing_fraction"]
    bulk = theory.enskog_bulk_viscosity(eta, 2)
    np.testing.assert_allclose(bulk, 2.0 * rows["bulk_viscosity"], rtol=1.5e-5)
    # Without the Sonine factor in the collisional terms they are up to 1.5 % larger.
    np.testing.assert_allclose(theory.enskog_viscosity(eta, 2), rows["viscosity"], rtol=0.015)
    np.testing.assert_allclose(theory.enskog_conductivity(eta, 2), rows["conductivity"], rtol=0.01)
    assert theory.enskog_viscosity(1e-4, 2) == pytest.approx(rows["viscosity"][0], rel=2e-5)


def test_dense_viscosity_of_discs_has_gass_coefficient():
    chi, b = theory.contact_value(0.6, 2), 2 * 0.6
    gass = 0.28829 * (1 / chi + b + 0.8729 * b**2 * chi)
    assert theory.enskog_viscosity(0.6, 2) == pytest.approx(gass, rel=1e-4)


@pytest.mark.parametrize("dimension", [2, 3])
def test_bulk_viscosity_is_the_pressure_change_of_an_expanding_gas(dimension):
    # The collisional pressure of pairs that part with the mean normal velocity `drift` at contact.
    eta, rate = 0.2, 1e-4
    density, chi = theory.number_density(eta, dimension), theory.contact_value(eta, dimension)
    surface = {2: 2 * np.pi, 3: 4 * np.pi}[dimension]
    drift = rate / dimension
    g = np.linspace(-12.0, 0.0, 200_001)
    weight = np.exp(-((g - drift) ** 2) / 4.0) / np.sqrt(4.0 * np.pi)
    approaching = np.trapezoid(g**2 * weight, g)
    pressure = density**2 * chi * surface * approaching / (2.0 * dimension)
    at_rest = density**2 * chi * surface / (2.0 * dimension)
    bulk = theory.enskog_bulk_viscosity(eta, dimension)
    assert (at_rest - pressure) / rate == pytest.approx(bulk, rel=1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_collision_rate_follows_from_the_virial_theorem(dimension):
    eta, temperature, mass, diameter = 0.25, 1.7, 2.5, 0.3
    rate = theory.collision_rate(eta, dimension, diameter, temperature, mass)
    # Half the rate counts each pair once; a contact passes m |v_n|, of flux-weighted mean sqrt(pi k T / m).
    impulse = np.sqrt(np.pi * mass * temperature)
    excess = 0.5 * rate * diameter * impulse / (dimension * temperature)
    assert excess == pytest.approx(theory.compressibility_factor(eta, dimension) - 1.0, rel=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize(("function", "unit"), SCALED)
def test_units(dimension, function, unit):
    diameter, temperature, mass = 0.4, 3.0, 5.0
    time = diameter * np.sqrt(mass / temperature)
    scale = unit(dimension, diameter, time, mass)
    scaled = function(0.2, dimension, diameter, temperature, mass)
    assert scaled == pytest.approx(scale * function(0.2, dimension), rel=1e-12)


def test_dilute_limits():
    assert theory.mean_free_path(1e-6, 3) == pytest.approx(
        1.0 / (np.sqrt(2.0) * np.pi * theory.number_density(1e-6, 3)), rel=1e-5
    )
    assert theory.mean_free_path(1e-6, 2) == pytest.approx(
        1.0 / (2.0 * np.sqrt(2.0) * theory.number_density(1e-6, 2)), rel=1e-5
    )
    assert theory.mean_free_path(0.0, 3) == np.inf
    assert theory.enskog_diffusion(0.0, 2) == np.inf
    assert theory.collision_rate(0.0, 2) == 0.0


@pytest.mark.parametrize("dimension", [2, 3])
def test_finite_collision_rate_in_the_dilute_limit(dimension):
    # Two particles, total momentum zero, 2 E = d N T: |v_12| is fixed, and there is one pair instead of
    # N^2/2.
    fixed_speed = np.sqrt(2.0 * 2.0 * dimension)
    shape = {2: 2.0 / np.pi, 3: 0.5}[dimension]
    maxwell = np.sqrt(4.0 / np.pi)  # <|v_n|> at T = m = 1
    exact = 0.5 * fixed_speed * shape / maxwell
    factor = theory.collision_rate_finite_size_factor(1e-9, dimension, 2)
    assert factor == pytest.approx(exact, rel=1e-3)
    assert theory.collision_rate_finite_size_factor(0.1, dimension, 10**6) == pytest.approx(1.0, abs=1e-6)
