"""Thermal faces that mirror a part of the particles (Maxwell's model) or slide: fractions and fluxes."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.expected.flows import plates_of
from gaspart.analysis.run import open_run

A = gp.analysis
GAP, SIDE = 10.0, 4.0
ENGINES = {"event": gp.EventDriven(), "dsmc": gp.DSMC(0.25, 1, "boltzmann")}
HOT, COLD = 0.75, 0.375
"""Accommodation of both plates; a_1 a_2 / (a_1 + a_2 - a_1 a_2) = 1/3 of what is carried at the same hits."""


def plates(count, radius=1e-3, hot=1.0, slide=0.0, drift=0.0, fractions=(HOT, COLD)):
    """Between x_low, at `hot`, and x_high, at 1, which slides along y."""
    faces = {
        "x_low": gp.Thermal(hot, velocity=(0.0, drift, 0.0), accommodation=fractions[0]),
        "x_high": gp.Thermal(1.0, velocity=(0.0, drift + slide, 0.0), accommodation=fractions[1]),
    }
    container = gp.Container((GAP, SIDE, SIDE), ("wall", "periodic", "periodic"))
    return gp.Scene(container, [gp.Species(count, radius, temperature=1.2)], faces=faces)


def made(scene, duration, engine, seed=1):
    simulation = gp.Simulation(scene, ENGINES[engine], seed=seed)
    simulation.advance(duration=duration)
    simulation.check_invariants()
    return simulation


def off(found):
    """Deviations in standard deviations, of values with an error."""
    return np.abs(found.deviation.values[np.isfinite(found.deviation.values)])


@pytest.mark.thorough
@pytest.mark.parametrize(("engine", "count", "drift"), [("event", 200, 1.0), ("dsmc", 1000, 0.5)])
def test_heat_of_free_flight(engine, count, drift):
    """With J hits per area and time, 2 k_B (T_1 - T_2) J a_1 a_2 / (a_1 + a_2 - a_1 a_2): of the flux and of
    the hits, and by theory from the density, whatever the speed of both plates along themselves."""
    simulation = made(plates(count, hot=4.0, drift=drift), 1500.0, engine)
    found = A.heat_flux(simulation)
    per_hit = simulation.tally.wall_hits[:2].mean() / (simulation.time * SIDE**2)
    assert found.theory[1] == pytest.approx(2.0 * 3.0 * per_hit / 3.0, rel=0.03)
    assert found.theory[0] == -found.theory[1] and "free flight" in found.attrs["source"]
    assert (found.error < 0.08 * found.theory[1]).all() and (off(found) < 3.0).all()


@pytest.mark.thorough
def test_the_fraction_of_hits_that_are_mirrored():
    """Whatever the particle and the hit; a mirrored one keeps its velocity along the face, to the bit."""
    simulation = gp.Simulation(plates(200, hot=4.0, drift=1.0), ENGINES["event"], seed=2)
    simulation.record_events = True
    simulation.advance(max_events=20_000)
    events, before = simulation.events, simulation.initial_state.velocities.copy()
    hits, mirrored = np.zeros(2), np.zeros(2)
    for (one, other), velocities in zip(events["particles"], events["velocities"], strict=True):
        if other < 0:
            kept = (velocities[0, 1:] == before[one][1:]).all()
            assert kept == (velocities[0, 0] == -before[one][0])
            hits[-1 - other] += 1
            mirrored[-1 - other] += kept
        else:
            before[other] = velocities[1]
        before[one] = velocities[0]
    for side, fraction in enumerate((HOT, COLD)):
        error = math.sqrt(fraction * (1.0 - fraction) / hits[side])
        assert mirrored[side] / hits[side] == pytest.approx(1.0 - fraction, abs=3.0 * error)


@pytest.mark.interpreted
def test_two_engines_draw_the_same():
    """One particle, whose draws are numbered by its hits: it is in the same place at the end."""
    particle = gp.Particle((3.0, 2.0, 1.0), (1.0, 0.5, -0.25), 0.25)
    faces = {"x_low": gp.Thermal(2.0, accommodation=HOT), "x_high": gp.Thermal(1.0, accommodation=COLD)}
    container = gp.Container((GAP, SIDE, SIDE), ("wall", "periodic", "periodic"))
    scene = gp.Scene(container, particles=[particle], faces=faces)
    event, step = (gp.Simulation(scene, engine, seed=5) for engine in ("event", gp.TimeStepped(0.25)))
    for simulation in (event, step):
        simulation.advance(duration=1000.0)
    assert event.tally.wall_hits[0] > 30
    assert event.tally.wall_hits.tolist() == step.tally.wall_hits.tolist()
    assert event.tally.wall_energy == pytest.approx(step.tally.wall_energy, rel=1e-6)
    assert event.state.unwrapped == pytest.approx(step.state.unwrapped, abs=1e-6)


@pytest.mark.thorough
def test_theory_of_a_fluid_is_for_full_accommodation():
    """None is stated at a Knudsen number of 0.4, and of 150 with few hits that draw velocities."""
    for radius, fractions in ((0.15, (0.9, 0.9)), (0.0078, (1.0, 0.5))):
        simulation = made(plates(100, radius, hot=2.0, fractions=fractions), 20.0, "dsmc")
        with open_run(simulation, 0.0) as run:
            found = plates_of(run)
        assert found.freedom == found.knudsen * min(fractions) < 100.0
        assert "theory" not in A.heat_flux(simulation)
    assert found.knudsen > 100.0


@pytest.mark.interpreted
def test_full_accommodation_is_no_feature():
    """1 is the same as none: to kernels, to files and to comparisons."""
    assert gp.Thermal(1.0, accommodation=1.0) == gp.Thermal(1.0)
    assert "accommodation" not in plates(1, fractions=(1.0, 1.0)).to_dict()["faces"]["x_low"]


@pytest.mark.interpreted
@pytest.mark.parametrize("value", [0.0, -0.5, 1.5, "half", True, math.nan])
def test_what_is_refused(value):
    face = {"kind": "thermal", "temperature": 1.0, "accommodation": value}
    with pytest.raises(gp.SceneError, match=r"faces.x_low.accommodation = .*: must be above 0 and at most 1"):
        gp.Scene.from_dict({"container": {"lengths": [9.0, 9.0]}, "faces": {"x_low": face}})


WALLED = gp.Container((5.0, 10.0, 10.0), ("wall", "periodic", "periodic"))


@pytest.mark.interpreted
def test_a_velocity_of_zero_changes_nothing():
    gas, states = gp.Species(400, 0.2, temperature=1.0), []
    for face in (gp.Thermal(1.0), gp.Thermal(1.0, velocity=(0.0, -0.0, 0.0))):
        scene = gp.Scene(WALLED, [gas], faces=dict.fromkeys(("x_low", "x_high"), face))
        sim = gp.Simulation(scene, ENGINES["dsmc"], seed=2)
        sim.advance(duration=1.0)
        assert sim.tally.wall_shear is None
        states.append(sim.state)
    assert (states[0].velocities == states[1].velocities).all()


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("velocity", "rule"),
    [((1.0, 0.0, 0.0), "no component across"), ((0.0, 1.0), "3 finite numbers"), ("fast", "finite numbers")],
)
def test_a_velocity_lies_along_the_face(velocity, rule):
    with pytest.raises(gp.SceneError, match=f"velocity = .*{rule}"):
        gp.Scene(WALLED, faces={"x_low": gp.Thermal(1.0, velocity=velocity)})


@pytest.mark.interpreted
def test_a_face_that_keeps_tangential_velocities_does_not_slide():
    with pytest.raises(gp.SceneError, match='velocity = .*components "all"'):
        gp.Thermal(1.0, "normal", (0.0, 1.0, 0.0))
