"""How right the time-stepped engine is: against theory at small steps, and by orders of the step."""

import numpy as np
import pytest
from scenes import gas

import gaspart as gp
from gaspart import theory
from gaspart.scene.sizes import ball_volume


def rate_of(scene, engine, start):
    """Collision rate of a particle after a start, and its error from eight blocks."""
    sim, found = gp.Simulation(scene, engine, seed=3), []
    whole = getattr(engine, "time_step", start)
    sim.advance(duration=whole * round(start / whole))
    for _ in range(8):
        sim.reset_tally()
        sim.advance(duration=whole * round(2.0 * start / whole))
        found.append(2 * sim.tally.collisions / scene.count / sim.tally.time)
    return np.mean(found), np.std(found, ddof=1) / np.sqrt(8)


@pytest.mark.filterwarnings("ignore:gaspart. time_step")  # twice as many contacts in a fluid of 0.6
@pytest.mark.parametrize("met", [0.8, 2.4])
@pytest.mark.parametrize(
    ("shape", "count", "eta"),
    [((1, 1, 1), 32, 0.6), ((1, 1, 1), 32, 0.724), ((1, 3**0.5), 72, 0.78), ((1, 3**0.5), 72, 0.88)],
)
def test_the_rate_in_a_crystal_errs_by_less_than_its_bound(shape, count, eta, met):
    """Particles in narrow cages collide up to 4 % too often at 2.5 contacts a step."""
    volume = count * ball_volume(len(shape), 0.5) / eta
    lengths = (volume / np.prod(shape)) ** (1 / len(shape)) * np.array(shape)
    crystal = gp.Species(count, 0.5, arrangement="lattice", temperature=1.0, exact_temperature=True)
    scene = gp.Scene(gp.Container(tuple(lengths), boundary="periodic"), [crystal])
    rough, _ = rate_of(scene, gp.EventDriven(), 100.0 / 40.0)
    exact, unsure = rate_of(scene, gp.EventDriven(), 1000.0 / rough)
    engine = gp.TimeStepped(met / exact)
    stepped, error = rate_of(scene, engine, 1000.0 / rough)
    deviation, bound = stepped / exact - 1.0, engine.bias(scene, "rates")
    error = np.hypot(unsure, error) / exact
    assert error < 2e-3
    assert met**2 / 400.0 - 3.0 * error < deviation < bound + 3.0 * error
    assert bound < 0.05 * met**2


def measured(eta, time_step, particle_steps, **settings):
    """Relative errors of Z and of the collision rate of spheres, each with its standard error."""
    count, blocks = 4000, 16
    scene = gas(3, count, eta, arrangement="lattice")
    sim = gp.Simulation(scene, gp.TimeStepped(time_step, **settings), seed=5)
    sim.advance(duration=max(10.0, 0.3 / eta))
    velocities = sim.state.velocities
    twice_energy = ((velocities - velocities.mean(axis=0)) ** 2).sum()
    rate_expected = theory.collision_rate(eta, 3) * np.sqrt(twice_energy / (3 * (count - 1)))
    found = []
    for _ in range(blocks):
        sim.reset_tally()
        sim.advance(duration=particle_steps / count / blocks * time_step)
        tally = sim.tally
        z = 1 + tally.virial_sum / (twice_energy * tally.time)
        rate = 2 * tally.collisions / count / tally.time
        found.append((z / theory.compressibility_factor(eta, 3), rate / rate_expected))
    return np.mean(found, axis=0) - 1, np.std(found, axis=0, ddof=1) / np.sqrt(blocks)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("eta", "time_step", "particle_steps"), [(0.01, 0.03, 2e8), (0.1, 0.01, 8e7), (0.3, 0.008, 6e7)]
)
def test_small_steps_agree_with_theory(eta, time_step, particle_steps):
    error, sigma = measured(eta, time_step, particle_steps)
    assert (sigma < 2e-3).all()
    assert (abs(error) < 3 * sigma).all()


@pytest.mark.thorough
def test_orders_of_convergence():
    """With contacts rewound the rate is off by dt^2 (grazing ones are missed), Z by dt^3; without, by dt."""
    steps = np.array([0.12, 0.06])

    def orders(rewind):
        errors = [measured(0.1, step, 3e7, passes=1, rewind=rewind)[0] for step in steps]
        return np.diff(np.log(np.abs(errors)), axis=0)[0] / np.diff(np.log(steps))

    pressure, rate = orders(rewind=True)
    assert 2.5 < pressure < 4.0
    assert 1.8 < rate < 2.8
    pressure, _ = orders(rewind=False)
    assert 0.7 < pressure < 1.3
