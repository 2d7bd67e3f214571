"""The Enskog model: its pressure and its collisions follow from the contact value that it is given."""

import math

import numpy as np
import pytest
from engines.dsmc.steps import advanced, make
from scenes import gas

import gaspart as gp
from gaspart.scene.sizes import ball_volume
from gaspart.theory.discretisation import contact_values

pytestmark = pytest.mark.thorough


@pytest.mark.parametrize("packing_fraction", [0.1, 0.4])
@pytest.mark.filterwarnings("ignore:gaspart")
def test_pressure_and_collisions_of_a_uniform_gas(packing_fraction):
    """Z - 1 = 4 eta chi and the rate 4 rho sigma^2 chi sqrt(pi T), in a gas that is one cell, with (N - 1)/N
    of the pairs and T about the centre of mass."""
    n, eta = 500, packing_fraction
    scene = gas(3, n, eta, arrangement="lattice")
    sim = advanced(scene, 4000, settle=20, cells_per_side=1, model="enskog")
    chi = (1.0 - 0.5 * eta) / (1.0 - eta) ** 3
    state, tally = sim.state, sim.tally
    energy = state.kinetic_energy - 0.5 * (state.momentum**2).sum() / n
    temperature = 2.0 * energy / (3.0 * (n - 1))
    density = n / scene.container.volume
    rate = 4.0 * density * chi * math.sqrt(math.pi * temperature) * (n - 1) / n
    expected = 0.5 * n * rate * tally.time
    assert tally.collisions > 2e5
    assert tally.collisions == pytest.approx(expected, abs=3.0 * math.sqrt(expected) + 2e-4 * expected)
    excess = tally.virial_sum / (3.0 * n * temperature * tally.time) * n / (n - 1)
    assert excess == pytest.approx(4.0 * eta * chi, rel=3.0 / math.sqrt(tally.collisions) + 1e-3)
    assert state.kinetic_energy == pytest.approx(sim.initial_state.kinetic_energy, rel=1e-12)
    assert sim._dynamics._workspace.counts[0, 2] == 0


def test_contact_values_are_those_of_one_species_where_particles_are_alike():
    eta = 0.3
    density = np.array([0.2, 0.1]) * eta / (ball_volume(3, 0.5) * 0.3)
    assert contact_values(density, np.array([0.5, 0.5]), 3) == pytest.approx((1 - eta / 2) / (1 - eta) ** 3)
    density = np.array([0.2, 0.1]) * eta / (ball_volume(2, 0.5) * 0.3)
    expected = (1 - 7 / 16 * eta) / (1 - eta) ** 2
    assert contact_values(density, np.array([0.5, 0.5]), 2) == pytest.approx(expected)


@pytest.mark.filterwarnings("ignore:gaspart")
def test_a_mixture_meets_by_its_contact_values():
    species = [gp.Species(250, 0.5, temperature=1.0), gp.Species(100, 0.8, mass=3.0, temperature=1.0)]
    scene = gp.Scene(gp.Container((14.0, 14.0, 14.0), "periodic"), species)
    sim = advanced(scene, 3000, settle=20, cells_per_side=1, model="enskog")
    state, tally, volume = sim.state, sim.tally, scene.container.volume
    energy = state.kinetic_energy - 0.5 * (state.momentum**2).sum() / state.masses.sum()
    temperature = 2.0 * energy / (3.0 * (state.count - 1))
    number, radius, mass = np.array([250.0, 100.0]), np.array([0.5, 0.8]), np.array([1.0, 3.0])
    chi = contact_values(number / volume, radius, 3)
    sigma = radius[:, None] + radius
    heat = temperature * (1.0 / mass[:, None] + 1.0 / mass)
    pairs = number[:, None] * (number - np.eye(2))
    rates = 0.5 * pairs * np.pi * sigma**2 * np.sqrt(8.0 * heat / np.pi) * chi / volume
    expected = rates.sum() * tally.time
    assert tally.collisions == pytest.approx(expected, abs=3.0 * math.sqrt(expected) + 1e-3 * expected)
    virial = (rates * sigma * np.sqrt(np.pi * temperature / 2.0 / (1.0 / mass[:, None] + 1.0 / mass))).sum()
    assert tally.virial_sum == pytest.approx(2.0 * virial * tally.time, rel=0.01)


@pytest.mark.filterwarnings("ignore:gaspart")
def test_more_particles_in_a_cell_bring_the_rate_closer():
    """What correlations of the few particles in a cell take of the collisions falls with their number."""
    lost = []
    for cells in (5, 2):
        scene = gas(3, 1000, 0.4, arrangement="lattice")
        sim = advanced(scene, 600, settle=20, cells_per_side=cells, model="enskog")
        chi = 0.8 / 0.6**3
        expected = 4.0 * 1000 / scene.container.volume * chi * math.sqrt(math.pi * 2.0 / 3000)
        expected *= math.sqrt(sim.state.kinetic_energy)
        lost.append(1.0 - 2.0 * sim.tally.collisions / (1000 * sim.tally.time) / expected)
    assert lost[0] > 0.03
    assert abs(lost[1]) < 0.02


@pytest.mark.filterwarnings("ignore:gaspart")
@pytest.mark.parametrize("threads", [1, 2])
def test_no_heat_flows_in_a_uniform_gas(threads):
    """The heat flux is 0 by symmetry. With the same order of cells in all steps it is 0.19(1) along z."""
    scene = gas(3, 400, 0.3, arrangement="lattice", exact_temperature=True)
    settings = {"model": "enskog", "cells_per_side": (2, 2, 24), "time_step": 0.1, "threads": threads}
    sim = gp.Simulation(scene, gp.DSMC(**settings), seed=1, stress=True)
    make(sim, 50)
    flux = []
    for _ in range(40):
        sim.reset_tally()
        make(sim, 50)
        flux.append(np.asarray(sim.tally.heat_sum) / (sim.tally.time * 400))
    error = np.std(flux, axis=0, ddof=1) / math.sqrt(40)
    assert (error < 0.02).all()
    assert (np.abs(np.mean(flux, axis=0)) < 4.0 * error).all()


def test_a_gas_denser_than_the_contact_values_is_refused():
    discs = gp.Species(18, 0.5, temperature=1.0, arrangement="lattice")
    crystal = gp.Scene(gp.Container((3.0482, 5.2796), "periodic"), [discs])
    with pytest.raises(gp.SceneError, match=r"packing_fraction = 0.8785: .*up to 0.7"):
        gp.Simulation(crystal, gp.DSMC(model="enskog"))
