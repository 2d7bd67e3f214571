import math

import numpy as np
import pytest
from scipy.integrate import quad

from gaspart import theory
from gaspart.theory.modes import diffusion_modes, sound_attenuation, velocity_autocorrelation_modes


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_large_container_has_the_known_tail(dimension):
    eta, time = 0.2, 30.0
    infinite = float(theory.velocity_autocorrelation_tail(time, eta, dimension))
    count = {2: 4_000_000, 3: 30_000_000}[dimension]
    found = float(velocity_autocorrelation_modes(time, eta, dimension, count))
    # What is left is the sound of the infinite fluid, which decays faster.
    later = float(velocity_autocorrelation_modes(4 * time, eta, dimension, count))
    tail = float(theory.velocity_autocorrelation_tail(4 * time, eta, dimension))
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
    shear = float(theory.velocity_autocorrelation_tail(time, eta, 3))
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
