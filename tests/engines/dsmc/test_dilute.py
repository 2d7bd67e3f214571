"""A dilute gas by DSMC against kinetic theory."""

import math
from dataclasses import replace

import numpy as np
import pytest
from engines.dsmc.steps import advanced, make
from scenes import gas

import gaspart as gp
from gaspart import theory

pytestmark = pytest.mark.thorough


def exact_rate(state, volume):
    """Collisions per time of a mixture of Maxwellian gases at one temperature, of all pairs (exact): half the
    sum over ordered pairs of S <g> / V."""
    d = state.dimension
    energy = state.translational_energy - 0.5 * float((state.momentum**2).sum()) / state.masses.sum()
    temperature = 2.0 * energy / (d * (state.count - 1))
    total = 0.0
    for one in np.unique(state.species):
        for other in np.unique(state.species):
            a, b = state.species == one, state.species == other
            pairs = a.sum() * (b.sum() - (one == other))
            sigma = state.radii[a][0] + state.radii[b][0]
            heat = temperature * (1.0 / state.masses[a][0] + 1.0 / state.masses[b][0])
            section = math.pi * sigma**2 if d == 3 else 2.0 * sigma
            speed = math.sqrt(8.0 * heat / math.pi) if d == 3 else math.sqrt(math.pi * heat / 2.0)
            total += 0.5 * pairs * section * speed / volume
    return total


def pair_of_species(dimension):
    """Two species of different sizes and masses in a periodic container."""
    side = 60.0 if dimension == 3 else 400.0
    species = [gp.Species(3000, 0.5, temperature=1.0), gp.Species(2000, 1.0, mass=4.0, temperature=1.0)]
    return gp.Scene(gp.Container((side,) * dimension, "periodic"), species)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("species", [1, 2])
def test_the_collision_rate_is_boltzmanns(dimension, species):
    scene = gas(dimension, 5000, 0.01) if species == 1 else pair_of_species(dimension)
    sim = advanced(scene, 600, settle=5)
    expected = exact_rate(sim.state, scene.container.volume) * sim.tally.time
    assert sim.tally.collisions > 2e5
    assert sim.tally.collisions == pytest.approx(expected, abs=3.0 * math.sqrt(expected))
    assert sim.tally.virial_sum == 0.0


@pytest.mark.thorough
@pytest.mark.parametrize("dimension", [2, 3])
def test_the_rate_with_default_settings_is_right_to_half_a_thousandth(dimension):
    """4e7 collisions: a standard error of 1.6e-4."""
    eta, n, ratios = 1e-3, 50_000, []
    side = (n * theory.particle_volume(dimension) / eta) ** (1.0 / dimension)
    gas = gp.Species(n, 0.5, temperature=1.0, exact_temperature=True)
    scene = gp.Scene(gp.Container((side,) * dimension, "periodic"), [gas])
    rate = float(theory.collision_rate(eta, dimension) / theory.contact_value(eta, dimension))
    for seed in range(4):
        sim = gp.Simulation(scene, gp.DSMC(), seed=seed)
        sim.advance(duration=5.0 / rate)  # speeds become Maxwell's
        collisions, time = sim.tally.collisions, sim.time
        sim.advance(duration=400.0 / rate)
        ratios.append(2.0 * (sim.tally.collisions - collisions) / (n * (sim.time - time) * rate))
    assert np.mean(ratios) == pytest.approx(1.0, abs=5e-4)


@pytest.mark.parametrize(("dimension", "rate"), [(2, 64.0 / 225.0), (3, 8.0 / 35.0)])
def test_speeds_that_are_alike_spread_at_the_rate_of_the_boltzmann_equation(dimension, rate):
    """d kurtosis / d (collisions of a particle) at the start, from the collision integral of particles of
    one speed in all directions (exact)."""
    n = 40000
    scene = gas(dimension, n, 0.002, temperature=None, speed=1.0)
    spread, seeds = [], range(4)
    for seed in seeds:
        sim = gp.Simulation(scene, gp.DSMC(time_step=2.0), seed)
        sim.advance(duration=8.0)
        met = 2.0 * sim.tally.collisions / n
        square = sim.state.speeds**2
        kurtosis = (square**2).mean() / square.mean() ** 2
        spread.append((kurtosis - 1.0) / met)
        assert met < 0.2
    error = np.std(spread) / math.sqrt(len(spread) - 1)
    curved = 0.5 * met * rate  # what lies between the first derivative and a mean to here, at most
    assert np.mean(spread) == pytest.approx(rate - 0.5 * curved, abs=3.0 * error + 0.5 * curved)


def test_self_diffusion_is_that_of_kinetic_theory():
    scene = gas(3, 8000, 0.001)
    sim = advanced(scene, 1, settle=20, time_step=2.0, cells_per_side=12)
    start, begun = sim.state, sim.time
    make(sim, 400)
    middle = sim.state.unwrapped - start.unwrapped
    one = (middle**2).sum(axis=1).mean()
    reached = sim.time - begun
    make(sim, 400)
    other = ((sim.state.unwrapped - start.unwrapped) ** 2).sum(axis=1).mean()
    found = (other - one) / (6.0 * (sim.time - begun - reached))
    temperature = 2.0 * sim.state.kinetic_energy / (3 * 8000)
    expected = float(theory.enskog_diffusion(0.001, 3, temperature=temperature))
    expected *= float(theory.contact_value(0.001, 3))
    assert found == pytest.approx(expected, rel=0.05)


def test_repeated_collisions_slow_relaxation_as_predicted():
    """Temperatures of the axes equalise 12 % more slowly with 0.3 particles in a cell than with 40."""
    count, side = 20000, 126.0
    scene = gp.Scene(gp.Container((side,) * 3, "periodic"), [gp.Species(count, 0.5, temperature=1.0)])
    found, predicted = [], []
    for cells in (40, 8):
        engine, rates = gp.DSMC(time_step=0.5, cells_per_side=cells), []
        for seed in range(5):
            start = gp.Simulation(scene, engine, seed).state
            spread = start.velocities - start.velocities.mean(axis=0)
            wanted = np.sqrt([1.8, 0.6, 0.6] / (spread**2).mean(axis=0))
            sim = gp.Simulation(scene, engine, seed, initial=replace(start, velocities=spread * wanted))
            make(sim, 40)
            squares = (sim.state.velocities**2).mean(axis=0)
            rates.append(math.log(1.2 / (squares[0] - squares[1:].mean())))
        found.append((np.mean(rates), np.std(rates, ddof=1) / math.sqrt(5.0)))
        predicted.append(engine.errors(scene).repeats)
    (slow, by_chance), (fast, other) = found
    ratio, error = slow / fast, slow / fast * math.hypot(by_chance / slow, other / fast)
    assert ratio == pytest.approx((1.0 + predicted[1]) / (1.0 + predicted[0]), abs=3.7 * error)
    assert predicted[0] > 0.1 and error < 0.025
