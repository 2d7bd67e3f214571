"""Vibrating faces: bounces of one ball that are known, the energy of many, and the same bits throughout."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scenes import place
from scipy.optimize import brentq

import gaspart as gp

SINE, SAWTOOTH = gp.Vibrating(0.2, 1.3), gp.Vibrating(0.15, 0.7, "sawtooth")
DOWN = (0.0, -1.0)
_PARTED = 1e-5  # time after a bounce at which the ball is clear of the face: less than any bounce lasts


def ball(faces, height=2.0, velocity=0.0, law=None, gravity=DOWN, side=40.0):
    """One ball between a floor and a ceiling."""
    particle = gp.Particle((2.0, 0.5 + height), (0.0, velocity), 0.5)
    container = gp.Container((4.0, side), ("periodic", "wall"))
    return gp.Scene(container, particles=[particle], faces=faces, gravity=gravity, restitution=law)


def speed(face, time):
    """How fast it moves inwards then."""
    if face.waveform == "sawtooth":
        return 2.0 * face.amplitude / face.period
    turn = 2.0 * math.pi / face.period
    return face.amplitude * turn * math.sin(turn * time)


def next_bounce(face, time, height, velocity, pull):
    """(time, velocity) of the next bounce on the floor: by bisection of what small steps enclose."""

    def gap(t):
        late = t - time
        return height + velocity * late - 0.5 * pull * late * late - place(face, t)

    step, late = face.period / 400.0, face.period / 400.0
    while gap(time + late) > 0.0:
        late += step
    before = time + max(late - step, _PARTED)
    hit = brentq(gap, before, time + late, xtol=1e-15, rtol=1e-15)
    return hit, velocity - pull * (hit - time)


def thrown(scene):
    """A simulation that records its events."""
    sim = gp.Simulation(scene, gp.EventDriven())
    sim.record_events = True
    return sim


def bounces(sim, count):
    """Time, face, height and velocity after each of the next events of a simulation that records them."""
    before = len(sim.events["time"])
    sim.advance(max_events=count)
    events = {key: array[before:] for key, array in sim.events.items()}
    faces = -1 - events["particles"][:, 1]
    height, velocity = events["positions"][:, 0, 1] - 0.5, events["velocities"][:, 0, 1]
    return list(zip(events["time"], faces, height, velocity, strict=True))


@pytest.mark.thorough
@pytest.mark.parametrize("face", [SINE, SAWTOOTH], ids=["sine", "sawtooth"])
@pytest.mark.parametrize("law", [None, gp.Restitution(0.8)], ids=["elastic", "lossy"])
def test_a_ball_bounces_on_a_vibrating_floor_as_computed_otherwise(face, law):
    """Each bounce from the one before; the second lot of bounces is many epochs of the clocks later. A bounce
    within the duration of a contact, 0.01 in these units, is elastic."""
    sim = thrown(ball({"y_low": face}, law=law, side=1e4))
    for start in (0.0, 2000.0):
        sim.advance(until=start)
        known = bounces(sim, 25)
        for (time, _, height, velocity), (then, code, there, after) in itertools.pairwise(known):
            assert code == 2
            hit, arrives = next_bounce(face, time, height, velocity, 1.0)
            assert then == pytest.approx(hit, abs=1e-9)
            assert there == pytest.approx(place(face, hit), abs=1e-9)
            wall, lasts = speed(face, hit), then - time < 0.01
            restitution = law.normal if law and not lasts else 1.0
            assert after == pytest.approx(wall + restitution * (wall - arrives), abs=1e-8)
    sim.check_invariants()


@pytest.mark.interpreted
def test_each_bounce_on_a_small_sawtooth_adds_twice_its_speed():
    """The amplitude is nothing compared with the height, so the ball arrives as fast as it has left."""
    face = gp.Vibrating(1e-10, 1e-9, "sawtooth")
    known = bounces(thrown(ball({"y_low": face}, side=1e3)), 60)
    after = [velocity for _, _, _, velocity in known]
    assert after == pytest.approx(math.sqrt(4.0) + 2.0 * 0.2 * np.arange(1, 61), rel=1e-8)


@pytest.mark.interpreted
@pytest.mark.parametrize("face", [SINE, SAWTOOTH], ids=["sine", "sawtooth"])
def test_a_ball_between_a_vibrating_and_a_fixed_face(face):
    """Fermi's accelerator without gravity: the ball flies straight from one face to the other."""
    sim = thrown(ball({"y_high": face}, 1.0, 0.7, gravity=None, side=4.0))
    known = bounces(sim, 40)
    for (time, code, height, velocity), (then, other, there, after) in itertools.pairwise(known):
        assert {code, other} == {2, 3} or (code == other == 3)
        if other == 2:
            assert then - time == pytest.approx(height / -velocity, rel=1e-12)
            assert after == -velocity
        else:
            hit, arrives = next_bounce(face, time, 3.0 - height, -velocity, 0.0)
            assert then == pytest.approx(hit, abs=1e-9)
            assert 3.0 - there == pytest.approx(place(face, hit), abs=1e-9)
            assert -after == pytest.approx(2.0 * speed(face, hit) - arrives, abs=1e-8)
    energy = 0.5 * known[-1][3] ** 2 - 0.5 * 0.7**2
    assert sim.tally.wall_energy[3] == pytest.approx(-energy, rel=1e-12)


@pytest.mark.thorough
def test_a_ball_without_bounce_follows_a_slow_floor_and_leaves_a_fast_one():
    """The floor's largest acceleration is A (2 pi / P)^2, over or under that of gravity."""
    law = gp.Restitution(0.0)
    for period, leaves in ((4.0, False), (1.0, True)):
        face = gp.Vibrating(0.1, period)
        sim = gp.Simulation(ball({"y_low": face}, 0.0, law=law), gp.EventDriven())
        highest = 0.0
        for n in range(1, 60):
            sim.advance(until=n * period / 19.0)
            height = sim.state.positions[0, 1] - 0.5 - place(face, sim.time)
            assert height > -1e-12
            highest = max(highest, height)
        assert (highest > 0.05) == leaves
        assert leaves or highest < 1e-3
        sim.check_invariants()


@pytest.mark.interpreted
def test_what_cannot_vibrate_is_refused():
    scene = ball({"y_low": SINE})
    with pytest.raises(gp.SceneError, match="hard or thermal"):
        replace(ball({"y_low": SINE}, gravity=None), thermostat=gp.Thermostat(1.0, 0.1))
    with pytest.raises(gp.SceneError, match="periodic axis"):
        replace(scene, faces={"x_low": SINE})
    with pytest.raises(gp.SceneError, match=r"y_low\.amplitude.*no room"):
        replace(scene, faces={"y_low": gp.Vibrating(10.0, 1.0), "y_high": gp.Vibrating(9.6, 1.0)})
    with pytest.raises(gp.SceneError, match="close packing"):
        replace(scene, particles=(), species=[gp.Species(120, 0.5)], faces={"y_low": gp.Vibrating(10.0, 1.0)})
    with pytest.raises(gp.SceneError, match="amplitude|period"):
        gp.Vibrating(1e50, 1e-50)


@pytest.mark.interpreted
def test_obstacles_against_which_a_face_would_press_are_refused():
    scene = ball({"y_low": SINE})
    post = gp.Particle((1.0, 1.5), (0.0, 0.0), 0.2, fixed=True)
    with pytest.raises(gp.SceneError, match="particles.*less than a largest diameter"):
        replace(scene, particles=(post,), species=[gp.Species(1, 0.5)])
    with pytest.raises(gp.SceneError, match="species.*fixed"):
        replace(scene, species=[gp.Species(1, 0.1, fixed=True)])
    for ends in (((0.0, 1.0), (1.0, 1.0)), ((1.0, 0.5), (1.0, 9.0)), ((1.0, 0.0), (1.1, 9.0))):
        with pytest.raises(gp.SceneError, match="walls.*less than a largest diameter"):
            replace(scene, walls=[gp.Wall(*ends)])
    for wall in (gp.Wall((0.0, 1.5), (1.0, 1.5)), gp.Wall((1.0, 0.0), (1.0, 9.0))):
        assert replace(scene, walls=[wall]).walls == (wall,)


@pytest.mark.interpreted
def test_of_walls_at_a_vibrating_face_only_upright_ones_stand():
    """The face slides along an upright plate, across whichever axis it lies; it presses against any other."""
    container, balls = gp.Container((9.0, 9.0, 9.0)), [gp.Species(1, 0.5)]
    for axis, name in enumerate("xyz"):
        scene = gp.Scene(container, balls, faces={f"{name}_low": SINE})
        up, across, other = np.roll(np.eye(3), -axis, axis=0)
        corner = 2.0 * (across + other)
        for edges in ((5.0 * up, across), (across, 5.0 * up), (5.0 * up, across + other)):
            plate = gp.Plate(tuple(corner), tuple(map(tuple, edges)))
            assert replace(scene, walls=[plate]).walls == (plate,)
        for edges in ((5.0 * up + across, other), (other, 5.0 * up + across), (across, other)):
            plate = gp.Plate(tuple(corner), tuple(map(tuple, edges)))
            with pytest.raises(gp.SceneError, match="walls.*less than a largest diameter"):
                replace(scene, walls=[plate])
