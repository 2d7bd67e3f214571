"""Inelastic and rough particles under DSMC, and the thermostat."""

import math
from dataclasses import replace

import numpy as np
import pytest
from engines.dsmc.steps import advanced, make
from scenes import gas

import gaspart as gp
from gaspart import theory

pytestmark = pytest.mark.thorough


def test_an_inelastic_gas_cools_at_the_rate_of_kinetic_theory():
    """- d ln T / ds, s = 2 N_coll / N, once the velocities have come to their lasting form."""
    n = 20000
    scene = replace(gas(3, n, 0.001), restitution=gp.Restitution(0.8))
    sim = advanced(scene, 1, settle=60)
    start, before = sim.state.translational_energy, sim.tally.collisions
    make(sim, 60)
    met = 2.0 * (sim.tally.collisions - before) / n
    found = -math.log(sim.state.translational_energy / start) / met
    assert found == pytest.approx(float(theory.cooling_rate(0.8, 3)), rel=0.01)
    sim.check_invariants()


def test_rough_particles_share_energy_with_their_spins():
    """Perfectly rough spheres lose nothing: three degrees of freedom each."""
    scene = replace(gas(3, 3000, 0.001), restitution=gp.Restitution(1.0, 1.0))
    sim = advanced(scene, 500)
    state = sim.state
    assert state.rotational_energy / state.translational_energy == pytest.approx(1.0, rel=4.0 * 0.021)
    assert state.kinetic_energy == pytest.approx(sim.initial_state.kinetic_energy, rel=1e-12)


def test_viscoelastic_particles_lose_less_when_slow():
    scene = replace(gas(3, 3000, 0.001), restitution=gp.Restitution(0.8, reference_speed=1.0))
    fast = advanced(scene, 30, time_step=2.0)
    kinds = [replace(scene.species[0], temperature=1e-6)]
    slow = advanced(replace(scene, species=kinds), 30, time_step=2000.0)
    lost = [1.0 - sim.state.kinetic_energy / sim.initial_state.kinetic_energy for sim in (fast, slow)]
    assert 0.0 < lost[1] < 0.5 * lost[0]


def test_kicks_keep_a_granular_gas_at_the_temperature_of_theory():
    n, power = 4000, 0.02
    scene = replace(gas(3, n, 0.001), restitution=gp.Restitution(0.8), thermostat=gp.Thermostat(power, 1.5))
    sim = advanced(scene, 1, settle=400, time_step=4.0)
    temperatures = []
    for _ in range(30):
        make(sim, 10)
        temperatures.append(2.0 * sim.state.translational_energy / (3 * n))
    expected = float(theory.driven_temperature(0.8, 3, power, 0.001))
    expected *= float(theory.contact_value(0.001, 3)) ** (2.0 / 3.0)
    assert np.mean(temperatures) == pytest.approx(expected, rel=0.03)
    assert sim.tally.thermostat_energy > 0.0
    assert np.allclose(sim.state.momentum, sim.initial_state.momentum, atol=1e-9)
    sim.check_invariants()
