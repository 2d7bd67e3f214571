"""How fluxes relax by the linearised Boltzmann operator."""

import math

import numpy as np
import pytest

from gaspart import theory
from gaspart.theory.boltzmann import brackets, collisions, flux_relaxation


@pytest.mark.parametrize("quantity", ["viscosity", "conductivity"])
def test_the_integral_of_the_correlation_is_the_transport_coefficient(quantity):
    rates, weights = flux_relaxation(quantity)
    assert weights.sum() == pytest.approx(1.0, rel=1e-12)
    first = {"viscosity": 1.0, "conductivity": 0.5}[quantity]  # of the first polynomial, exact
    assert weights @ rates == pytest.approx(first, rel=1e-9)
    eta = 1e-9
    static = theory.number_density(eta, 2) * {"viscosity": 1.0, "conductivity": 2.0}[quantity]
    coefficient = {"viscosity": theory.enskog_viscosity, "conductivity": theory.enskog_conductivity}[quantity]
    expected = coefficient(eta, 2) * theory.collision_rate(eta, 2) / static
    assert (weights / rates).sum() == pytest.approx(expected, rel=5e-5)


def test_the_heat_flux_of_discs_relaxes_half_as_fast_as_their_stress():
    """Integrals of the correlations, 2.059 and 1.022 collisions; their mean times, 2.102 and 1.045."""
    for quantity, delay, mean_time in (("conductivity", 2.0594, 2.1019), ("viscosity", 1.0220, 1.0455)):
        rates, weights = flux_relaxation(quantity)
        parts = weights / rates
        assert parts.sum() == pytest.approx(delay, abs=2e-4)
        assert (parts / rates).sum() / parts.sum() == pytest.approx(mean_time, abs=1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_sums_of_collisional_invariants_make_fluxes_by_collisions(dimension):
    """By which the vertices of mode coupling are delayed: <i1 + i2 |T| a1 b2 + a2 b1> = 2 r_i <i|ab>, here of
    momenta a = b = v_n, and all parts of the stress together."""
    weights, velocities = collisions(dimension, 8)
    normal, other = (np.array([v[-1] for v in velocities]) for _ in range(2))
    crossed = [normal[0] * other[1], normal[2] * other[3]]  # a1 b2 before and after
    own = [normal[0] * other[0] + normal[1] * other[1], normal[2] * other[2] + normal[3] * other[3]]
    gained = weights @ ((crossed[1] - crossed[0]) * own[0])
    lost = weights @ ((own[1] - own[0]) * own[0])
    assert 2.0 * gained == pytest.approx(-lost, rel=1e-12)


def test_unequal_polynomials_do_not_depend_on_the_number_of_nodes():
    few, many = (brackets(1, range(1, 4), collisions(2, nodes)) for nodes in (9, 12))
    np.testing.assert_allclose(few, many, rtol=1e-10, atol=1e-12)
    assert math.isclose(few[0, 1], few[1, 0], rel_tol=1e-10)
