"""The promise of the advice, on scenes that the table knows nothing of: the wanted accuracy in 95 % of them,
at no more than 1.5 times the cost of the best setting that a search finds.
"""

import math
import time

import numpy as np
import pytest
import uneven
from advised import COSTS_MORE, LEAST_REACHED, results

from gaspart import theory
from gaspart.accuracy import pilot, table
from gaspart.accuracy.plan import plan_from_table
from gaspart.accuracy.table import EQUILIBRATION
from gaspart.engines import EventDriven, TimeStepped
from gaspart.errors import SceneError
from gaspart.scene.container import Container
from gaspart.scene.scene import Scene
from gaspart.scene.species import Species
from gaspart.simulation import Simulation

pytestmark = pytest.mark.thorough

SCENES = 60
ALLOWED = 7
"""Misses among 60 that a promise of 95 % allows: more have a chance of 1 %."""
MOST_EXPENSIVE = 1.5


def scene(number):
    """A random gas, with an observable and an accuracy."""
    rng = np.random.default_rng([2010, number])
    dimension = int(rng.integers(2, 4))
    fraction = float(np.exp(rng.uniform(math.log(0.012), math.log(0.42 if dimension == 3 else 0.5))))
    count = int(rng.integers(400, 3000))
    radius, temperature = float(np.exp(rng.uniform(-1, 1))), float(np.exp(rng.uniform(-2, 2)))
    volume = count * theory.particle_volume(dimension, 2.0 * radius) / fraction
    gas = Scene(
        Container((volume ** (1.0 / dimension),) * dimension, boundary="periodic"),
        species=(Species(count, radius, temperature=temperature, arrangement="lattice"),),
    )
    observable = ("Z", "collision_rate")[int(rng.integers(2))]
    return gas, observable, float(np.exp(rng.uniform(math.log(3e-3), math.log(3e-2))))


def truth(gas, observable):
    """Of so many particles, to first order in 1/N: Z, or collisions of a particle in units of the scene."""
    eta, d, n = gas.packing_fraction, gas.dimension, gas.count
    if observable == "Z":
        z = theory.compressibility_factor(eta, d)
        return float(z + theory.finite_size_correction(eta, d, n, ensemble="canonical"))
    return float(theory.collision_rate(eta, d) * theory.collision_rate_finite_size_factor(eta, d, n))


def run(gas, engine, observable, duration, settling, seed):
    """What a run gives, in reduced units, and its processor time after settling per time simulated."""
    simulation = Simulation(gas, engine, seed=seed)
    simulation.advance(duration=settling)
    simulation.reset_tally()
    start = time.process_time()
    simulation.advance(duration=duration)
    taken = (time.process_time() - start) / simulation.tally.time
    tally, state = simulation.tally, simulation.state
    d, n = gas.dimension, gas.count
    about_centre = state.kinetic_energy - 0.5 * (state.momentum**2).sum() / n
    temperature = 2.0 * about_centre / (d * (n - 1))
    if observable == "Z":
        return 1.0 + tally.virial_sum / (d * n * temperature * tally.time), taken
    unit = 2.0 * gas.largest_radius / math.sqrt(2.0 * about_centre / (d * n))
    return 2.0 * tally.collisions / (n * tally.time) * unit, taken


def searched(gas, observable, accuracy, unit, rate):
    """The least cost of all settings, from a short run of each: noise as known, errors as measured."""
    fraction, d = gas.packing_fraction, gas.dimension
    noise, best = table.noise(d, fraction, observable), math.inf
    engines = [(EventDriven(), 0.0)] + [
        (TimeStepped(step * unit, precision=precision), table.bias(d, fraction, precision, step, observable))
        for precision, step in table.steps(d)
        if step >= 0.04
    ]
    for engine, bias in engines:
        room = accuracy - bias
        if room <= 0.0:
            continue
        try:
            _, taken = run(gas, engine, observable, 5.0 / rate, 2.0 / rate, seed=3)
        except SceneError:  # the step is too long
            continue
        contacts = max(noise / room**2, 10.0 * gas.count) + 0.5 * gas.count * EQUILIBRATION
        best = min(best, taken * contacts / (0.5 * gas.count * rate))
    return best


@pytest.mark.filterwarnings("ignore:gaspart. time_step")
def test_the_advised_accuracy_is_reached():
    missed, expensive = [], []
    for number in range(SCENES):
        gas, observable, accuracy = scene(number)
        found = plan_from_table(gas, observable, accuracy)
        rate = float(theory.collision_rate(**found.gas.parameters))
        duration = found.collisions_per_particle / rate
        values = [
            run(gas, found.best.engine, observable, duration, 2.0 * EQUILIBRATION / rate, (number, k))
            for k in range(found.replicas)
        ]
        error = np.mean([value for value, _ in values]) / truth(gas, observable) - 1.0
        cost = np.mean([taken for _, taken in values]) * (
            found.replicas * found.collisions_per_particle + EQUILIBRATION
        )
        least = searched(gas, observable, accuracy, found.gas.diameter / found.gas.thermal_speed, rate)
        missed += [number] if abs(error) > 1.96 * accuracy else []
        expensive += [(number, cost / rate / least)]
        print(number, found.best.engine, observable, accuracy, error / accuracy, cost / rate / least)
    assert len(missed) <= ALLOWED, missed
    assert sum(ratio > MOST_EXPENSIVE for _, ratio in expensive) <= ALLOWED, expensive


# The promise of advice, on random scenes: the advised run reaches the required accuracy, judged by a run
# ten times as long, at no more than 1.5 times the cost of the best candidate.


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setattr(pilot, "cache_directory", lambda: tmp_path / "cache")


def test_scenes_that_are_not_even(tmp_path):
    """A column, a slit, one that falls, a few particles; of more than one miss the chance is 1 %."""
    found = results(tmp_path / "results", (200, 203, 209, 212), uneven.scene)
    assert sum(one["reached"] for one in found) >= 3


def test_a_hundred_scenes_that_are_not_even(tmp_path):
    made = [one for one in results(tmp_path / "results", range(100), uneven.scene) if "reached" in one]
    assert len(made) >= 95
    assert np.mean([one["reached"] for one in made]) >= LEAST_REACHED


def test_a_hundred_random_scenes(tmp_path):
    made = [one for one in results(tmp_path / "results", range(100)) if "reached" in one]
    assert len(made) == 100
    assert np.mean([one["reached"] for one in made]) >= LEAST_REACHED
    assert np.mean([one["cost"] <= COSTS_MORE for one in made]) >= LEAST_REACHED
