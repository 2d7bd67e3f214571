"""Scatterers that keep energy in a mode of vibration: a contact swaps it with the normal energy."""

import math
from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp

pytestmark = pytest.mark.thorough

FACES = {"x_high": gp.Thermal(1.0)}  # so that all scenes here need the same kernels


def metal(electrons=40, **modes):
    """Discs among fixed ones that vibrate."""
    kinds = gp.Species(electrons, 0.02, temperature=1.0), gp.Species(20, 0.3, fixed=True, **modes)
    return gp.Scene(gp.Container((10.0, 10.0), "periodic"), kinds)


@pytest.mark.parametrize("energy", [0.0, 0.5, 4.5])
def test_a_contact_swaps_the_normal_energy_with_that_of_the_mode(energy):
    """At 30 degrees off centre: the normal part of the velocity becomes sqrt(2E/m), the other stays."""
    n = np.array([math.cos(math.pi / 6), math.sin(math.pi / 6)])
    still = gp.Particle((6.0, 5.0 + 0.5), (0.0, 0.0), 0.5, fixed=True, vibration=energy)
    particle = gp.Particle((3.0, 5.0), (2.0, 0.0), 0.5, 2.0)
    scene = gp.Scene(gp.Container((10.0, 10.0)), particles=[particle, still], faces=FACES)
    sim = gp.Simulation(scene, gp.EventDriven())
    sim.record_events = True
    sim.advance(max_events=1)
    approach = 2.0 * n[0]
    expected = np.array([2.0, 0.0]) - (approach + math.sqrt(energy)) * n
    assert sim.state.velocities[0] == pytest.approx(expected, abs=1e-13)
    assert sim.state.vibrations == pytest.approx([0.0, approach**2], abs=1e-13)
    assert sim.tally.virial_sum == pytest.approx(2.0 * (approach + math.sqrt(energy)) * 1.0)
    sim.check_invariants()


def test_time_reversal():
    """The swap is its own inverse: with all velocities turned round, everything comes back."""
    scene = metal(electrons=10, temperature=1.0)
    there = gp.Simulation(scene, gp.EventDriven(), seed=3)
    there.advance(duration=4.0)
    start, end = there.initial_state, there.state
    assert there.tally.collisions > 5
    turned = end.copy()
    turned.velocities *= -1.0
    back = gp.Simulation(scene, gp.EventDriven(), initial=turned)
    back.advance(duration=4.0)
    assert back.state.vibrations == pytest.approx(start.vibrations, abs=1e-6)
    assert back.state.positions == pytest.approx(start.positions, abs=1e-6)


def test_equipartition():
    """At fixed energy each mode has E_total / (N_e + N_s) in 2D, exactly; its square is exponential's."""
    sim = gp.Simulation(metal(vibration=0.0), gp.EventDriven(), seed=8)
    total = sim.state.energy
    sim.advance(duration=50.0)
    found, squares = [], []
    for _ in range(150):
        sim.advance(duration=20.0)
        energies = sim.state.vibrations[40:] / total
        found.append(energies.mean())
        squares.append((energies**2).mean())
    sim.check_invariants()
    # the sum over the modes has a Beta(20, 40) distribution, a mode alone Beta(1, 59)
    sigma = math.sqrt(20 * 40 / (60**2 * 61) / 150) / 20
    assert np.mean(found) == pytest.approx(1 / 60, abs=3 * sigma)
    spread = np.std(squares, ddof=1) / math.sqrt(len(squares))
    assert np.mean(squares) == pytest.approx(2 / (60 * 61), abs=3 * spread)


def test_modes_begin_at_their_temperature():
    state = gp.Simulation(metal(temperature=2.5), gp.EventDriven(), seed=2).state
    assert (state.vibrations[:40] == 0.0).all()
    many = gp.Scene(gp.Container((200.0, 200.0)), [gp.Species(4000, 0.3, fixed=True, temperature=2.5)])
    energies = gp.Simulation(many, gp.EventDriven(), seed=2).state.vibrations
    assert energies.mean() == pytest.approx(2.5, abs=3 * 2.5 / math.sqrt(4000))
    assert (energies**2).mean() == pytest.approx(12.5, abs=3 * 12.5 * math.sqrt(5 / 4000))


def test_what_is_refused():
    for change, key in (
        ({"fixed": True, "speed": 1.0}, "speed"),
        ({"vibration": 1.0}, "vibration"),
        ({"fixed": True, "vibration": -1.0}, "vibration"),
        ({"fixed": True, "vibration": 1.0, "temperature": 1.0}, "temperature"),
    ):
        with pytest.raises(gp.SceneError) as caught:
            gp.Species(3, 0.5, **change)
        assert caught.value.key == key
    with pytest.raises(gp.SceneError, match=r"restitution\.normal"):
        replace(metal(vibration=1.0), restitution=gp.Restitution(0.9))
