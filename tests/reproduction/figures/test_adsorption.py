"""Walls that hold particles: theory, and what is counted in frames with known answers."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.special import gammaln

import gaspart as gp
from gaspart.reproduction.figures import adsorption
from gaspart.reproduction.points.point import Point
from gaspart.theory.tables import packing_fraction_at


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


def test_a_single_sphere_in_front_of_a_layer_closes_half_a_ball():
    assert adsorption.excluded_in_front(0.0, 1e-9) == pytest.approx(2.0 * np.pi / 3.0)
    assert adsorption.layer_activity(2.0, 0.0, 0.01, 1e-9) == pytest.approx(2.0)


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


SETTINGS = {"blocks": 10, "layer_blocks": 10, "near": 0.5, "bins": 20}


def wall(name):
    """The wall of a scene of the config."""
    scene = Path(__file__).parents[3] / f"config/scenes/adsorption_{name}.yaml"
    settings = {"scene": str(scene), "duration": 60.0, "samples": 30, "equilibration": 20.0}
    return adsorption.Wall(Point("held", "single", "simulate", settings, "results/points", 1))


def test_only_particles_without_a_velocity_along_the_normal_are_stuck():
    height, velocity = np.array([[0.0, 0.1, 0.2, 5.0]]), np.array([[0.0, 0.5, -0.5, 2.0]])
    held, free, far, slow, flux = adsorption.counts(wall("sticky"), height, velocity, SETTINGS)
    assert (held, free, far) == (1.0, 3.0, 1.0)
    assert slow == flux.sum() == flux[2] == 0.5  # one leaves, with 0.5


def test_the_coverage_of_a_layer_is_compared_with_that_of_discs():
    layer = wall("monolayer")
    far, held = 0.01 * (layer.outside - 2.0 * layer.sigma) * layer.area, 25.0
    for _ in range(50):  # until the coverage is that of discs at the activity which it gives the layer
        held /= layer.filling(held, 1e9, far)
    assert layer.filling(held, 1e9, far) == pytest.approx(1.0)
    plain = packing_fraction_at(layer.activity(far), 2)
    assert 1.002 < layer.coverage(held) / plain < 1.006  # more than with the pressure alone, by first order
    assert 1.002 < 1.0 / layer.filling(held, 40.0, far) < 1.006  # a small gas leaves the layer more
