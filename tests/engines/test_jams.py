"""Jams: particles that supports press together, which are held while others move."""

import math

import numpy as np
import pytest
from scenes import closest

import gaspart as gp

COUNT = 4  # of discs in a row


def row_and_disc(mass, width=float(COUNT)):
    """A row that fills the container's width, with a little energy; a disc hits its second one at 3."""
    row = [gp.Particle((0.5 + n, 0.5 + 1e-3 * (n % 2)), (0.01 * (-1) ** n, 0.0), 0.5) for n in range(COUNT)]
    disc = gp.Particle((1.5, 1.5 + 4.5), (0.0, 0.0), 0.5, mass)
    container = gp.Container((width, 12.0))
    law = gp.Restitution(0.8, 0.3)
    return gp.Scene(container, particles=[*row, disc], gravity=(0.0, -1.0), restitution=law)


def in_jam(sim):
    """(N,) which particles a jam holds."""
    return sim.checkpoint()["contact_island"] >= sim.scene.count


def before_and_after(mass):
    """A simulation in which the row is held, and the first event of the disc has happened."""
    sim = gp.Simulation(row_and_disc(mass), gp.EventDriven())
    sim.advance(until=2.9)
    assert np.array_equal(in_jam(sim), [True] * COUNT + [False])
    assert not np.any(sim.state.velocities[:COUNT])
    before = sim.state.velocities[COUNT, 1]
    sim.advance(max_events=1)
    return sim, before - (sim.time - 2.9)


@pytest.mark.thorough
def test_a_row_between_walls_is_held():
    """It has many contacts in the time of a fall through a diameter, and then none. Its energy is counted."""
    sim = gp.Simulation(row_and_disc(1.0), gp.EventDriven())
    sim.advance(until=1.0)
    before = sim.tally.collisions
    assert before > 1e4
    sim.advance(until=2.9)
    assert sim.tally.collisions == before
    sim.check_invariants()


@pytest.mark.thorough
def test_a_light_disc_bounces_off_a_jam_as_off_a_fixed_particle():
    sim, speed = before_and_after(1e-3)
    assert np.array_equal(in_jam(sim), [True] * COUNT + [False])
    assert not np.any(sim.state.velocities[:COUNT])
    assert np.hypot(*sim.state.velocities[COUNT]) == pytest.approx(-0.8 * speed, rel=1e-6)
    sim.check_invariants()


@pytest.mark.thorough
@pytest.mark.parametrize(("mass", "still"), [(0.05, [True, False, True, True]), (1.0, [False] * COUNT)])
def test_a_heavier_disc_frees_what_it_hits_and_a_heavy_one_frees_all(mass, still):
    """The speed that it can give is 2 v m/(m + 1), over sqrt(2 g d sin(atan(1/4))/256), or 8 times this."""
    sim, speed = before_and_after(mass)
    least = math.sqrt(2.0 / 256.0 * math.sin(math.atan(0.25)))
    frees = 2.0 * abs(speed) * mass / (mass + 1.0) / least
    assert frees > 1.0 and (frees > 8.0) == (not any(still))
    assert np.array_equal(in_jam(sim), [*still, False])
    given = 1.8 * speed * mass / (mass + 1.0)
    assert sim.state.velocities[1, 1] == pytest.approx(given, rel=1e-6)
    sim.check_invariants()


@pytest.mark.interpreted
def test_a_row_with_room_is_not_held_in_a_jam():
    """Its last disc would roll away if gravity were tilted."""
    sim = gp.Simulation(row_and_disc(1.0, COUNT + 0.1), gp.EventDriven())
    sim.advance(until=2.9)
    assert not in_jam(sim).any()


@pytest.mark.thorough
def test_a_hopper_whose_discs_jam_comes_to_rest():
    """Five discs of it stand exactly between the floor and the end of a wall. Without jams they had 9e6
    contacts in ten units of time at 60, and ever more."""
    walls = [gp.Wall((0.0, 8.0), (2.5, 5.0)), gp.Wall((7.0, 8.0), (4.5, 5.0))]
    rest = {"gravity": (0.0, -1.0), "restitution": gp.Restitution(0.8, 0.3), "walls": walls}
    scene = gp.Scene(gp.Container((7.0, 40.0)), [gp.Species(60, 0.5, temperature=1.0)], **rest)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=2)
    energy = sim.state.energy
    sim.advance(until=100.0, max_events=6_000_000)
    assert sim.time == 100.0
    assert not np.any(sim.state.velocities)
    assert sim.state.energy + sim.tally.dissipated_energy == pytest.approx(energy, rel=1e-12)
    assert closest(scene, sim.state) > -1e-9
    sim.check_invariants()
