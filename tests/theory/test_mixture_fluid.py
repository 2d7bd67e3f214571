"""Mixtures: structure by Percus and Yevick, chemical potentials, conductivity of a dilute gas."""

import math

import numpy as np
import pytest

from gaspart import theory
from gaspart.theory.mixture_properties import (
    dilute_mixture_conductivity,
    mixture_insertion_correction,
    percus_yevick_partial_factors,
)
from gaspart.theory.structure import percus_yevick_structure_factor
from gaspart.theory.tables import insertion_finite_size_correction

SIZES, PARTS, ETA = np.array([1.0, 0.6, 0.3]), np.array([0.2, 0.3, 0.5]), 0.35
DENSITIES = ETA * PARTS / (np.pi / 6.0 * PARTS @ SIZES**3)


def derivatives(function):
    """By each density, central."""
    step = 1e-5
    return [(function(DENSITIES + h) - function(DENSITIES - h)) / (2.0 * step) for h in step * np.eye(3)]


def moments(densities):
    return [np.pi / 6.0 * densities @ SIZES**power for power in range(4)]


def test_equal_spheres_have_one_structure():
    k = np.array([0.0, 0.3, 5.0, 7.0, 60.0])
    found = percus_yevick_partial_factors(k, 0.4, [1.0, 1.0], [0.3, 0.7])
    whole = percus_yevick_structure_factor(k, 0.4)
    x = np.sqrt([0.3, 0.7])
    np.testing.assert_allclose(found, np.eye(2) + np.outer(x, x) * (whole - 1.0)[:, None, None], atol=1e-13)


def test_long_waves_have_the_compressibility_of_percus_and_yevick():
    """dP/dn_a = sum_b (S^-1)_ab sqrt(n_b / n_a), with P by the compressibility (Lebowitz 1964)."""

    def pressure(densities):
        xi, rest = moments(densities), 1.0 - moments(densities)[3]
        total = xi[0] / rest + 3.0 * xi[1] * xi[2] / rest**2 + 3.0 * xi[2] ** 3 / rest**3
        return 6.0 / np.pi * total

    found = percus_yevick_partial_factors(0.0, ETA, SIZES, PARTS)
    root = np.sqrt(DENSITIES)
    np.testing.assert_allclose(np.linalg.inv(found) @ root / root, derivatives(pressure), rtol=1e-7)
    short = percus_yevick_partial_factors(80.0, ETA, SIZES, PARTS)
    np.testing.assert_allclose(short, np.eye(3), atol=0.01)


def test_chemical_potentials_are_derivatives_of_the_free_energy():
    """That of Mansoori and others in its closed form."""

    def free_energy(densities):
        xi, rest = moments(densities), 1.0 - moments(densities)[3]
        total = (xi[2] ** 3 / xi[3] ** 2 - xi[0]) * math.log(rest) + 3.0 * xi[1] * xi[2] / rest
        return 6.0 / np.pi * (total + xi[2] ** 3 / (xi[3] * rest**2))

    found = theory.mixture_chemical_potentials(ETA, 3, SIZES, PARTS, "boublik")
    np.testing.assert_allclose(found, derivatives(free_energy), rtol=1e-8)


@pytest.mark.parametrize("dimension", [2, 3])
def test_potentials_in_known_limits(dimension):
    """Equal particles, and a point, which is free where no particle is."""
    eta = 0.3
    pure = float(theory.excess_chemical_potential(eta, dimension))
    equal = theory.mixture_chemical_potentials(eta, dimension, [1.0, 1.0], [1.0, 2.0])
    np.testing.assert_allclose(equal, pure, rtol=1e-10)
    point = theory.mixture_chemical_potentials(eta, dimension, [1.0, 1e-7], [1.0, 0.0])
    np.testing.assert_allclose(point, [pure, -math.log(1.0 - eta)], rtol=1e-6)
    few = mixture_insertion_correction(eta, dimension, [1.0, 1.0], [30, 70])
    expected = float(insertion_finite_size_correction(eta, dimension, 100))
    np.testing.assert_allclose(few, expected, rtol=1e-4)


def test_insertion_into_few_dilute_particles_has_no_correction():
    """To first order in the density each covers its part, whatever their number."""
    found = mixture_insertion_correction(1e-5, 3, [1.0, 0.5], [3, 5])
    assert (np.abs(found) < 1e-8).all()


def test_potentials_of_few_large_particles_among_many_small_ones():
    """By hand, to second order in the density: mu_i = sum over j of 2 B_ij n_j, whatever the sizes; two large
    particles in 250 small ones had negative numbers in the differences."""
    sizes, counts, eta = np.array([1.0, 0.2]), np.array([2, 250]), 1e-7
    density = eta * counts / (math.pi / 6.0 * float(counts @ sizes**3))
    first = math.pi / 6.0 * np.add.outer(sizes, sizes) ** 3 @ density
    np.testing.assert_allclose(theory.mixture_chemical_potentials(eta, 3, sizes, counts), first, rtol=1e-5)
    dense = theory.mixture_chemical_potentials(0.168, 3, sizes, counts)
    for factor in (0.5, 2.0):  # fractions, whatever their sum
        same = theory.mixture_chemical_potentials(0.168, 3, sizes, factor * counts)
        np.testing.assert_allclose(same, dense, rtol=1e-10)
    many = mixture_insertion_correction(0.168, 3, sizes, 1000 * counts)
    few = mixture_insertion_correction(0.168, 3, sizes, counts)
    np.testing.assert_allclose(few, 1000.0 * many, rtol=1e-6)


def binary(x, masses, sizes):
    """Hirschfelder, Curtiss and Bird (1954), 8.2-36, of spheres."""
    (m, n), (s, t) = masses, sizes
    alone = [75.0 / 64.0 / size**2 / math.sqrt(math.pi * mass) for mass, size in ((m, s), (n, t))]
    both = 75.0 / 64.0 / (0.5 * (s + t)) ** 2 / math.sqrt(2.0 * math.pi * m * n / (m + n))
    apart, sum_of = (m - n) ** 2 / (m * n), (m + n) ** 2 / (4.0 * m * n)
    u = 4.0 / 15.0 - 17.0 / 60.0 * m / n + 0.5 * apart, 4.0 / 15.0 - 17.0 / 60.0 * n / m + 0.5 * apart
    uy = 4.0 / 15.0 * sum_of * both**2 / (alone[0] * alone[1]) - 17.0 / 60.0 + 13.0 / 32.0 * apart
    uz = 4.0 / 15.0 * (sum_of * (both / alone[0] + both / alone[1]) - 1.0) - 17.0 / 60.0
    weights = x**2 / alone[0], 2.0 * x * (1.0 - x) / both, (1.0 - x) ** 2 / alone[1]
    above = 1.0 + x**2 * u[0] + 2.0 * x * (1.0 - x) * uz + (1.0 - x) ** 2 * u[1]
    return above / (sum(weights) + weights[0] * u[0] + weights[1] * uy + weights[2] * u[1])


def test_the_conductivity_of_a_dilute_mixture():
    found = dilute_mixture_conductivity([1.0, 2.0], [0.6, 0.4], masses=[1.0, 10.0])
    assert found == pytest.approx(binary(0.6, (1.0, 10.0), (1.0, 2.0)), rel=1e-12)
    equal = dilute_mixture_conductivity([1.0] * 3, PARTS, temperature=4.0, masses=4.0)
    assert equal == pytest.approx(75.0 / 64.0 / math.sqrt(math.pi))
