"""A piston: contacts of one ball that are computed otherwise, what is conserved, the same bits throughout."""

from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp

SIDE, RADIUS = 12.0, 0.5
_PARTED = 1e-9  # time after a contact from which the next one is looked for


def ball(piston, x, velocity, face="y_high", masses=1.0):
    """One ball between a piston and a wall, and a species of no particle."""
    particle = gp.Particle((2.0, x), (0.0, velocity), RADIUS, mass=masses)
    container = gp.Container((4.0, SIDE), ("periodic", "wall"))
    return gp.Scene(container, particles=[particle], faces={face: piston})


def roots(*coefficients):
    """The real roots after `_PARTED` of a polynomial, by the eigenvalues of its companion matrix."""
    found = np.roots(np.trim_zeros(coefficients, "f"))
    return [root.real for root in found if abs(root.imag) < 1e-12 and root.real > _PARTED]


def bounces(piston, height, velocity, count):
    """(time, height, velocity of the ball afterwards) of its contacts with the piston. Heights count from the
    piston's side: the far wall is at SIDE."""
    mass, push = piston.mass, piston.pressure * 4.0 / piston.mass
    time = place = speed = 0.0
    found = []
    while len(found) < count:
        meets = roots(0.5 * push, speed - velocity, place - height)
        stops = roots(0.5 * push, speed, place) if speed < 0.0 else []
        walls = roots(velocity, height - SIDE + 2.0 * RADIUS) if velocity > 0.0 else []
        late, what = min(
            [(t, "meets") for t in meets] + [(t, "stops") for t in stops] + [(t, "walls") for t in walls]
        )
        time, height = time + late, height + velocity * late
        place, speed = place + (speed + 0.5 * push * late) * late, speed + push * late
        if what == "walls":
            velocity = -velocity
        elif what == "stops":
            place, speed = 0.0, -speed
        else:
            while speed > velocity:  # at its side it bounces back at once, perhaps onto the ball again
                centre = (velocity + mass * speed) / (1.0 + mass)
                velocity, speed = 2.0 * centre - velocity, 2.0 * centre - speed
                if place < 1e-12:
                    place, speed = 0.0, abs(speed)
                found.append((time, height, velocity))
    return found


@pytest.mark.interpreted
@pytest.mark.parametrize("face", ["y_low", "y_high"])
@pytest.mark.parametrize(
    ("mass", "pressure", "height", "velocity"),
    [(5.0, 0.02, 7.0, -1.1), (30.0, 0.5, 3.0, 0.4), (0.3, 0.01, 5.0, -0.8), (2.3, 0.0, 4.0, -1.0)],
)
def test_a_ball_and_a_piston_meet_as_computed_otherwise(face, mass, pressure, height, velocity):
    """A light and a heavy piston, one that is thrown back to its side, and one without a load."""
    piston, inwards = gp.Piston(mass, pressure), 1.0 if face == "y_low" else -1.0
    x = height + RADIUS if face == "y_low" else SIDE - RADIUS - height
    sim = gp.Simulation(ball(piston, x, inwards * velocity, face), gp.EventDriven())
    sim.record_events = True
    sim.advance(max_events=60)
    number = 2 if face == "y_low" else 3
    hits = sim.events["particles"][:, 1] == -1 - number
    places = sim.events["positions"][hits, 0, 1]
    heights = places - RADIUS if face == "y_low" else SIDE - RADIUS - places
    after = inwards * sim.events["velocities"][hits, 0, 1]
    known = bounces(piston, height, velocity, 12)
    measured = list(zip(sim.events["time"][hits], heights, after, strict=True))[: len(known)]
    assert np.array(measured) == pytest.approx(np.array(known), abs=1e-8)
    sim.check_invariants()


@pytest.mark.thorough
def test_a_piston_that_lies_on_a_particle_at_rest_takes_it_along():
    sim = gp.Simulation(ball(gp.Piston(10.0, 0.5), SIDE - RADIUS, 0.0), gp.EventDriven())
    sim.advance(until=3.0, max_events=1_000_000)
    assert sim.time == 3.0
    fallen = 0.5 * (4.0 * 0.5 / 11.0) * 9.0
    assert SIDE - sim.state.piston[0] == pytest.approx(fallen, rel=1e-3)
    assert sim.state.positions[0, 1] + RADIUS < sim.state.piston[0] + 1e-9


def gas(piston, dimension=2, count=60):
    lengths = (30.0, 8.0, 8.0)[:dimension]
    container = gp.Container(lengths, ("wall", "periodic", "periodic")[:dimension])
    return gp.Scene(container, [gp.Species(count, 0.5, temperature=1.0)], faces={"x_high": piston})


@pytest.mark.thorough
@pytest.mark.parametrize("dimension", [2, 3])
def test_the_momentum_of_the_piston_is_that_of_its_load_less_that_of_its_contacts(dimension):
    scene = gas(gp.Piston(40.0, 1.0), dimension)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=4)
    sim.advance(until=400.0)  # its oscillation has come to an end, so that it does not meet its side
    sim.reset_tally()
    start, before = sim.time, sim.state.piston[1]
    for stop in (407.0, 430.0, 5000.0):
        sim.advance(until=stop)
        load = 8.0 ** (dimension - 1) * (stop - start)
        gained = -40.0 * (sim.state.piston[1] - before)
        assert sim.tally.wall_impulse[1] == pytest.approx(load - gained, rel=1e-10)
    assert sim.state.piston[0] < 30.0


@pytest.mark.thorough
def test_an_ideal_gas_follows_its_adiabat():
    """Discs too small to meet, which keep their velocities across the piston: along it the gas is of one
    dimension, and a heavy piston keeps the action of each, speed times length."""
    container = gp.Container((10.0, 10.0), ("wall", "periodic"))
    scene = gp.Scene(
        container, [gp.Species(100, 1e-6, temperature=1.0)], faces={"x_high": gp.Piston(1e6, 100.0)}
    )
    sim = gp.Simulation(scene, gp.EventDriven(), seed=2)
    energy = 0.5 * (sim.state.velocities[:, 0] ** 2).sum()
    for until in (60.0, 120.0):
        sim.advance(until=until)
        state = sim.state
        along = 0.5 * (state.velocities[:, 0] ** 2).sum()
        assert along / energy == pytest.approx((10.0 / state.piston[0]) ** 2, rel=0.01)
    assert state.piston[0] < 7.0 and sim.tally.collisions == 0


@pytest.mark.interpreted
def test_what_a_piston_does_not_go_with_is_refused():
    scene = gas(gp.Piston(20.0, 0.6))
    for key, value in (
        ("gravity", (-1.0, 0.0)),
        ("restitution", gp.Restitution(0.9)),
        ("walls", [gp.Wall((1.0, 1.0), (2.0, 2.0))]),
        ("thermostat", gp.Thermostat(1.0, 0.1)),
    ):
        with pytest.raises(gp.SceneError, match=rf"{key}.*piston|thermostat.*hard or thermal"):
            replace(scene, **{key: value})
    with pytest.raises(gp.SceneError, match="fixed.*piston"):
        replace(scene, species=[gp.Species(3, 0.5, fixed=True)])
    for other in (gp.Piston(1.0, 1.0), gp.Vibrating(0.1, 1.0)):
        with pytest.raises(gp.SceneError, match="faces.*piston"):
            replace(scene, faces={**scene.faces, "x_low": other})
    with pytest.raises(gp.SceneError, match="faces.x_high.*choose other units"):
        gas(gp.Piston(1e-59, 1e59))
