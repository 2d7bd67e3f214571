import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm
from scipy.signal import fftconvolve

from gaspart import theory
from gaspart.errors import SceneError
from gaspart.theory import mode_pairs
from gaspart.theory import modes as relaxing_modes
from gaspart.theory.diffusion import velocity_autocorrelation_tail
from gaspart.theory.modes import (
    Relaxation,
    diffusion_modes,
    heat_capacities,
    sound_attenuation,
    velocity_autocorrelation_modes,
)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_large_container_has_the_known_tail(dimension):
    eta, time = 0.2, 30.0
    infinite = float(velocity_autocorrelation_tail(time, eta, dimension))
    count = {2: 4_000_000, 3: 30_000_000}[dimension]
    found = float(velocity_autocorrelation_modes(time, eta, dimension, count))
    # What is left is the sound of the infinite fluid, which decays faster.
    later = float(velocity_autocorrelation_modes(4 * time, eta, dimension, count))
    tail = float(velocity_autocorrelation_tail(4 * time, eta, dimension))
    assert found == pytest.approx(infinite, rel=0.05)
    assert abs(later / tail - 1.0) < max(0.002, abs(found / infinite - 1.0))


def test_sound_of_an_infinite_fluid_by_its_integral():
    eta, time, count = 0.3, 8.0, 30_000_000
    density = float(theory.number_density(eta, 3))
    width = float(theory.enskog_diffusion(eta, 3)) + 0.5 * sound_attenuation(eta, 3)
    speed = float(theory.speed_of_sound(eta, 3))

    def mode(k):
        return k**2 * math.exp(-width * k**2 * time) * math.cos(speed * k * time)

    sound = quad(mode, 0.0, 12.0 / math.sqrt(width * time), limit=2000)[0] / (6.0 * math.pi**2 * density)
    shear = float(velocity_autocorrelation_tail(time, eta, 3))
    found = float(velocity_autocorrelation_modes(time, eta, 3, count))
    assert found == pytest.approx(shear + sound, rel=2e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_after_all_modes_have_decayed_one_nth_is_left(dimension):
    assert float(velocity_autocorrelation_modes(1e5, 0.3, dimension, 500)) == pytest.approx(1 / 500)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_diffusion_coefficient_is_the_integral(dimension):
    times = np.linspace(10.0, 40.0, 3001)
    correlation = velocity_autocorrelation_modes(times, 0.2, dimension, 2000)
    running = diffusion_modes(times, 0.2, dimension, 2000)
    middle = 0.5 * (correlation[1:] + correlation[:-1])
    assert np.cumsum(middle * np.diff(times)) == pytest.approx(running[1:] - running[0], rel=1e-4)


def test_a_dilute_gas_attenuates_sound_as_an_ideal_one():
    eta = 1e-4  # c_v = 3/2, c_p = 5/2
    density = float(theory.number_density(eta, 3))
    viscosity = float(theory.enskog_viscosity(eta, 3))
    conductivity = float(theory.enskog_conductivity(eta, 3))
    expected = (4.0 / 3.0 * viscosity + conductivity * (2.0 / 3.0 - 2.0 / 5.0)) / density
    assert sound_attenuation(eta, 3) == pytest.approx(expected, rel=1e-3)


def test_times_must_be_positive():
    with pytest.raises(ValueError, match="time"):
        diffusion_modes(0.0, 0.2, 2, 100)


# Pairs of hydrodynamic modes, against linearised equations that are solved without modes.


QUANTITIES = ["viscosity", "conductivity"]


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_integrals_are_those_of_the_coupled_equations(quantity):
    """The modes' sums against correlations of the linear equations of a gas whose fluxes relax, which are
    solved without modes, delayed twice by quadrature."""
    eta, count, time = 0.3, 36, 6.0
    relaxation = Relaxation.of(eta, quantity)
    steps = np.linspace(0.0, time, 801)
    kernel = (relaxation.weights * relaxation.rates) @ np.exp(-np.multiply.outer(relaxation.rates, steps))
    squares, numbers = mode_pairs._wave_numbers(eta, count, time, 3.0)
    density = float(theory.number_density(eta, 2))
    pairs = np.zeros(len(steps))
    for square, number in zip(squares, numbers, strict=True):
        pairs += number * density / count * _relaxing_pair(eta, math.sqrt(square), steps, quantity)
    for _ in range(2):
        pairs = fftconvolve(pairs * _ends(len(steps)), kernel * _ends(len(steps)))[: len(steps)] * steps[1]
    expected = np.trapezoid(pairs, steps) + relaxation.integral(np.array([time]))[0]
    assert theory.transport_modes(time, eta, count, quantity, 3.0) == pytest.approx(expected, rel=2e-3)


def _ends(size):
    """Weights of the trapezium rule."""
    weights = np.ones(size)
    weights[0] = 0.5
    return weights


def _relaxing_pair(eta, k, steps, quantity):
    """The correlation of the pair of k and -k, by powers of the propagator over a step."""
    along, across = (
        expm(steps[1] * matrix(eta, np.array([k]))[0])
        for matrix in (relaxing_modes.longitudinal_matrix, relaxing_modes.transverse_matrix)
    )
    found, moved = np.eye(len(along), dtype=complex), np.eye(len(across), dtype=complex)
    z, capacity = float(theory.compressibility_factor(eta, 2)), heat_capacities(eta, 2)[0]
    slope = float(theory.speed_of_sound(eta, 2)) ** 2 - z**2 / capacity
    flux = np.array([(slope - z) / math.sqrt(slope), (capacity + z) / math.sqrt(capacity), 0.0])
    series = []
    for _ in steps:
        field, shear = found[:3, :3], moved[0, 0]
        if quantity == "viscosity":
            value = (field[2, 2] ** 2 + shear**2) / 4.0 + field[2, 2] * shear / 2.0
        else:
            carried, crossed = flux @ field @ flux, flux @ field[:, 2]
            value = 0.5 * (carried * (field[2, 2] + shear) - crossed**2)
        series.append(value.real)
        found, moved = found @ along, moved @ across
    return np.array(series)


def uniform_mode(times, eta, count, quantity):
    """The term k = 0 of `transport_modes`, absent at fixed momentum and energy: rho / N (k_B T), or
    rho / N (c_p + c^2), times the time without the delays of both vertices."""
    weight = 1.0
    if quantity == "conductivity":
        weight = heat_capacities(eta, 2)[1] + float(theory.speed_of_sound(eta, 2)) ** 2
    relaxation, still = mode_pairs.Relaxation.of(eta, quantity), np.zeros(1, dtype=complex)
    grown = np.array([mode_pairs._integrate_delayed(still, time, relaxation)[0].real for time in times])
    return theory.number_density(eta, 2) / count * weight * grown


def logarithmic_slope(eta, quantity):
    """Growth of the Green-Kubo integral of an infinite fluid per factor e of time (module `mode_pairs`)."""
    density = theory.number_density(eta, 2)
    shear, sound = float(theory.enskog_viscosity(eta, 2)) / density, sound_attenuation(eta, 2)
    if quantity == "viscosity":
        return (1.0 / shear + 1.0 / sound) / (32.0 * math.pi)
    capacity = heat_capacities(eta, 2)[1]
    heat = float(theory.enskog_conductivity(eta, 2)) / (density * capacity)
    return (capacity / (shear + heat) + float(theory.speed_of_sound(eta, 2)) ** 2 / sound) / (8.0 * math.pi)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_containers_differ_by_the_uniform_mode_until_sound_has_crossed(quantity):
    eta = 0.3
    times = np.array([2.0, 4.0]) / float(theory.collision_rate(eta, 2)) * 1.5
    found = [
        theory.transport_modes(times, eta, count, quantity) + uniform_mode(times, eta, count, quantity)
        for count in (256, 1024, 4096)
    ]
    np.testing.assert_allclose(found[1:], found[:-1], rtol=2e-4)
    alone = theory.transport_modes(times, eta, 256, quantity)
    assert (np.abs(alone / found[2] - 1.0) > 5e-4).all()


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_large_container_grows_by_the_slope(quantity):
    """But for the term of k = 0, and for the sound that decays faster than 1/t."""
    eta, count = 0.3, 1_000_000
    times = np.array([100.0, 300.0])
    growth = np.diff(theory.transport_modes(times, eta, count, quantity))[0]
    growth += np.diff(uniform_mode(times, eta, count, quantity))[0]
    expected = logarithmic_slope(eta, quantity) * math.log(3.0)
    assert growth == pytest.approx(expected, rel=0.02)


def test_the_conductivity_of_discs_grows_at_three_tenths_as_measured():
    """From 11 collisions on, over Enskog's coefficient: event-driven runs of version 0.2.0, which the first
    order alone (0.009, 0.016, 0.026; 0.012) does not describe."""
    eta, quantity = 0.3, "conductivity"
    measured = {
        1024: ((21, 0.034, 0.006), (31, 0.043, 0.010), (41, 0.055, 0.012)),
        256: ((41, 0.054, 0.006),),
    }
    rate, unit = float(theory.collision_rate(eta, 2)), float(theory.enskog_conductivity(eta, 2))
    for count, rows in measured.items():
        times = np.array([11.0, *(row[0] for row in rows)]) / rate
        ends = [
            theory.transport_modes(times, eta, count, quantity, shortest) / unit for shortest in (1.0, 2.0)
        ]
        grown, longer = (end[1:] - end[0] for end in ends)
        for value, other, (_, expected, error) in zip(grown, longer, rows, strict=True):
            assert abs(value - expected) < 3.0 * math.hypot(error, value - other)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_nothing_grows_after_all_modes_have_decayed(quantity):
    late = theory.transport_modes(np.array([1e4, 2e4]), 0.3, 256, quantity)
    assert late[0] == pytest.approx(late[1], rel=1e-12)


def test_an_unknown_quantity_is_refused():
    with pytest.raises(SceneError, match="quantity"):
        theory.transport_modes(1.0, 0.2, 100, "heat")
