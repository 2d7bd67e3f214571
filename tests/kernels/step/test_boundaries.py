"""Faces with a kind, rough particles and vibrations in time steps: the event-driven engine's own physics."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import granular, measured_heat, metals, surfaced

import gaspart as gp

FACES = {
    "x_low": gp.Thermal(2.0),
    "x_high": gp.Well(1.0, 1.5),
    "y_low": gp.Well(0.7, 0.5, 1.0),
    "y_high": gp.Sticky(1.0),
}
ROUGH = gp.Restitution(1.0, 0.5)
THREE = (
    gp.Particle((2.0, 5.0), (1.0, 0.3), 0.5, mass=2.0, spin=0.3),
    gp.Particle((6.0, 5.4), (-0.5, 0.0), 0.5, mass=3.0),
    gp.Particle((8.0, 2.4), (-0.5, 0.4), 0.8),
)


def rough_gas(boundary="wall", faces=None, count=120):
    faces = FACES | {"x_high": gp.Thermal(1.0, "normal")} if faces is None else faces
    kinds = [gp.Species(count, 0.2, temperature=1.0), gp.Species(10, 0.4, mass=3.0, temperature=1.0)]
    return gp.Scene(gp.Container((12.0, 12.0), boundary), kinds, restitution=ROUGH, faces=faces)


@pytest.mark.thorough
@pytest.mark.parametrize(
    "parts",
    [
        {"faces": FACES},
        {"faces": {"y_high": gp.Thermal(3.0, "normal")}, "restitution": gp.Restitution(0.9, 0.2)},
        {"faces": {"x_low": gp.Thermal(1.0), "y_low": gp.Thermal(2.0)}, "gravity": (0.0, -0.5)},
    ],
)
def test_few_particles_follow_the_event_driven_engine(parts):
    """The contacts are exact wherever in a step, and the same random numbers belong to the same hits."""
    scene = gp.Scene(gp.Container((10.0, 10.0)), particles=THREE, **{"restitution": ROUGH} | parts)
    exact = gp.Simulation(scene, gp.EventDriven(), seed=3)
    exact.advance(duration=15.0)
    assert exact.tally.collisions >= 2
    assert exact.tally.wall_hits.sum() >= 4
    for time_step in (0.05, 0.001):
        sim = gp.Simulation(scene, gp.TimeStepped(time_step), seed=3)
        sim.advance(duration=15.0)
        sim.check_invariants()
        assert sim.tally.collisions == exact.tally.collisions
        assert sim.tally.wall_hits.tolist() == exact.tally.wall_hits.tolist()
        for key in ("positions", "velocities", "spins"):
            assert np.allclose(getattr(sim.state, key), getattr(exact.state, key), atol=1e-8), key
        for key in ("wall_energy", "wall_impulse", "dissipated_energy"):
            assert np.allclose(getattr(sim.tally, key), getattr(exact.tally, key), atol=1e-6), key
        assert np.array_equal(sim.state.well_energies, exact.state.well_energies)
        if exact.state.vibrations is not None:
            assert np.allclose(sim.state.vibrations, exact.state.vibrations, atol=1e-9)


@pytest.mark.thorough
def test_heat_through_a_gas_is_that_of_the_event_driven_engine():
    """What the walls give the gas has, and what flows from the hot to the cold one is the same in both."""
    scene = rough_gas(("wall", "periodic"), {"x_low": gp.Thermal(4.0), "x_high": gp.Thermal(1.0)})
    scene = replace(scene, restitution=gp.Restitution(1.0, 1.0))  # which loses nothing
    found = []
    for engine in (gp.EventDriven(), gp.TimeStepped(0.02)):
        sim = gp.Simulation(scene, engine, seed=5)
        sim.advance(duration=50.0)
        found.append(measured_heat(sim, 20.0))
    flux, sigma = np.transpose(found)
    assert max(sigma) < 0.05 * flux[0]
    assert flux[1] == pytest.approx(flux[0], abs=3 * math.hypot(*sigma))


@pytest.mark.thorough
@given(st.one_of(surfaced(20), granular(20), metals(20)), st.integers(0, 2**32))
def test_any_search_gives_the_same_bits_in_any_scene(scene, seed):
    ends = []
    for search in ({"boxes_per_side": 1}, {}, {"skin": 0.1}, {"skin": 1.0}):
        try:
            sim = gp.Simulation(scene, gp.TimeStepped(0.01, **search), seed=seed)
        except gp.SceneError as error:
            assert error.key in ("boxes_per_side", "lengths", "time_step", "fixed", "restitution.normal")
            continue
        try:
            sim.advance(duration=3.0)
            sim.check_invariants()
        except gp.SimulationError as error:
            assert "too late" in str(error)
        ends.append((sim.state.unwrapped, sim.state.spins, sim.tally.wall_impulse, sim.tally.wall_energy))
    for end in ends[1:]:
        assert all(np.array_equal(one, other) for one, other in zip(ends[0], end, strict=True))
