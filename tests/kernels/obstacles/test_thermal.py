"""Thermal walls: the temperature that they give, the heat that they take, and the same bits in any search."""

import math

import numpy as np
import pytest

import gaspart as gp


@pytest.mark.thorough
def test_a_gas_takes_the_temperature_of_its_walls():
    """In each direction, spins included; the energy of a canonical gas has a variance to compare with."""
    scene = gp.Scene(
        gp.Container((8.0, 8.0)),
        [gp.Species(100, 0.05, mass=2.0, temperature=0.3)],
        gravity=(0.0, -0.5),  # without effect on velocities
        restitution=gp.Restitution(1.0, 1.0),
        faces={name: gp.Thermal(2.0) for name in ("x_low", "x_high", "y_low", "y_high")},
    )
    sim = gp.Simulation(scene, gp.EventDriven(), seed=4)
    sim.record_events = True
    sim.advance(duration=100.0)
    found = []
    for _ in range(20):
        sim.advance(duration=40.0)
        state = sim.state
        spins = state.moments_of_inertia * state.spins**2
        found.append([*(2.0 * state.velocities**2).mean(axis=0), spins.mean()])
    sigma = 2.0 * math.sqrt(2.0 / 100 / 20)
    assert np.mean(found, axis=0) == pytest.approx([2.0] * 3, abs=3 * sigma)
    sim.check_invariants()


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"faces": {"z_low": {"kind": "thermal", "temperature": 1.0}}}, "faces.z_low"),
        ({"faces": {"y_low": {"kind": "thermal", "temperature": 1.0}}}, "faces.y_low"),
        ({"faces": {"x_low": {"temperature": 1.0}}}, "faces.x_low.kind"),
        (
            {"faces": {"x_low": {"kind": "thermal", "temperature": 1.0, "components": "tangential"}}},
            "faces.x_low.components",
        ),
        ({"faces": {"x_low": {"kind": "thermal", "temperature": 1.0, "depth": 1.0}}}, "faces.x_low.depth"),
    ],
)
def test_what_is_refused(change, key):
    container = {"lengths": [12.0, 12.0], "boundary": ["wall", "periodic"]}
    with pytest.raises(gp.SceneError) as caught:
        gp.Scene.from_dict({"container": container} | change)
    assert caught.value.key == key


def box_of_discs(count):
    """A few discs between thermal walls of two temperatures."""
    faces = {"x_low": gp.Thermal(1.0), "x_high": gp.Thermal(4.0)}
    return gp.Scene(gp.Container((10.0, 10.0)), [gp.Species(count, 0.5, temperature=1.0)], faces=faces)


@pytest.mark.thorough
@pytest.mark.parametrize("count", [1, 3])
def test_a_correct_run_between_thermal_walls_is_not_aborted(count):
    """The heat that goes through grows for ever, and with it the rounding of a plain sum of it."""
    sim = gp.Simulation(box_of_discs(count), gp.EventDriven(), seed=1)
    for _ in range(15):
        sim.advance(max_events=100_000)
        sim.check_invariants()
    assert sim.tally.wall_energy[1] < -1e5


@pytest.mark.thorough
def test_an_error_of_the_energy_is_still_found():
    sim = gp.Simulation(box_of_discs(3), gp.EventDriven(), seed=1)
    sim.advance(max_events=100_000)
    state = sim.state.copy()
    state.velocities *= 1.0 + 1e-8
    with pytest.raises(gp.SimulationError, match="energy has drifted"):
        sim.check_invariants(state)
