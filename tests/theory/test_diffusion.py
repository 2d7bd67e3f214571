import math

import numpy as np
import pytest
from scipy.integrate import quad

import gaspart as gp
from gaspart import theory
from gaspart.theory import diffusion
from gaspart.theory.boltzmann import brackets, collisions
from gaspart.theory.diffusion import (
    ERPENBECK_WOOD_HIGHEST,
    ERPENBECK_WOOD_UNCERTAINTY,
    velocity_autocorrelation_tail,
    velocity_decay_rate,
    viscosity_ratio,
)


def test_erpenbeck_wood_reproduces_the_table(table):
    rows = table("enskog_3d")
    computed = theory.erpenbeck_wood_diffusion(rows["packing_fraction"])
    np.testing.assert_allclose(computed, rows["diffusion_erpenbeck_wood"], rtol=1e-5)
    assert theory.erpenbeck_wood_ratio(0.0) == 1.0


# rho sigma^3 and D of Pieprzyk and others, Phys. Chem. Chem. Phys. 21, 6886 (2019), by a public script.
PIEPRZYK = np.array(
    [
        *[(0.10, 1.94786), (0.20, 0.89989), (0.30, 0.55523), (0.40, 0.37845), (0.50, 0.265009)],
        *[(0.60, 0.183259), (0.70, 0.121081), (0.75, 0.095425), (0.80, 0.072934), (0.85, 0.053298)],
    ]
)


def test_erpenbeck_wood_differs_from_a_later_table_by_its_uncertainty():
    density, diffusion = PIEPRZYK.T
    ratio = theory.erpenbeck_wood_diffusion(theory.packing_fraction(density, 3)) / diffusion
    assert 0.9 < np.abs(ratio - 1.0).max() / ERPENBECK_WOOD_UNCERTAINTY < 1.01


def test_yeh_hummer_at_the_stated_scene():
    # 15 % of D at N = 256, rho = 0.7.
    density, count = 0.7, 256
    eta = theory.packing_fraction(density, 3)
    length = (count / density) ** (1.0 / 3.0)
    shift = theory.yeh_hummer(length, theory.enskog_viscosity(eta, 3))
    assert shift / theory.erpenbeck_wood_diffusion(eta) == pytest.approx(0.15, abs=0.02)
    assert theory.yeh_hummer(2 * length, 1.0) == pytest.approx(0.5 * theory.yeh_hummer(length, 1.0))


def test_diffusion_in_a_cube_has_the_units_of_its_particles():
    """Half of Yeh and Hummer's shift in a dilute gas, nearly all of it in a dense one; of length^2 / time."""
    for eta, part in ((0.01, 0.47), (0.4, 0.96)):
        inside, unsure = theory.diffusion_in_cube(eta, 20.0)
        infinite = float(theory.erpenbeck_wood_diffusion(eta))
        shift = infinite - inside
        viscosity = viscosity_ratio(eta) * theory.enskog_viscosity(eta, 3)
        whole = float(theory.yeh_hummer(20.0, viscosity))
        assert shift / whole == pytest.approx(part, abs=0.02)
        part = min(0.5, 0.05 + 2.0 * theory.mean_free_path(eta, 3) / 20.0)
        assert unsure == pytest.approx(np.hypot(0.007 * infinite, part * shift))
        other = theory.diffusion_in_cube(eta, 40.0, diameter=2.0, temperature=3.0, mass=12.0)
        assert other == pytest.approx((inside, unsure))
    assert theory.diffusion_in_cube(0.46, 1e6)[1] > 0.02 * theory.diffusion_in_cube(0.46, 1e6)[0]


def test_d_of_few_spheres_is_within_its_uncertainty():
    """Relative to the rows of the table in cubes whose images order the fluid by less than a tenth."""
    z, refused = [], 0
    for row in theory.small_systems("diffusion", 3):
        count = int(row["count"])
        side = (count * theory.particle_volume(3) / row.packing_fraction) ** (1.0 / 3.0)
        about_centre = count / (count - 1.0)
        if row.packing_fraction > ERPENBECK_WOOD_HIGHEST:
            continue
        try:
            value, error = theory.diffusion_in_cube(float(row.packing_fraction), side)
        except gp.SceneError:
            refused += 1
            assert side < 2.6
            continue
        z.append((about_centre * row.value - value) / np.hypot(error, about_centre * row.error))
    assert len(z) > 40 and np.abs(z).max() < 2.0 and refused > 10


@pytest.mark.parametrize("dimension", [2, 3])
def test_decay_rate_is_the_first_sonine_approximation_of_diffusion(dimension):
    rate = velocity_decay_rate(0.2, dimension, diameter=0.5, temperature=2.0, mass=3.0)
    first = 2.0 / (3.0 * rate)
    sonine = theory.enskog_diffusion(0.2, dimension, 0.5, 2.0, 3.0) / first
    assert sonine == pytest.approx({2: 1.02710, 3: 1.01895}[dimension], rel=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_mean_squared_displacement_is_ballistic_then_diffusive(dimension):
    eta, temperature, mass, diameter = 0.05, 2.0, 3.0, 0.5
    arguments = (eta, dimension, diameter, temperature, mass)
    constant = theory.enskog_diffusion(*arguments)
    free_time = mass * constant / temperature
    short, long = 1e-5 * free_time, 1e5 * free_time
    ballistic = dimension * temperature / mass * short**2
    assert theory.enskog_mean_squared_displacement(short, *arguments) == pytest.approx(ballistic, rel=1e-5)
    diffusive = 2.0 * dimension * constant * long
    assert theory.enskog_mean_squared_displacement(long, *arguments) == pytest.approx(diffusive, rel=1e-4)
    assert theory.enskog_mean_squared_displacement(0.0, *arguments) == 0.0
    # Across the switch between the series and the closed form.
    times = free_time * np.array([0.99e-3, 1.01e-3])
    values = theory.enskog_mean_squared_displacement(times, *arguments)
    started = 2e-5 * free_time * velocity_decay_rate(*arguments)
    assert values[1] / values[0] == pytest.approx((1.01 / 0.99) ** 2 * (1 - started / 3.0), rel=1e-7)


@pytest.mark.parametrize(("dimension", "polynomials", "close"), [(2, 5, 1e-4), (3, 3, 3e-4)])
def test_velocities_relax_as_the_linear_boltzmann_equation_says(dimension, polynomials, close):
    """In moments of the spectrum, which are derivatives of the correlation at 0: of spheres by three
    polynomials, which cost less than five."""
    norms = [
        2.0 * math.gamma(order + 1.0 + 0.5 * dimension) / math.gamma(0.5 * dimension) / math.factorial(order)
        for order in range(polynomials)
    ]
    met = collisions(dimension, 2 * polynomials + 1)
    matrix = brackets(1, range(polynomials), met, tagged=True) / np.sqrt(np.outer(norms, norms))
    matrix /= {2: 2.0, 3: 4.0}[dimension] * math.sqrt(math.pi)  # collisions of a particle
    rates, weights = map(np.array, diffusion._VELOCITY_DECAY[dimension])
    for order in range(2 * polynomials):
        moment = np.linalg.matrix_power(matrix, order)[0, 0]
        assert weights @ rates**order == pytest.approx(moment, rel=close)
    sonine = {2: 1.02710, 3: 1.01895}[dimension]
    assert (weights @ rates) * (weights / rates).sum() == pytest.approx(sonine, rel=1e-4)


def test_logarithmic_slope_is_the_integral_of_the_tail():
    eta, temperature, mass, diameter = 0.2, 2.0, 3.0, 0.5
    arguments = (eta, 2, diameter, temperature, mass)
    integral = quad(lambda t: velocity_autocorrelation_tail(t, *arguments), 10.0, 10.0 * np.e)[0]
    slope = theory.logarithmic_slope(eta, diameter, temperature, mass)
    assert temperature / mass * integral == pytest.approx(slope, rel=1e-8)


def test_the_viscosity_ratio_is_that_of_the_table():
    eta = np.array([0.0, 0.1, 0.3, 0.4, 0.425, 0.49])
    assert viscosity_ratio(eta) == pytest.approx([1.0, 1.0, 1.0, 1.1219, 1.22785, 1.7817])
    with pytest.raises(ValueError, match="packing_fraction"):
        viscosity_ratio(0.5)
