import numpy as np
import pytest
from scipy.integrate import quad

from gaspart import theory
from gaspart.theory.speeds import (
    RELAXATION_UNCERTAINTY,
    entropy_deficit,
    equal_speeds,
    initial_kurtosis_slope,
    kurtosis_scatter,
)

UNITS = {"temperature": 2.5, "mass": 0.7}


@pytest.mark.parametrize("dimension", [2, 3])
def test_maxwell_moments(dimension):
    def moment(order):
        return quad(lambda v: v**order * theory.maxwell_pdf(v, dimension, **UNITS), 0.0, 40.0)[0]

    assert moment(0) == pytest.approx(1.0, rel=1e-9)
    assert moment(1) == pytest.approx(theory.mean_speed(dimension, **UNITS), rel=1e-9)
    assert moment(2) == pytest.approx(dimension * 2.5 / 0.7, rel=1e-9)
    assert moment(4) / moment(2) ** 2 == pytest.approx(theory.kurtosis(dimension), rel=1e-9)


@pytest.mark.parametrize("dimension", [2, 3])
def test_maxwell_cdf_is_the_integral_of_the_pdf_and_ppf_its_inverse(dimension):
    speeds = np.array([0.3, 1.0, 2.7])
    integrals = [quad(lambda v: theory.maxwell_pdf(v, dimension, **UNITS), 0.0, speed)[0] for speed in speeds]
    np.testing.assert_allclose(theory.maxwell_cdf(speeds, dimension, **UNITS), integrals, rtol=1e-9)
    probabilities = theory.maxwell_cdf(speeds, dimension, **UNITS)
    np.testing.assert_allclose(theory.maxwell_ppf(probabilities, dimension, **UNITS), speeds, rtol=1e-9)
    assert theory.maxwell_cdf(-1.0, dimension) == 0.0
    assert theory.maxwell_pdf(-1.0, dimension) == 0.0


@pytest.mark.parametrize("zero_momentum", [False, True])
@pytest.mark.parametrize("dimension", [2, 3])
def test_kurtosis_of_a_few_particles_at_fixed_energy(dimension, zero_momentum):
    count = 4
    velocities = np.random.default_rng(5).standard_normal((200_000, count, dimension))
    if zero_momentum:
        velocities -= velocities.mean(axis=1, keepdims=True)
    velocities /= np.sqrt((velocities**2).sum(axis=(1, 2), keepdims=True) / count)
    squares = (velocities**2).sum(axis=2)
    measured = (squares**2).mean(axis=1)
    error = measured.std() / np.sqrt(measured.size)
    assert abs(measured.mean() - theory.kurtosis(dimension, count, zero_momentum)) < 4.0 * error


@pytest.mark.parametrize("count", [8, 50])
@pytest.mark.parametrize("dimension", [2, 3])
def test_scatter_of_the_kurtosis_of_a_few_particles(dimension, count):
    squares = (np.random.default_rng(6).standard_normal((200_000, count, dimension)) ** 2).sum(axis=2)
    measured = (squares**2).mean(axis=1) / squares.mean(axis=1) ** 2
    deviation, skewness = kurtosis_scatter(dimension, count)
    centred = measured - theory.kurtosis(dimension, count)
    assert centred.std() == pytest.approx(deviation, rel=0.01)
    assert (centred**3).mean() / deviation**3 == pytest.approx(skewness, rel=0.06)


@pytest.mark.parametrize("zero_momentum", [False, True])
@pytest.mark.parametrize("dimension", [2, 3])
def test_speeds_of_a_few_particles_at_fixed_energy(dimension, zero_momentum):
    count = 5
    freedoms = dimension * (count - 1 if zero_momentum else count)
    velocities = np.random.default_rng(7).standard_normal((100_000, count, dimension))
    if zero_momentum:
        velocities -= velocities.mean(axis=1, keepdims=True)
    velocities *= np.sqrt(freedoms / (velocities**2).sum(axis=(1, 2), keepdims=True))  # k_B T = m = 1
    one = velocities[:, 0] * np.sqrt(count / (count - 1) if zero_momentum else 1.0)
    speeds = np.array([0.3, 1.0, 2.0, 2.6])
    measured = (np.linalg.norm(one, axis=1)[:, None] < speeds).mean(axis=0)
    expected = theory.maxwell_cdf(speeds, dimension, freedoms=freedoms)
    assert np.abs(measured - expected).max() < 4.0 * 0.5 / np.sqrt(len(one))
    assert np.abs(expected - theory.maxwell_cdf(speeds, dimension)).max() > 0.01  # which Maxwell's is not
    assert theory.maxwell_cdf(np.sqrt(freedoms), dimension, freedoms=freedoms) == 1.0
    many = theory.maxwell_cdf(speeds, dimension, freedoms=1e9)
    np.testing.assert_allclose(many, theory.maxwell_cdf(speeds, dimension), rtol=1e-6)
    with pytest.raises(ValueError, match="freedoms = .*: must be more than"):
        theory.maxwell_cdf(1.0, dimension, freedoms=dimension)


@pytest.mark.parametrize("dimension", [2, 3])
def test_relaxation_starts_with_the_exact_slopes(dimension):
    curve = theory.relaxation(dimension)
    assert curve.kurtosis(0.0) == 1.0
    assert curve.never_hit(0.0) == 1.0
    s = 0.2
    # Second order from the curve itself: the slope at 0 is extrapolated from two intervals.
    slope = (4.0 * (curve.kurtosis(s) - 1.0) - (curve.kurtosis(2 * s) - 1.0)) / (2.0 * s)
    assert slope == pytest.approx(initial_kurtosis_slope(dimension), abs=3e-3)
    assert (1.0 - curve.never_hit(0.01)) / 0.01 == pytest.approx(1.0, abs=0.01)


def test_initial_slope_of_spheres_by_direct_averaging():
    # Equal speeds 1, isotropic directions; pairs meet in proportion to their relative speed, and leave with
    # their relative velocity turned isotropically (3D). d<v^4>/ds: mean change of a pair's sum of v^4.
    c = np.linspace(-1.0, 1.0, 20_001)
    relative = np.sqrt(2.0 - 2.0 * c)
    total = 2.0 + 2.0 * c  # |v1 + v2|^2
    # v1' = V/2 + u/2, |V| = sqrt(total): |v1'|^2 = 1 + x sqrt(total) relative / 2, x uniform in [-1, 1].
    gain = 2.0 * (total * relative**2 / 4.0) / 3.0
    # s = 1 is half a collision event per particle, so the change per particle is half the pair's.
    slope = 0.5 * np.trapezoid(gain * relative, c) / np.trapezoid(relative, c)
    assert slope == pytest.approx(initial_kurtosis_slope(3), rel=1e-6)


@pytest.mark.parametrize("dimension", [2, 3])
def test_relaxation_curves_are_monotonic_and_reach_equilibrium(dimension):
    curve = theory.relaxation(dimension)
    s = np.linspace(0.0, 30.0, 3001)
    # The tables are Monte Carlo: a step may go back by its noise, not by more.
    assert np.all(np.diff(curve.kurtosis(s)) > -RELAXATION_UNCERTAINTY)
    assert np.all(np.diff(curve.never_hit(s)) < 1e-4)
    assert curve.kurtosis(40.0) == pytest.approx(theory.kurtosis(dimension), abs=1e-6)
    assert curve.never_hit(40.0) < 1e-15
    end = theory.mean_speed(dimension) / np.sqrt(dimension)
    assert curve.mean_speed(30.0) == pytest.approx(end, abs=1e-5)
    # No jump where the table ends and the decay is continued.
    around = curve.kurtosis(curve.longest + np.array([-1e-6, 1e-6]))
    assert abs(np.diff(around)[0]) < 1e-6


@pytest.mark.parametrize(("dimension", "tolerance"), [(2, 5e-3), (3, 3e-3)])
def test_clock_runs_fast_at_first_and_at_the_equilibrium_rate_in_the_end(dimension, tolerance):
    curve = theory.relaxation(dimension)
    # <v_12> of equal speeds: 4/pi (2D), 4/3 (3D); of Maxwell's at the same energy: sqrt 2 <v>.
    equal = {2: 4.0 / np.pi, 3: 4.0 / 3.0}[dimension]
    maxwell = np.sqrt(2.0) * theory.mean_speed(dimension) / np.sqrt(dimension)
    assert curve.collisions(0.05) / 0.05 == pytest.approx(equal / maxwell, abs=tolerance)
    late = (curve.collisions(7.0) - curve.collisions(5.0)) / 2.0
    assert late == pytest.approx(1.0, abs=tolerance)
    assert curve.collisions(100.0) - curve.collisions(99.0) == pytest.approx(1.0, rel=1e-12)


def test_relaxation_refuses_negative_counts():
    with pytest.raises(ValueError, match="must not be negative"):
        theory.relaxation(2).kurtosis(-1.0)
    with pytest.raises(ValueError, match="dimension"):
        theory.relaxation(1)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_mean_speed_of_few_particles_is_that_on_a_sphere(dimension):
    rng, count = np.random.default_rng(5), 3
    velocities = rng.standard_normal((200_000, count, dimension))
    velocities *= np.sqrt(dimension * count / np.sum(velocities**2, axis=(1, 2)))[:, None, None]
    speeds = np.linalg.norm(velocities, axis=2).mean(axis=1)
    error = speeds.std() / np.sqrt(speeds.size)
    assert abs(speeds.mean() - theory.mean_speed(dimension, count=count)) < 3.0 * error
    assert error < 2e-4 * theory.mean_speed(dimension)


# Boltzmann equation on a grid of energies, against its direct simulation and exact values.


EDGES = np.linspace(0.0, 2.5, 50)


def test_the_grid_agrees_with_the_direct_simulation():
    gas, table = equal_speeds(4.0), theory.relaxation(3)
    s = gas.collisions
    assert gas.shares.sum(axis=1) == pytest.approx(np.ones(len(s)), abs=1e-12)
    assert gas.never_hit == pytest.approx(table.never_hit(s), abs=3.0 * RELAXATION_UNCERTAINTY)
    assert gas.kurtosis == pytest.approx(table.kurtosis(s), abs=3.0 * RELAXATION_UNCERTAINTY)
    assert np.interp(0.1, s, gas.kurtosis) - 1.0 == pytest.approx(0.1 * 8.0 / 35.0, rel=0.03)


def test_entropy_rises_in_each_step_and_starts_at_that_of_one_class():
    deficit = equal_speeds(8.0).deficit(EDGES)
    assert np.diff(deficit).max() < 0.0
    below = theory.maxwell_cdf(EDGES, 3, 1.0 / 3.0)
    first = np.searchsorted(EDGES, 1.0) - 1
    assert deficit[0] == pytest.approx(-np.log(below[first + 1] - below[first]), rel=1e-3)
    assert 0.0 < deficit[-1] < 3e-4


def test_deficit_of_a_small_deviation_is_half_its_mean_square():
    expected, deviation = np.array([0.2, 0.3, 0.5]), np.array([0.01, -0.01, 0.002])
    deviation -= expected @ deviation
    found = entropy_deficit(expected * (1.0 + deviation), expected)
    assert found == pytest.approx(0.5 * expected @ deviation**2, rel=0.02)
    assert entropy_deficit(np.array([0.0, 1.0, 0.0]), expected) == pytest.approx(-np.log(0.3))
