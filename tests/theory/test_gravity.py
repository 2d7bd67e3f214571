import numpy as np
import pytest

from gaspart import theory
from gaspart.theory import brownian as buoyancy
from gaspart.theory import gravity


@pytest.mark.parametrize("x", [0.0, 1e-6, 0.01, 1.0, 20.0])
def test_the_ideal_gas_fills_a_box_of_finite_height(x):
    z = np.linspace(0.0, 3.0, 20_001)
    profile = gravity.ideal_profile(z, 3.0, x / 3.0)
    assert np.trapezoid(profile, z) == pytest.approx(1.0, rel=1e-5)
    assert np.trapezoid(z * profile, z) == pytest.approx(gravity.ideal_mean_height(3.0, x / 3.0), rel=1e-5)


@pytest.mark.parametrize("temperature", [0.1, 0.5, 3.0])
def test_the_heat_capacity_is_the_slope_of_the_energy(temperature):
    step = 1e-4 * temperature
    low, high = (1.0 / t for t in (temperature - step, temperature + step))
    lifted = (gravity.ideal_mean_height(1.0, high) - gravity.ideal_mean_height(1.0, low)) / (2.0 * step)
    assert gravity.ideal_heat_capacity(1.0 / temperature, 3) == pytest.approx(1.5 + lifted, rel=1e-6)


def test_the_heat_capacity_goes_from_a_flat_box_to_a_high_one():
    assert gravity.ideal_heat_capacity([0.0, 60.0], 2) == pytest.approx([1.0, 2.0])


@pytest.mark.parametrize("count", [5, 100])
def test_in_a_high_box_the_kinetic_energy_has_a_beta_distribution(count):
    # The number of states with potential energy U is U^{N-1}: K/E is distributed as Beta(N, N) in 2D.
    mean, variance = gravity.ideal_energy_moments(7.0, count, 100.0 * 7.0, 1.0, 2)
    assert mean == pytest.approx(3.5, rel=1e-9)
    assert variance == pytest.approx(49.0 / (4.0 * (2 * count + 1)), rel=1e-9)


def test_at_fixed_energy_the_heat_capacity_is_the_canonical_one_to_order_1_over_n():
    count, energy = 400, 1.2 * 400
    mean, variance = gravity.ideal_energy_moments(energy, count, 2.0, 1.0, 2)
    around = [gravity.ideal_energy_moments(energy + d, count, 2.0, 1.0, 2)[0] for d in (-0.1, 0.1)]
    canonical = gravity.ideal_heat_capacity(2.0 * count / mean, 2)
    assert 0.2 / (around[1] - around[0]) == pytest.approx(canonical, rel=2.0 / count)
    assert gravity.lebowitz_percus_verlet(mean, variance, count, 2) == pytest.approx(
        canonical, rel=2.0 / count
    )


def test_without_gravity_all_energy_is_kinetic():
    assert gravity.ideal_energy_moments(3.0, 10, 5.0, 0.0, 2) == (3.0, 0.0)
    with pytest.raises(ValueError, match="energy"):
        gravity.ideal_energy_moments(0.0, 10, 5.0, 1.0, 2)


def test_too_dense_a_column_is_refused():
    with pytest.raises(ValueError, match="activity"):
        gravity.hydrostatic_profiles(np.linspace(0.0, 10.0, 11), [20.0], [1.0], 2)


def test_a_dense_mixture_carries_its_weight():
    z = np.linspace(5.0, 80.0, 3001)
    weights = np.array([0.05, 0.15])
    light, heavy = gravity.hydrostatic_profiles(z, [14.0, 6.0], weights, 2)
    assert np.trapezoid([light, heavy], z, axis=1) == pytest.approx([14.0, 6.0], rel=1e-9)
    total = light + heavy
    pressure = total * theory.compressibility_factor(theory.packing_fraction(total, 2), 2)
    assert pressure[0] - pressure[-1] == pytest.approx(weights @ [14.0, 6.0], rel=1e-4)
    assert np.diff(np.log(heavy / light)) == pytest.approx(-0.1 * np.diff(z), rel=1e-9)
    assert total[0] > 0.5 and light.argmax() > 0  # dense enough for the light ones to be pressed upwards


def test_a_dilute_column_is_ideal():
    z = np.linspace(0.0, 30.0, 3001)
    (density,) = gravity.hydrostatic_profiles(z, [1e-6], [0.2], 2)
    assert density == pytest.approx(1e-6 * gravity.ideal_profile(z, 30.0, 0.2), rel=1e-5)


ETA = np.linspace(0.02, 0.6, 12)


def insertion_work(eta, s):
    """Work of inserting a disc of s times the radius, over k_B T (Helfand, Frisch and Lebowitz 1961)."""
    return -np.log1p(-eta) + 2.0 * s * eta / (1.0 - eta) + s**2 * eta / (1.0 - eta) ** 2


def slope(function, at, step=1e-5):
    return (function(at + step) - function(at - step)) / (2.0 * step)


@pytest.mark.parametrize("ratio", [0.0, 1.0, 6.0, 50.0])
def test_what_is_displaced_is_the_slope_of_the_work_by_the_chemical_potential(ratio):
    work = slope(lambda eta: insertion_work(eta, ratio), ETA)
    potential = 1.0 / ETA + slope(lambda eta: insertion_work(eta, 1.0), ETA)
    assert ETA * buoyancy.displaced_area(ETA, ratio) == pytest.approx(work / potential, rel=1e-6)
