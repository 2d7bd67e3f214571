"""A piston at a stated speed: contacts of one ball, its work, a slow compression, a shock, the same bits."""

import math
from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart import theory

ACROSS = ("wall", "periodic", "periodic")


def compressed(lengths, species, speed, face="x_high", **rest):
    """A gas in front of a piston at a speed."""
    container = gp.Container(lengths, ACROSS[: len(lengths)])
    return gp.Scene(container, species, faces={face: gp.Piston(speed=speed)}, **rest)


@pytest.mark.interpreted
@pytest.mark.parametrize("face", ["x_low", "x_high"])
def test_each_contact_of_a_ball_adds_twice_the_speed(face):
    """Between the piston, at 12 - t / 2, and the other wall, at 0; the ball is a point there."""
    speed, ball, height = 0.5, 1.0, 5.0
    place = height + 0.5 if face == "x_high" else 13.0 - 0.5 - height
    towards = 1.0 if face == "x_high" else -1.0
    particle = gp.Particle((place, 2.0), (towards * ball, 0.0), 0.5)
    sim = gp.Simulation(compressed((13.0, 4.0), [], speed, face, particles=[particle]), gp.EventDriven())
    sim.record_events = True
    sim.advance(until=20.0)
    hits = sim.events["particles"][:, 1] == (-1 if face == "x_low" else -2)
    time, expected = 0.0, []
    while True:
        late = (12.0 - speed * time - height) / (ball + speed)
        if time + late > 20.0:
            break
        time, ball = time + late, ball + 2.0 * speed
        expected.append((time, ball))
        time, height = time + (12.0 - speed * time) / ball, 0.0
    found = np.stack([sim.events["time"], np.abs(sim.events["velocities"][:, 0, 0])], axis=1)[hits]
    assert len(expected) > 5
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    assert sim.state.piston == pytest.approx([13.0 - 10.0, -0.5] if towards > 0.0 else [10.0, 0.5], rel=1e-12)


@pytest.mark.thorough
@pytest.mark.parametrize("dimension", [2, 3])
def test_a_slow_compression_follows_the_adiabat(dimension):
    """T V^(2/d) of a dilute gas stays the same but for its pressure, 1.004 times the ideal one, and for what
    the speed of the piston, 0.01 of the thermal one, adds. Without contacts T would be 1.1 times as high."""
    side, count, radius = 8.0, 300, {2: 0.02, 3: 0.12}[dimension]
    gas = [gp.Species(count, radius, temperature=1.0, exact_temperature=True)]
    scene = compressed((16.0, *(side,) * (dimension - 1)), gas, 0.01)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=1)
    before = sim.state.energy
    room, filled = 16.0 - 2.0 * radius, scene.packing_fraction
    sim.advance(until=600.0)
    ratio = room / (room - 6.0)
    work = 2.0 / dimension * math.log(ratio)  # of an ideal gas; Z is 1 + 2^(d-1) eta
    excess = 2.0 / dimension * 2.0 ** (dimension - 1) * filled * (ratio - 1.0)
    assert excess < 0.005 and sim.tally.collisions > 30 * count
    assert math.log(sim.state.energy / before) == pytest.approx(work + excess, rel=0.02)


@pytest.mark.thorough
def test_a_fast_piston_drives_a_shock_by_the_jump_conditions():
    """Density and temperature behind it where the gas is, the pressure on the piston and the momentum of the
    gas, which the front's speed makes; away from the piston, where its start has left the gas hotter."""
    filled, speed, lengths = 0.08, 1.5, (300.0, 100.0)
    density = float(theory.number_density(filled, 2))
    gas = [gp.Species(round(density * 299.0 * 100.0), 0.5, temperature=1.0, exact_temperature=True)]
    scene, expected = compressed(lengths, gas, speed, "x_low"), theory.shock_before_piston(filled, 2, speed)
    found = []
    for seed in range(8):
        sim = gp.Simulation(scene, gp.EventDriven(), seed)
        sim.advance(until=25.0)
        sim.reset_tally()
        before, dense, hot = sim.state.momentum[0], [], []
        for _ in range(20):
            sim.advance(duration=2.0)
            state, low, high = sim.state, sim.state.piston[0] + 8.0, expected.speed * sim.time - 12.0
            inside = (state.positions[:, 0] > low) & (state.positions[:, 0] < high)
            dense.append(inside.sum() / (high - low) / 100.0 * math.pi / 4.0)
            hot.append(0.5 * ((state.velocities[inside] - (speed, 0.0)) ** 2).sum(axis=1).mean())
        front = (sim.state.momentum[0] - before) / (density * 100.0 * speed * 40.0)
        pressure = sim.tally.wall_impulse[0] / 100.0 / 40.0
        found.append((front, np.mean(dense), np.mean(hot), pressure))
    mean, error = np.mean(found, axis=0), np.std(found, axis=0, ddof=1) / math.sqrt(8.0)
    known = np.array([expected.speed, expected.packing_fraction, expected.temperature, expected.pressure])
    assert (error / known < (0.025, 0.007, 0.01, 0.02)).all()
    assert (abs(mean - known) < 4.5 * error).all()  # Student's, as rare as 3 sigma


@pytest.mark.interpreted
def test_what_a_speed_does_not_go_with_is_refused():
    for stated in ({}, {"mass": 1.0}, {"pressure": 1.0}, {"speed": 1.0, "mass": 1.0}):
        with pytest.raises(gp.SceneError, match="must be mass and pressure, or speed alone"):
            gp.Piston(**stated)
    scene = compressed((40.0, 8.0), [gp.Species(60, 0.5, temperature=1.0)], 0.5)
    with pytest.raises(gp.SceneError, match="gravity.*piston"):
        replace(scene, gravity=(-1.0, 0.0))


@pytest.mark.thorough
def test_a_run_must_end_before_there_is_no_room(tmp_path):
    """60 discs in closest packing are 6.5 long of 40: the piston is there at 67."""
    scene = compressed((40.0, 8.0), [gp.Species(60, 0.5, temperature=1.0)], 0.5)
    rule = r"must be before 67\.0[0-9]*, when the piston leaves no room for the particles"
    with pytest.raises(gp.SceneError, match=f"duration = 70.0: {rule}"):
        gp.run(scene, gp.EventDriven(), 1, 70.0, 1.0, tmp_path / "run.nc")
    sim = gp.Simulation(scene, gp.EventDriven(), 1)
    with pytest.raises(gp.SceneError, match=f"until = 70.0: {rule}"):
        sim.advance(until=70.0)
    sim.advance(until=40.0)
    later = gp.Simulation(scene, gp.EventDriven(), 1, initial=sim.state)
    assert later.state.piston == pytest.approx([20.0, -0.5])
    with pytest.raises(gp.SceneError, match="until = 30.0: must be before 27"):
        later.advance(until=30.0)
    later.advance(until=5.0)


@pytest.mark.interpreted
def test_weak_and_strong_shocks_and_what_is_refused():
    weak = theory.shock_before_piston(0.1, 3, 1e-4)  # sound
    assert weak.speed == pytest.approx(float(theory.speed_of_sound(0.1, 3)), rel=1e-3)
    strong = theory.shock_before_piston(1e-9, 3, 1e4)  # of an ideal gas: 4, 4/3 u, u^2 / 3
    assert (strong.packing_fraction, strong.speed) == pytest.approx((4e-9, 4e4 / 3.0), rel=1e-6)
    assert strong.temperature == pytest.approx(1e8 / 3.0, rel=1e-6)
    with pytest.raises(gp.SceneError, match="speed.*must be positive"):
        theory.shock_before_piston(0.1, 3, 0.0)
    with pytest.raises(gp.SceneError, match="speed.*beyond the densities"):
        theory.shock_before_piston(0.5, 3, 30.0)
