"""The Boltzmann equation of electrons among scatterers with modes, against what is exact."""

import numpy as np
import pytest

from gaspart.theory import heat
from gaspart.theory.electrons import MetalSlab


def test_between_walls_of_one_temperature_electrons_and_modes_have_it():
    """Also if they begin at another one."""
    metal = MetalSlab(1.0, 3.0, 4000, seed=1)
    metal.velocity *= 1.5
    metal.profile(40.0, 1)
    energy, number = metal.profile(20.0, 3)
    assert energy / number == pytest.approx(np.ones(3), abs=0.03)
    assert number / number.mean() == pytest.approx(np.ones(3), abs=0.04)
    assert metal.modes.mean() == pytest.approx(1.0, abs=4.0 / metal.modes.size**0.5)


def test_a_swap_conserves_energy_and_uses_no_mode_twice():
    metal = MetalSlab(1.0, 1.0, 5000, seed=2)
    before = metal.modes.copy()
    energies = 0.5 * (metal.velocity**2).sum(axis=1)
    which = np.arange(1500)
    metal._swap(which)
    gained = (0.5 * (metal.velocity**2).sum(axis=1) - energies).sum()
    assert gained == pytest.approx(before.sum() - metal.modes.sum(), rel=1e-9)
    assert (metal.modes != before).sum() == which.size


def test_without_collisions_the_profile_is_that_of_free_flight():
    """Both halves of the distribution come from the walls: T is sqrt(T_1 T_2) everywhere."""
    metal = MetalSlab(4.0, 1e-3, 5000, seed=3)
    metal.profile(1.0, 1)
    energy, number = metal.profile(4.0, 2)
    assert energy / number == pytest.approx(2.0 * np.ones(2), rel=0.05)


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


def test_slow_electrons_are_where_it_is_cold_by_a_power_of_the_temperature():
    """n T^b is uniform without a current of particles, b = <x v (E/T - 1)> / <x v> of displacements x in
    equilibrium after the velocity v: 0.65, between 1/2 of scatterers that only deflect, and 1 of a gas."""
    metal = MetalSlab(1.0, 300.0, 20_000, seed=5)
    sums = np.zeros(2)
    for _ in range(6):
        start, velocity = metal.positions.copy(), metal.velocity.copy()
        metal.profile(9.0, 1)
        far = (start > 50.0) & (start < 250.0)
        product = ((metal.positions - start) * velocity[:, 0])[far]
        sums += product.sum(), product @ (0.5 * (velocity[far] ** 2).sum(axis=1) - 1.0)
    assert sums[1] / sums[0] == pytest.approx(0.65, abs=0.06)
