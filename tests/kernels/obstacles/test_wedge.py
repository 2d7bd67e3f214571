"""Particles that slide into an acute wedge, between what they rest on and what hangs over them."""

import math

import numpy as np
import pytest

import gaspart as gp

RADIUS, SPEED = 0.5, 0.004  # the speed of a fall of 0.4 of the default contact duration
LAW = gp.Restitution(0.1)
BELOW = gp.Wall((5.0, 3.0), (15.0, 3.0))


def overhang(angle, foot=(4.0, 3.0)):
    """A wall that rises to the right at an angle from its foot."""
    return gp.Wall(foot, (foot[0] + 6.0 * math.cos(angle), foot[1] + 6.0 * math.sin(angle)))


def discs(place, velocity, walls, gravity=(0.0, -1.0), fixed=None, law=LAW):
    particles = [gp.Particle(place, velocity, RADIUS)]
    if fixed:
        particles.append(gp.Particle(fixed, (0.0, 0.0), 1.0, fixed=True))
    container = gp.Container((20.0, 20.0))
    return gp.Scene(container, particles=particles, walls=walls, restitution=law, gravity=gravity)


def after(scene, duration):
    sim = gp.Simulation(scene, gp.EventDriven())
    sim.advance(duration=duration)
    sim.check_invariants()
    return sim


@pytest.mark.interpreted
@pytest.mark.parametrize("angle", [0.2, 0.6, 0.77])
@pytest.mark.parametrize("walls", [[BELOW], []])
def test_a_disc_comes_to_rest_in_an_acute_wedge(angle, walls):
    """Of a wall and another one, or the floor: at cos(2 angle) of its speed it would meet both for ever."""
    height = 3.0 if walls else 0.0
    at = 4.0 + RADIUS / math.tan(0.5 * angle)
    scene = discs((at + 0.1, height + RADIUS), (-SPEED, 0.0), [*walls, overhang(angle, (4.0, height))])
    sim = after(scene, 1000.0)
    assert sim.state.positions[0] == pytest.approx([at, height + RADIUS], abs=1e-12)
    assert np.array_equal(sim.state.velocities[0], [0.0, 0.0])
    assert sim.tally.dissipated_energy == pytest.approx(0.5 * SPEED**2, rel=1e-9)
    assert sim.tally.wall_hits.sum() < 20


@pytest.mark.interpreted
def test_a_disc_returns_from_a_wedge_that_is_less_acute():
    """Of 50 degrees, with what the contact leaves of its speed along the wall below."""
    angle = math.radians(50.0)
    at = 4.0 + RADIUS / math.tan(0.5 * angle)
    scene = discs((at + 0.1, 3.5), (-SPEED, 0.0), [BELOW, overhang(angle)], law=gp.Restitution(0.9))
    sim = after(scene, 50.0)
    left = (1.0 + 0.9) * math.sin(angle) ** 2 - 1.0
    assert sim.state.velocities[0] == pytest.approx([left * SPEED, 0.0], abs=1e-12)


@pytest.mark.interpreted
def test_a_disc_slides_out_of_a_wedge_along_a_slope():
    """Up into it, where it stops, and down again from rest."""
    slope, angle = 1e-4, 0.6
    gravity = (math.sin(slope), -math.cos(slope))
    at = 4.0 + RADIUS / math.tan(0.5 * angle)
    scene = discs((at + 0.01, 3.5), (-SPEED, 0.0), [BELOW, overhang(angle)], gravity)
    pull = math.sin(slope)
    arrival = (SPEED - math.sqrt(SPEED**2 - 2.0 * pull * 0.01)) / pull
    sim = after(scene, arrival + 100.0)
    assert sim.state.positions[0] == pytest.approx([at + 0.5 * pull * 100.0**2, 3.5], abs=1e-9)
    assert sim.state.velocities[0] == pytest.approx([100.0 * pull, 0.0], abs=1e-12)


@pytest.mark.interpreted
@pytest.mark.parametrize("walls", [[BELOW], []])
def test_a_disc_comes_to_rest_below_a_fixed_one(walls):
    """At a speed at which it does not bounce so soon after the contact."""
    height = 3.5 if walls else 0.5
    at = 7.0 + math.sqrt(1.5**2 - 1.4**2)
    scene = discs((at + 1e-4, height), (-1e-5, 0.0), walls, fixed=(7.0, height + 1.4))
    sim = after(scene, 100.0)
    assert sim.state.positions[0] == pytest.approx([at, height], abs=1e-12)
    assert np.array_equal(sim.state.velocities[0], [0.0, 0.0])
    assert sim.tally.collisions < 20


@pytest.mark.interpreted
@pytest.mark.parametrize("along", [0.0, 0.002])
@pytest.mark.parametrize("plates", [1, 2])
def test_a_sphere_slides_along_a_wedge(plates, along):
    """Of a plate and another one or the floor: it keeps its velocity along both."""
    angle = 0.6
    height = 3.0 if plates == 2 else 0.0
    foot = (1.0, 1.0, height)
    rise = (8.0 * math.cos(angle), 0.0, 4.0 * math.sin(angle))
    walls = [gp.Plate(foot, (rise, (0.0, 8.0, 0.0)))]
    if plates == 2:
        walls.append(gp.Plate((1.5, 1.0, 3.0), ((8.0, 0.0, 0.0), (0.0, 8.0, 0.0))))
    tilt = math.atan2(rise[2], rise[0])
    at = 1.0 + RADIUS / math.tan(0.5 * tilt)
    particle = gp.Particle((at + 0.01, 3.0, height + RADIUS), (-SPEED, along, 0.0), RADIUS)
    rest = {"walls": walls, "restitution": LAW, "gravity": (0.0, 0.0, -1.0)}
    scene = gp.Scene(gp.Container((10.0, 10.0, 10.0)), particles=[particle], **rest)
    sim = after(scene, 1000.0)
    assert sim.state.positions[0] == pytest.approx([at, 3.0 + 1000.0 * along, height + RADIUS], abs=1e-9)
    assert sim.state.velocities[0] == pytest.approx([0.0, along, 0.0], abs=1e-12)
