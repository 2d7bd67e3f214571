"""Contacts that last (the TC model of Luding & McNamara, Granular Matter 1, 113 (1998))."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scenes import closest, gas

import gaspart as gp


def pile(count=20, side=8.0, normal=0.9, tangential=-1.0, duration=None, **rest):
    """Discs that fall into a box."""
    law = gp.Restitution(normal, tangential, duration)
    species = [gp.Species(count, 0.5, temperature=1.0)]
    return gp.Scene(gp.Container((side, side)), species, gravity=(0.0, -1.0), restitution=law, **rest)


def sent(lengths, particles, law, **rest):
    """Single discs in a box."""
    scene = gp.Scene(gp.Container(lengths), particles=particles, restitution=law, **rest)
    return gp.Simulation(scene, gp.EventDriven())


@pytest.mark.interpreted
def test_a_second_contact_within_the_duration_is_elastic():
    """One disc hits two at rest, 0.01 apart: the second contact comes 0.01/0.75 later."""
    particles = [gp.Particle((x, 5.0), (v, 0.0), 0.5) for x, v in ((20.0, 1.0), (22.0, 0.0), (23.01, 0.0))]
    for duration, second in ((0.02, 1.0), (0.01, 0.5), (0.0, 0.5)):
        sim = sent((60.0, 10.0), particles, gp.Restitution(0.5, -1.0, duration))
        sim.advance(max_events=2, duration=10.0)
        speed = 0.5 * (1.0 + 0.5)  # of the middle disc after the first contact
        expected = [0.25, 0.5 * (1.0 - second) * speed, 0.5 * (1.0 + second) * speed]
        assert sim.state.velocities[:, 0] == pytest.approx(expected, abs=1e-14)
        tally = sim.tally
        assert tally.elastic_contacts == (1 if second == 1.0 else 0)
        usual = 0.25 * 0.75 * speed**2  # m/4 (1 - e^2) of the square of the speed
        retained = usual if second == 1.0 else 0.0
        assert tally.retained_energy == pytest.approx(retained, abs=1e-14)
        assert tally.dissipated_energy == pytest.approx(0.25 * 0.75 + usual - retained, rel=1e-13)
        sim.check_invariants()


@pytest.mark.interpreted
def test_contacts_with_walls_count():
    """A disc hits the floor, and within the duration one at rest above it."""
    particles = [gp.Particle((5.0, 0.52), (0.0, -1.0), 0.5), gp.Particle((5.0, 1.54), (0.0, 0.0), 0.5)]
    for duration, restitution in ((0.1, 1.0), (0.01, 0.5)):
        sim = sent((10.0, 10.0), particles, gp.Restitution(0.5, -1.0, duration))
        sim.advance(max_events=2, duration=1.0)
        assert sim.state.velocities[1, 1] == pytest.approx(0.25 * (1.0 + restitution), abs=1e-14)


@pytest.mark.interpreted
def test_an_elastic_contact_has_no_friction():
    """Not even of perfectly rough discs. What friction would have taken is retained."""
    particles = [gp.Particle((x, 5.0), (0.0, 0.0), 0.5) for x in (22.0, 23.01)]
    particles = [gp.Particle((20.0, 5.0), (1.0, 0.0), 0.5, spin=3.0), *particles]
    for tangential in (0.5, 1.0):
        sim = sent((60.0, 10.0), particles, gp.Restitution(0.5, tangential, 1.0))
        sim.advance(max_events=2, duration=10.0)
        assert sim.state.spins[2] == 0.0
        assert sim.tally.elastic_contacts == 1
        sim.check_invariants()


@pytest.mark.thorough
def test_perfectly_rough_discs_do_not_stay_in_a_corner():
    """Between two faces, or a face and a wall, they would hit both in turn and for ever."""
    rest = {"gravity": (-0.3, -1.0), "restitution": gp.Restitution(0.3, 1.0)}
    walls = [gp.Wall((4.0, 0.0), (1.0, 6.0))]
    scene = gp.Scene(gp.Container((6.0, 8.0)), [gp.Species(6, 0.3, temperature=1.0)], walls=walls, **rest)
    for seed in range(4):
        sim = gp.Simulation(scene, gp.EventDriven(), seed=seed)
        sim.advance(until=100.0)
        sim.check_invariants()
        assert sim.state.kinetic_energy < 1e-3


@pytest.mark.interpreted
def test_the_default_follows_from_the_scales():
    """0.01 sqrt(d/g) where contacts dissipate under gravity; none otherwise."""
    assert pile().contact_duration == pytest.approx(0.01)
    assert replace(pile(), gravity=(0.0, -4.0)).contact_duration == pytest.approx(0.005)
    assert replace(pile(), gravity=None).contact_duration == 0.0
    assert pile(normal=1.0).contact_duration == 0.0
    assert pile(normal=1.0, tangential=1.0, duration=0.1).contact_duration == 0.0
    assert pile(normal=1.0, tangential=0.5).contact_duration > 0.0
    assert pile(duration=0.0).contact_duration == 0.0
    assert pile(duration=0.3).contact_duration == 0.3


@pytest.mark.thorough
@pytest.mark.parametrize("dimension", [2, 3])
def test_a_stack_at_rest_stays_at_rest(dimension):
    """Ten particles, each exactly on the one below."""
    middle = (2.0,) * (dimension - 1)
    particles = [gp.Particle((*middle, 0.5 + n), (0.0,) * dimension, 0.5) for n in range(10)]
    sides, gravity = (4.0,) * (dimension - 1), (0.0,) * (dimension - 1)
    sim = sent((*sides, 12.0), particles, gp.Restitution(0.9), gravity=(*gravity, -1.0))
    sim.record_events = True  # with the kernels of the searches' comparison
    sim.advance(duration=100.0)
    sim.check_invariants()
    assert sim.state.positions == pytest.approx(sim.initial_state.positions, abs=1e-5)
    assert np.array_equal(sim.state.velocities, np.zeros((10, dimension)))
    assert sim.state.energy <= sim.initial_state.energy * (1.0 + 1e-9)
    assert closest(sim.scene, sim.state) > -1e-9


@pytest.mark.interpreted
def test_a_disc_that_falls_or_slides_does_not_rest():
    """Only what has contacts, or lies on a wall without a velocity, is at rest."""
    particles = [gp.Particle((5.0, 0.5), (1e-4, 0.0), 0.5), gp.Particle((8.0, 500.0), (0.0, 0.0), 0.5)]
    sim = sent((10.0, 600.0), particles, gp.Restitution(0.9), gravity=(0.0, -1.0))
    sim.advance(duration=20.0)
    assert sim.state.positions[0, 0] == pytest.approx(5.002, abs=1e-9)
    assert sim.state.positions[1, 1] == pytest.approx(300.0, abs=1e-9)


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(1, 4))
def test_a_pile_comes_to_rest(seed):
    """It loses its energy, never gains any, overlaps nowhere, and a run without an end reports the rest."""
    scene = pile(16, 7.3, 0.8)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=seed)
    energy = sim.initial_state.energy
    for _ in range(20):
        sim.advance(duration=5.0)
        state = sim.state
        assert state.energy <= energy + 1e-10 * sim.initial_state.energy
        energy = state.energy
        assert closest(scene, state) > -1e-9
        sim.check_invariants()
    assert sim.tally.elastic_contacts > 0.5 * sim.tally.collisions
    before = sim.state
    sim.advance(duration=1e6)
    assert np.array_equal(sim.state.positions, before.positions)


@pytest.mark.interpreted
def test_a_disc_rests_in_a_wedge_of_a_face_and_a_wall():
    """Gravity leads it away from the wall, but along the face into it."""
    wall = gp.Wall((4.530214891767726, 7.530962588563303), (0.30510500663674056, 10.32522599640507))
    particle = gp.Particle((0.6, 8.0), (0.0, 0.0), 0.437162361784311)
    gravity = (-0.0886183538201192, 0.04633343680553132)
    for law in (gp.Restitution(0.0, 0.9), gp.Restitution(0.5, -1.0, 0.0)):
        sim = sent((10.0, 13.0), [particle], law, gravity=gravity, walls=[wall])
        sim.record_events = True  # with the kernels of the searches' comparison
        sim.advance(duration=1000.0)
        sim.check_invariants()
        assert np.array_equal(sim.state.velocities, [[0.0, 0.0]])


@pytest.mark.thorough
def test_share_of_elastic_contacts_of_a_dilute_gas():
    """For t_c far below the time of free flight it is 2 t_c <w^2>/<w>: the rates w of the two particles, each
    weighted with itself, since fast particles collide more often."""
    scene = replace(gas(2, 1000, 0.01), restitution=gp.Restitution(1.0 - 1e-9, -1.0, 0.5))
    sim = gp.Simulation(scene, gp.EventDriven(), seed=5)
    sim.advance(duration=20.0)
    sim.reset_tally()
    sim.advance(duration=1500.0)
    tally = sim.tally
    rate = 2.0 * tally.collisions / (1000 * tally.time)
    share = tally.elastic_contacts / tally.collisions
    expected = 2.0 * weight_of_rates() * rate * 0.5
    error = math.sqrt(share / tally.collisions)
    assert expected < 0.05
    assert share == pytest.approx(expected * (1.0 - 0.5 * expected), abs=4.0 * error + 0.02 * expected)


def weight_of_rates():
    """<w^2>/<w>^2 of Maxwellian discs, w(v) proportional to the mean relative speed: by sampling."""
    rng = np.random.default_rng(1)
    others = rng.normal(size=(4000, 2))
    rates = np.array([np.hypot(*(v - others).T).mean() for v in rng.normal(size=(4000, 2))])
    return float((rates**2).mean() / rates.mean() ** 2)
