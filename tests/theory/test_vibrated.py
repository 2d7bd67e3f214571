"""The energy balance of a vibrated bed, against averages over Maxwellian velocities."""

import math

import pytest
from scipy.integrate import quad

from gaspart import theory

TEMPERATURE, GRAVITY, LAYERS, E = 3.0, 0.7, 2.5, 0.9


def maxwell(v, temperature=TEMPERATURE):
    return math.exp(-0.5 * v * v / temperature) / math.sqrt(2.0 * math.pi * temperature)


def density(z):
    """Discs of diameter 1 over their height, in a column of width 1."""
    return LAYERS * GRAVITY / TEMPERATURE * math.exp(-GRAVITY * z / TEMPERATURE)


def test_the_loss_is_that_of_the_contacts_of_an_exponential_atmosphere():
    """Pairs approach along their normal with v > 0, of variance 2 T: n^2 pi / 2 of them times v f(v), each
    loses (1 - e^2) v^2 / 4; at the floor (1 - e^2) v^2 / 2."""
    pairs = quad(lambda z: 0.5 * math.pi * density(z) ** 2, 0.0, math.inf)[0]
    one = quad(lambda v: v * maxwell(v, 2.0 * TEMPERATURE) * 0.25 * (1 - E**2) * v * v, 0.0, math.inf)[0]
    floor = quad(lambda v: v * maxwell(v) * 0.5 * (1 - E**2) * v * v, 0.0, math.inf)[0]
    lost = 2.0 * pairs * one + density(0.0) * floor
    assert lost == pytest.approx(theory.bed_loss(LAYERS, E) * LAYERS * GRAVITY * math.sqrt(TEMPERATURE))


def test_the_first_order_in_the_density_is_that_of_discs_in_hydrostatic_equilibrium():
    """Heights follow from dP = -n g dz with P = n T (1 + 2 eta); contacts are as frequent as n^2 g(d)."""
    eta = 1e-4

    def over_heights(function):
        """Integral over the bed of f(x), x the packing fraction at a height; dz = -dP / n, g = T = 1."""
        bottom = 0.5 * (math.sqrt(1.0 + 8.0 * eta) - 1.0) / 2.0  # x (1 + 2 x) = eta
        return quad(lambda x: function(x) * (1.0 + 4.0 * x) / x, 0.0, bottom, epsabs=0.0)[0]

    contact = 0.5 * theory.virial_coefficients(2)[0][2]
    pairs = over_heights(lambda x: x * x * (1.0 + contact * x)) / (0.5 * eta**2)
    dense, dilute = (theory.bed_loss(LAYERS, E, x) - theory.bed_loss(0.0, E) for x in (eta, 0.0))
    assert dense / dilute - 1.0 == pytest.approx(pairs - 1.0, rel=1e-3)
    mean = over_heights(lambda x: x * (1.0 + 2.0 * x)) / eta  # of z n: the integral of P over the weight
    assert theory.bed_height(eta) - 1.0 == pytest.approx(mean - 1.0, rel=1e-3)


def test_the_power_of_a_sine_is_that_of_particles_that_meet_it_at_random():
    """A floor of velocity u is met at the rate n (u - v) f(v), and gives 2 u (u - v) each time."""
    amplitude = 0.02

    def power(u):
        met = quad(lambda v: 2.0 * u * (u - v) ** 2 * maxwell(v), -30.0, u, epsabs=1e-12)[0]
        return density(0.0) * met

    mean = sum(power(amplitude * math.sin(2.0 * math.pi * (n + 0.5) / 40)) for n in range(40)) / 40
    expected = LAYERS * GRAVITY * 0.5 * amplitude**2 * math.sqrt(8.0 / (math.pi * TEMPERATURE))
    assert mean == pytest.approx(expected, rel=1e-3)


def test_the_temperatures_balance_what_is_given_and_lost():
    speed, square = 0.3, 0.02
    hot = theory.sawtooth_temperature(LAYERS, E) * speed**2
    assert theory.bed_loss(LAYERS, E) * math.sqrt(hot) == pytest.approx(speed)
    warm = theory.sine_temperature(LAYERS, E) * square
    assert theory.bed_loss(LAYERS, E) * math.sqrt(warm) == pytest.approx(
        square * math.sqrt(8.0 / (math.pi * warm))
    )


def test_in_a_thick_bed_the_temperature_is_kumarans():
    many = 1e4
    expected = 4.0 * math.sqrt(2.0) / (math.pi * many * (1.0 - E**2))
    assert theory.sine_temperature(many, E) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("wrong", [(-1.0, 0.9), (2.0, 1.1), (math.nan, 0.9)])
def test_impossible_beds_are_refused(wrong):
    with pytest.raises(ValueError, match="layers|restitution"):
        theory.bed_loss(*wrong)
