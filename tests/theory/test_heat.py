import numpy as np
import pytest
from theory.electrons import MetalSlab

from gaspart.theory import heat
from gaspart.theory.enskog import enskog_conductivity, mean_free_path
from gaspart.theory.geometry import packing_fraction
from gaspart.theory.shear import free_molecular_stress


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_flux_of_free_flight_is_the_sum_over_particles(dimension):
    """Flux-weighted energies drawn from both walls, times how often a particle goes there and back."""
    rng = np.random.default_rng(1)
    energies, times = {}, 0.0
    for temperature in (2.0, 1.0):
        normal = np.sqrt(-2.0 * temperature * np.log(rng.random(400_000)))
        across = temperature * rng.chisquare(dimension - 1, normal.size) / 2.0
        energies[temperature] = 0.5 * normal**2 + across
        times += (1.0 / normal).mean()
    carried = (energies[2.0] - energies[1.0]).mean()
    found = 0.3 * carried / times  # for a gap of length 1
    assert found == pytest.approx(heat.free_molecular_flux(0.3, 2.0, 1.0, dimension), rel=0.01)


@pytest.mark.parametrize(("dimension", "share"), [(2, 2 / 3), (3, 1 / 2)])
def test_the_normal_component_alone_carries_a_part(dimension, share):
    complete = heat.free_molecular_flux(0.1, 2.0, 1.0, dimension)
    assert heat.free_molecular_flux(0.1, 2.0, 1.0, dimension, components="normal") == pytest.approx(
        share * complete
    )


@pytest.mark.parametrize(("one", "other"), [(0.7, 0.2), (0.2, 0.7), (0.5, 0.5), (1.0, 0.3)])
def test_partial_accommodation_by_the_balance_of_streams(one, other):
    """Streams (hot and cold, to the cold wall and back) that both walls turn into one another, solved as
    linear equations, carry the flux and the stress of the closed forms."""
    hot, cold, density = 3.0, 1.0, 0.3
    balance = np.array([
        [1.0, 0.0, -1.0, -one],  # hot ones that leave the hot wall: mirrored, or drawn from all that come
        [0.0, 1.0, 0.0, one - 1.0],
        [other - 1.0, 0.0, 1.0, 0.0],
        np.sqrt(np.pi / 2.0 / np.array([hot, cold, hot, cold])),  # of their densities
    ])  # fmt: skip
    streams = np.linalg.solve(balance, [0.0, 0.0, 0.0, density])
    net = streams[:2] - streams[2:]
    fractions = {"accommodation": (one, other)}
    assert net.sum() == pytest.approx(0.0, abs=1e-15)
    assert heat.free_molecular_flux(density, hot, cold, 3, **fractions) == pytest.approx(
        2.0 * net @ [hot, cold]
    )
    part = one * other / (one + other - one * other)
    assert net[0] == pytest.approx(part * streams[:2].sum())
    assert one != other or part == pytest.approx(one / (2.0 - one))
    free = free_molecular_stress(density, 0.1)
    assert free_molecular_stress(density, 0.1, **fractions) == pytest.approx(part * free)


def test_a_wide_dilute_gap_obeys_the_power_law():
    """T^(3/2) linear, and the flux of the dilute limit, whatever the density."""
    number, length = 1e-4, 1e7
    slab = heat.conducting_slab(length, number, 2.0, 1.0)
    assert slab.flux == pytest.approx(heat.dilute_fourier_flux(length, 2.0, 1.0), rel=2e-3)
    straight = 2.0**1.5 + (1.0 - 2.0**1.5) * slab.position / length
    assert slab.temperature**1.5 == pytest.approx(straight, rel=1e-3)
    assert slab.density * slab.temperature == pytest.approx(slab.density[0] * slab.temperature[0], rel=1e-3)


def test_the_slab_has_its_particles_and_its_jumps():
    slab = heat.conducting_slab(200.0, 0.04, 2.0, 1.0)
    mean = np.trapezoid(slab.density, slab.position) / 200.0
    assert mean == pytest.approx(0.04, rel=1e-6)
    eta = packing_fraction(slab.density[0], 3)
    slope = slab.flux / (enskog_conductivity(eta, 3) * np.sqrt(slab.temperature[0]))
    jump = 2.0 - slab.temperature[0]
    assert jump == pytest.approx(heat.TEMPERATURE_JUMP * mean_free_path(eta, 3) * slope, rel=1e-6)
    assert 0.0 < slab.temperature[-1] - 1.0 < jump  # the cold gas is denser


def test_a_thin_gas_is_no_fluid():
    with pytest.raises(ValueError, match="Knudsen"):
        heat.conducting_slab(200.0, 0.005, 2.0, 1.0)


def test_the_approach_to_conduction_is_the_solution_of_the_heat_equation():
    """Explicit differences from a uniform start between walls that then have other temperatures."""
    cells, diffusivity, length = 200, 3.0, 50.0
    width = length / cells
    step = 0.2 * width**2 / diffusivity
    temperature = np.full(cells + 2, 1.2)
    temperature[[0, -1]] = 2.0, 1.0
    found, times = [], []
    for n in range(24_001):
        if n % 6000 == 0:
            inside = temperature[1:-1]
            found.append(inside[: cells // 2].mean() - inside[cells // 2 :].mean())
            times.append(n * step)
        wall = 2.0 * temperature[[0, -1]] - temperature[[1, -2]]  # the wall is half a cell away
        around = np.concatenate([wall[:1], temperature[1:-1], wall[1:]])
        temperature[1:-1] += 0.2 * np.diff(around, 2)
    expected = 0.5 * heat.steady_part(np.array(times), length, diffusivity)
    assert found == pytest.approx(expected, abs=2e-3)
    assert 0.2 < expected[1] < 0.4 < expected[-1] < 0.5


# The Boltzmann equation of electrons among scatterers with modes, against what is exact.


def test_between_walls_of_one_temperature_electrons_and_modes_have_it():
    """Also if they begin at another one."""
    metal = MetalSlab(1.0, 3.0, 4000, seed=1)
    metal.velocity *= 1.5
    metal.profile(40.0, 1)
    energy, number = metal.profile(20.0, 3)
    assert energy / number == pytest.approx(np.ones(3), abs=0.03)
    assert number / number.mean() == pytest.approx(np.ones(3), abs=0.04)
    assert metal.modes.mean() == pytest.approx(1.0, abs=4.0 / metal.modes.size**0.5)


def test_without_collisions_the_profile_is_that_of_free_flight():
    """Both halves of the distribution come from the walls: T is sqrt(T_1 T_2) everywhere."""
    metal = MetalSlab(4.0, 1e-3, 5000, seed=3)
    metal.profile(1.0, 1)
    energy, number = metal.profile(4.0, 2)
    assert energy / number == pytest.approx(2.0 * np.ones(2), rel=0.05)


@pytest.mark.thorough
def test_the_bend_of_the_profile_is_that_of_the_program():
    """And not that of a gas, -0.12."""
    metal = MetalSlab(2.0, heat.METAL_GAP, 16_000, seed=4)
    metal.profile(150.0, 10)
    energy, number = metal.profile(300.0, 10)
    temperature, position = energy / number, (np.arange(10) + 0.5) / 10
    bend = np.polyfit(position[1:-1], temperature[1:-1], 2)[0]
    # 10 metals of 20 000 electrons, for 1000 times on average, instead of 16 000 for 300
    scatter = heat.METAL_BEND_ERROR * (2e8 / 4.8e6 + 1.0) ** 0.5
    assert bend == pytest.approx(heat.METAL_BEND, abs=3.5 * scatter)
