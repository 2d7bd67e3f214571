"""Pressure on walls against the exact second order, on both kinds of container, and where it is refused."""

import math

import numpy as np
import pytest
from scipy.stats import qmc

from gaspart import theory


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_tension_starts_with_its_exact_second_order_and_meets_the_table(dimension):
    first = {2: 1.0 / 3.0, 3: math.pi / 8.0}[dimension] * theory.number_density(1e-5, dimension) ** 2
    assert theory.surface_tension(1e-5, dimension) == pytest.approx(-first, rel=1e-3)
    known = {2: -0.109855, 3: -0.494782}[dimension]
    assert theory.surface_tension(0.3, dimension) == pytest.approx(known, rel=1e-4)
    eta = np.array([0.01, 0.1, 0.3, 0.45])
    assert np.all(theory.surface_tension_uncertainty(eta, dimension) > 0.0)


def within_a_diameter(uniform):
    """Uniform numbers in [0, 1), (n, d), as places in the ball of radius 1, (n, d)."""
    d = uniform.shape[1]
    radius, turn = uniform[:, 0] ** (1.0 / d), 2.0 * np.pi * uniform[:, -1]
    height = 2.0 * uniform[:, 1] - 1.0 if d == 3 else 0.0
    flat = radius * np.sqrt(1.0 - height**2)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), radius * height][:d], axis=1)


def third_order(dimension, seed):
    """The third order of gamma over its second, over eta, by the cluster integrals of two and three centres.

    Of a cluster, a wall takes off as many places as it extends along the normal: the coefficient of z^n of
    -gamma is -1 / (2 n!) times the integral of Ursell's function times that extent, z = rho (1 + 2 B2 rho).
    """
    ball = {2: math.pi, 3: 4.0 * math.pi / 3.0}[dimension]
    uniform = qmc.Sobol(2 * dimension, seed=seed).random_base2(16)
    a, b = within_a_diameter(uniform[:, :dimension]), within_a_diameter(uniform[:, dimension:])
    along = np.stack([a[:, 0], b[:, 0], np.zeros(len(a))])
    triangle = np.sum((a - b) ** 2, axis=1) < 1.0
    three = -np.mean(np.ptp(along, axis=0) * (3.0 - triangle)) * ball**2 / 12.0
    two = np.mean(np.abs(a[:, 0])) * ball / 4.0
    return (2.0 * ball + three / two) * theory.number_density(1.0, dimension)


def test_the_tension_of_discs_is_exact_to_third_order():
    found = np.array([third_order(2, seed) for seed in range(8)])
    eta = 1e-5
    leading = -(theory.number_density(eta, 2) ** 2) / 3.0
    stated = (theory.surface_tension(eta, 2) / leading - 1.0) / eta
    assert stated == pytest.approx(found.mean(), abs=3.0 * found.std(ddof=1) / math.sqrt(8.0) + 2e-4)


def test_the_table_of_spheres_agrees_with_the_exact_third_order_within_its_uncertainty():
    eta, third = 0.01, third_order(3, seed=1)
    leading = -math.pi / 8.0 * theory.number_density(eta, 3) ** 2
    beyond = abs(theory.surface_tension(eta, 3) / leading - 1.0 - third * eta)
    assert beyond < theory.surface_tension_uncertainty(eta, 3) / abs(leading)


def second_order(length, density, dimension, axes):
    """Z of one container to second order in the density, exact, from its free energy per particle

    -ln V + (N / 2 V^2) times the volume of pairs of centres closer than sigma, N large.
    """
    inner, width = length - 1.0, 100.0
    moments = {2: (math.pi, 4.0 / 3.0, 0.5), 3: (4.0 * math.pi / 3.0, math.pi / 2.0, 8.0 / 15.0, 1.0 / 6.0)}
    bodies = density * inner**axes * width ** (dimension - axes)

    def logarithm(stretched):
        sides = [stretched] + [inner] * (axes - 1) + [width] * (dimension - axes)
        close = 0.0
        for walls in range(2**axes):  # each walled axis gives its length, or minus |x|
            chosen = [k for k in range(axes) if walls >> k & 1]
            lengths = math.prod(side for k, side in enumerate(sides) if k not in chosen)
            close += (-1) ** len(chosen) * moments[dimension][len(chosen)] * lengths
        volume = math.prod(sides)
        return math.log(volume) - 0.5 * bodies * close / volume**2

    step = 1e-4 * inner
    return inner * (logarithm(inner + step) - logarithm(inner - step)) / (2.0 * step)


@pytest.mark.parametrize(("dimension", "axes"), [(2, 1), (2, 2), (3, 1), (3, 2), (3, 3)])
def test_a_dilute_gas_in_any_container_is_exact_to_second_order(dimension, axes):
    length, density = 12.0, 1e-3
    value, error = theory.wall_pressure(length, density, 10**9, dimension, axes)
    eta = theory.packing_fraction(density, dimension)
    bulk = {2: 2.0, 3: 4.0}[dimension] * eta
    # What walls take off; surfaces are right to 1 %, of which third orders are half; edges are 2 % of them.
    found = value / density - theory.compressibility_factor(eta, dimension)
    assert found == pytest.approx(second_order(length, density, dimension, axes) - 1.0 - bulk, rel=0.01)
    assert 0.0 < error < 0.05 * abs(found) * density


def test_a_wide_slit_holds_the_bulk():
    z = theory.compressibility_factor(0.3, 3)
    density = theory.number_density(0.3, 3)
    value, _ = theory.wall_pressure(1e5, density, 10**9, 3, 1)
    assert value == pytest.approx(density * z, rel=1e-4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [((1.0, 0.1, 10, 2, 1), "length"), ((9.0, 0.1, 10, 2, 3), "axes"), ((9.0, 1.3, 99, 3, 1), "density")],
)
def test_invalid_containers_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        theory.wall_pressure(*arguments)
