"""Random kicks: the stochastic thermostat of a driven gas."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import gas

import gaspart as gp


def driven(count=20, interval=0.37, boundary="periodic"):
    return replace(gas(2, count, 0.1, boundary), thermostat=gp.Thermostat(0.3, interval))


@pytest.mark.thorough
@pytest.mark.parametrize("dimension", [2, 3])
def test_kicks_give_the_power_and_keep_the_momentum(dimension):
    """The mean energy of a kick is (1 - 1/N) power interval for each particle, whatever its mass: its
    fluctuation is that of v.dv and of dv^2. A fixed particle is not kicked."""
    power, interval, kicks = 0.3, 0.01, 400
    kinds = [gp.Species(300, 0.05, temperature=1.0), gp.Species(300, 0.05, mass=9.0, temperature=1.0)]
    container = gp.Container((20.0,) * dimension, "periodic")
    scene = gp.Scene(container, kinds, thermostat=gp.Thermostat(power, interval))
    sim = gp.Simulation(scene, gp.EventDriven(), seed=2)
    before = sim.initial_state
    sim.advance(until=(kicks + 0.5) * interval)
    sim.check_invariants()
    scale = float((before.masses[:, None] * abs(before.velocities)).sum())
    assert sim.state.momentum == pytest.approx(before.momentum, abs=1e-12 * scale)
    given = sim.tally.thermostat_energy
    expected = 600 * (1.0 - 1.0 / 600) * power * interval * kicks
    step = power * interval  # variance of m v.dv: m^2 <v^2>/d <dv^2> = (d T) 2 step / d, T rising from 1
    warmest = 1.0 + 2.0 * power * interval * kicks / dimension
    error = math.sqrt(600 * kicks * (2.0 * step * warmest + 2.0 * step**2 / dimension))
    assert given == pytest.approx(expected, abs=4.0 * error)
    assert error < 0.1 * expected
    assert sim.state.energy == pytest.approx(before.energy + given, rel=1e-12)


@pytest.mark.interpreted
def test_a_fixed_particle_is_not_kicked():
    particles = [gp.Particle(place, (0.0, 0.0), 0.5) for place in ((2.0, 2.0), (5.0, 5.0), (8.0, 2.0))]
    particles[0] = replace(particles[0], fixed=True)
    scene = gp.Scene(gp.Container((10.0, 10.0)), particles=particles, thermostat=gp.Thermostat(1.0, 0.1))
    sim = gp.Simulation(scene, gp.EventDriven(), seed=1)
    sim.advance(duration=0.15)
    velocities = sim.state.velocities
    assert np.array_equal(velocities[0], [0.0, 0.0])
    assert (velocities[1] != 0.0).all()
    assert velocities[1] == pytest.approx(-velocities[2], rel=1e-12)


@pytest.mark.interpreted
def test_what_has_no_meaning_is_refused():
    with pytest.raises(gp.SceneError, match="gravity.*random kicks"):
        replace(driven(boundary="wall"), gravity=(0.0, -1.0))
    with pytest.raises(gp.SceneError, match="hard or thermal"):
        replace(driven(boundary="wall"), faces={"x_low": gp.Sticky(0.1)})


@pytest.mark.thorough
@given(st.integers(1, 4000), st.integers(0, 2**32))
def test_kick_n_comes_at_n_intervals(thousandths, seed):
    """Not at the sum of n intervals, whose rounding lets a state at n intervals be before the kick."""
    interval = thousandths / 1000.0
    scene = driven(3, interval)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=seed)
    for number in range(1, 120):
        before = sim.tally.thermostat_energy
        sim.advance(until=math.nextafter(number * interval, 0.0))
        assert sim.tally.thermostat_energy == before
        sim.advance(until=number * interval)
        assert sim.tally.thermostat_energy != before
