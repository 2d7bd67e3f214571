import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.special import gammaln

import gaspart as gp
from gaspart.theory import adsorption
from gaspart.theory.tables import packing_fraction_at


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


def test_two_spheres_leave_a_well_as_their_configurations_do():
    """The integral over both heights, whose discs of contact are closed, at three places of the densities."""
    diameter, width, outside = 0.5, 0.7, 1.1
    height = (np.arange(1800) + 0.5) * 1e-3
    inside = height < width
    closed = np.pi * np.maximum(diameter**2 - (height[:, None] - height) ** 2, 0.0)
    for held, free in ((1.0, 0.0), (0.0, 1.0), (3.0, 0.5)):
        mean = (closed * np.where(inside, held, free)).sum(axis=1) * 1e-3
        expected = mean[~inside].mean() - mean[inside].mean()
        found = adsorption.excess_in_well(held, free, diameter, width, outside)
        assert found == pytest.approx(expected, rel=1e-5)


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


def test_a_single_sphere_in_front_of_a_layer_closes_half_a_ball():
    assert adsorption.excluded_in_front(0.0, 1e-9) == pytest.approx(2.0 * np.pi / 3.0)
    assert adsorption.layer_activity(2.0, 0.0, 0.01, 1e-9) == pytest.approx(2.0)
    # Half of the lens that the balls of two neighbours share, at r = 1 to 2, is closed once (exact).
    r = np.linspace(1.0, 2.0, 2001)
    lens = np.trapezoid(np.pi / 24.0 * (4.0 + r) * (2.0 - r) ** 2 * 2.0 * np.pi * r, r)
    step = 1e-4
    slope = (adsorption.excluded_in_front(step, 1e-9) - 2.0 * np.pi / 3.0) / (4.0 / np.pi * step)
    assert slope == pytest.approx(-lens, rel=0.08)  # scaled-particle theory is approximate here


def test_the_room_that_discs_close_is_that_in_front_of_simulated_ones():
    """The mean height up to which random points are within 1 of a disc's centre, at packing fraction 0.3."""
    eta, count, width = 0.3, 400, 0.1
    side = np.sqrt(count * np.pi / 4.0 / eta)
    discs = gp.Scene(gp.Container((side, side), "periodic"), [gp.Species(count, radius=0.5, temperature=1.0)])
    simulation, rng, found = gp.Simulation(discs, gp.EventDriven(), seed=1), np.random.default_rng(2), []
    for _ in range(30):
        simulation.advance(duration=1.0)
        tree = cKDTree(simulation.state.positions % side, boxsize=side)
        distance, _ = tree.query(rng.random((20_000, 2)) * side)
        found.append(np.sqrt(np.maximum(1.0 - distance**2, (0.5 * width) ** 2)).mean() - 0.5 * width)
    nodes, weights = np.polynomial.legendre.leggauss(16)
    closed = [adsorption.excluded_in_front(0.5 * eta * (1.0 + x), width) for x in nodes]
    assert np.mean(found) == pytest.approx(0.5 * eta * (weights @ closed) * 4.0 / np.pi, rel=0.01)


def test_discs_of_a_layer_are_smaller_by_the_heights_of_their_centres():
    heights = np.random.default_rng(1).uniform(0.0, 0.1, (2, 10**6))
    across = np.sqrt(1.0 - (heights[0] - heights[1]) ** 2).mean()
    assert adsorption.layer_diameter(0.1) == pytest.approx(across, abs=1e-6)


@pytest.mark.parametrize(("particles", "ratio"), [(500, 1.2), (800, 10.0), (1050, 100.0)])
def test_a_small_gas_leaves_the_layer_more(particles, ratio):
    """All numbers of discs with an area pi/4 on 1000, by scaled-particle theory, and an ideal gas."""
    number = np.arange(min(particles, 690))  # of those in the layer
    insertion = np.log(adsorption.scaled_particle_activity((number[1:] - 0.5) / 1000.0))
    layer = np.concatenate([[0.0], np.cumsum(-insertion)])

    def mean(logarithm):
        weights = np.exp(logarithm - logarithm.max())
        return float(weights @ number / weights.sum())

    canonical = mean(layer + number * np.log(ratio / particles) - gammaln(particles - number + 1.0))
    gas = particles - canonical
    activity = ratio * gas / particles
    large = mean(layer + number * np.log(activity))
    assert adsorption.excess_of_few(activity, large, gas) == pytest.approx(canonical / large - 1.0, rel=0.1)
