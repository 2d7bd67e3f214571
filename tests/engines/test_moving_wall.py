"""A wall that moves between two gases: contacts computed otherwise, exact means and distributions."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import gaspart as gp
from gaspart.trajectory.export import last_state

EVENT = gp.EventDriven()
WALL_NUMBER = 4
"""Of the interior wall in two dimensions, after the faces."""


def across(place, width, mass, axis=0):
    """A wall across a container of two dimensions."""
    ends = [[0.0, 0.0], [width, width]]
    for end in ends:
        end[axis] = place
    return gp.Wall(*map(tuple, ends), mass=mass)


def divided(left=(20, 4.0), right=(20, 1.0), mass=20.0, lengths=(16.0, 6.0), place=8.0, radius=0.4):
    """(count, temperature) on either side of a wall across x."""
    (x, y), container = lengths, gp.Container(lengths, ("wall", "periodic"))
    species = [
        gp.Species(left[0], radius, temperature=left[1], region=((0.0, 0.0), (place, y))),
        gp.Species(right[0], radius, temperature=right[1], region=((place, 0.0), (x, y))),
    ]
    return gp.Scene(container, species, walls=[across(place, y, mass)])


def meetings(wall, balls, length, count):
    """(time, ball, place of the wall) of contacts of a wall (place, velocity, mass) with a ball on either
    side (place, velocity, mass) that bounces off its end of a container, without rounding."""
    x, u, mass = map(Fraction, wall)
    state, time, found = [list(map(Fraction, ball)) for ball in balls], Fraction(0), []
    while len(found) < count:
        coming = []
        for n, (side, (place, v, _)) in enumerate(zip((-1, 1), state, strict=True)):
            if side * (u - v) > 0:
                coming.append((side * (place - x) / (side * (u - v)), n, "wall"))
            if side * v > 0:
                end = Fraction(length if side > 0 else 0)
                coming.append(((end - place) / v, n, "end"))
        late, n, what = min(coming)
        time += late
        x += u * late
        for ball in state:
            ball[0] += ball[1] * late
        if what == "end":
            state[n][1] = -state[n][1]
            continue
        _, v, m = state[n]
        centre = (m * v + mass * u) / (m + mass)
        state[n][1], u = 2 * centre - v, 2 * centre - u
        found.append((float(time), n, float(x)))
    return found


@pytest.mark.interpreted
@pytest.mark.parametrize(("mass", "axis"), [(3.0, 0), (0.25, 0), (200.0, 1)])
def test_balls_and_a_wall_meet_as_computed_without_rounding(mass, axis):
    """A heavy and a light wall; balls of two masses, whose radius is within the ends of the container."""
    radius, length = 0.5, 12.0
    places, velocities, masses = (2.0, 9.5), (1.25, -0.75), (1.0, 2.0)
    along = [1, -1][axis]  # (of the wall, along it), or the other way round
    particles = [
        gp.Particle((place, 2.0)[::along], (velocity, 0.0)[::along], radius, mass=own)
        for place, velocity, own in zip(places, velocities, masses, strict=True)
    ]
    lengths, boundary = (length, 4.0)[::along], ("wall", "periodic")[::along]
    wall = across(5.5, 4.0, mass, axis)
    scene = gp.Scene(gp.Container(lengths, boundary), particles=particles, walls=[wall])
    sim = gp.Simulation(scene, EVENT)
    sim.record_events = True
    sim.advance(max_events=120)
    hits = sim.events["particles"][:, 1] == -1 - WALL_NUMBER
    balls = sim.events["particles"][hits, 0]
    centres = sim.events["positions"][hits, 0, axis]
    # points between ends that are a diameter nearer, with the wall a radius nearer to each
    points = list(zip((places[0] - radius, places[1] - 3 * radius), velocities, masses, strict=True))
    known = meetings((5.5 - 2 * radius, 0.0, mass), points, length - 4 * radius, 40)
    assert len(balls) >= 40
    for n, (time, ball, place) in enumerate(known):
        assert sim.events["time"][hits][n] == pytest.approx(time, abs=1e-9)
        assert balls[n] == ball
        assert centres[n] == pytest.approx(place + (3 * radius if ball else radius), abs=1e-9)


@pytest.mark.interpreted
def test_time_runs_backwards():
    """Rounding grows by collisions, of which each particle has a few."""
    scene = divided(mass=5.0)
    there = gp.Simulation(scene, EVENT, seed=2)
    there.advance(until=1.5)
    turned = there.state.copy()
    turned.velocities, turned.piston[1] = -turned.velocities, -turned.piston[1]
    back = gp.Simulation(scene, EVENT, initial=turned)
    back.advance(until=1.5)
    assert there.tally.wall_hits[WALL_NUMBER] > 5
    assert back.state.piston == pytest.approx([8.0, 0.0], abs=1e-8)
    lengths, apart = np.array(scene.container.lengths), back.state.positions - there.initial_state.positions
    assert np.abs(apart - lengths * np.round(apart / lengths)).max() < 1e-8


@pytest.mark.thorough
def test_a_trajectory_has_its_motion_from_which_another_run_goes_on(tmp_path):
    scene = divided()
    gp.run(scene, EVENT, 3, 20.0, 0.5, tmp_path / "first.nc")
    whole = gp.Simulation(scene, EVENT, seed=3)
    whole.advance(until=20.0)
    with gp.open_trajectory(tmp_path / "first.nc") as run:
        assert run["piston_position"].values[0] == 8.0
        assert run["piston_position"].values[-1] == whole.state.piston[0]
        assert run["piston_velocity"].values[-1] == whole.state.piston[1]
    for name in ("flux", "temperature"):  # of a wall at rest, and in equilibrium, there is a theory
        assert f"{name}_theory" not in gp.measure(tmp_path / "first.nc", name), name
    assert scene.conserved_axes == (False, True)
    frame = last_state(tmp_path / "first.nc")
    assert np.array_equal(frame.piston, whole.state.piston)
    again = gp.Simulation(scene, EVENT, initial=frame)  # positions are those of single precision
    again.advance(duration=1.0)
    whole.advance(duration=1.0)
    assert again.state.piston == pytest.approx(whole.state.piston, abs=1e-4)
    exact = gp.Simulation(replace(scene, walls=[across(3.0, 6.0, 20.0)]), EVENT, initial=whole.state)
    assert np.array_equal(exact.state.piston, whole.state.piston)  # the state's, not the scene's


def excluded(width, height, diameter):
    """The integral of two points in width x height over all places in which they are no nearer than this."""
    a = (np.arange(4000) + 0.5) * (width / 4000)
    least = np.minimum(np.sqrt(np.clip(diameter**2 - a**2, 0.0, None)), height)
    return 4.0 * ((width - a) * 0.5 * (height - least) ** 2).sum() * (width / 4000)


@pytest.mark.thorough
def test_its_place_has_the_distribution_of_statistical_mechanics():
    """Two discs on one side and one on the other: the energy is all kinetic, so that each place counts by the
    room that it leaves to the centres, Z_2(x) (L - x - 2 r). Runs of 24 seeds give the error."""
    length, width, radius, mass = 8.0, 3.0, 0.5, 1.5
    container = gp.Container((length, width), "wall")
    wall = across(4.0, width, mass)
    left = gp.Species(2, radius, temperature=1.0, region=((0.0, 0.0), (4.0, width)))
    right = gp.Species(1, radius, temperature=1.0, region=((4.0, 0.0), (length, width)))
    scene = gp.Scene(container, [left, right], walls=[wall])
    places = np.linspace(2 * radius, length - 2 * radius, 401)[1:-1]
    room = [excluded(x - 2 * radius, width - 2 * radius, 2 * radius) for x in places]
    weights = np.array(room) * (length - places - 2 * radius)
    weights /= weights.sum()
    expected = np.array([weights @ places**power for power in (1, 2, 3)])
    means = []
    for seed in range(24):
        sim = gp.Simulation(scene, EVENT, seed=seed)
        sim.advance(until=20.0)
        values = []
        for _ in range(1500):
            sim.advance(duration=1.75)
            values.append(sim.state.piston[0])
        means.append([np.mean(np.array(values) ** power) for power in (1, 2, 3)])
    errors = np.std(means, axis=0, ddof=1) / math.sqrt(len(means))
    assert (errors < 0.01 * expected).all()
    assert (np.abs(np.mean(means, axis=0) - expected) < 3.5 * errors).all()
    ideal = ((length - 2.0) * 3 / 5 + 1.0) - expected[0]  # of points p ~ x^2 (L - x)
    assert abs(ideal) > 10 * errors[0]


@pytest.mark.thorough
def test_a_heavy_wall_begins_to_move_by_the_difference_of_the_pressures():
    """Of points, n k_B T (P = 4 and 1): the momentum M u after a time t is (P_1 - P_2) A t, whose scatter is
    known: m^2 (2 v)^2 of each hit, 4 m n A t <|v|^3>, with the distribution of the normal velocity."""
    scene = divided((400, 4.0), (400, 1.0), mass=1e7, lengths=(20.0, 10.0), place=10.0, radius=1e-3)
    time, runs, pressures = 0.5, 120, np.array([4.0 * 4.0, 4.0 * 1.0])
    gained = []
    for seed in range(runs):
        sim = gp.Simulation(scene, EVENT, seed=seed)
        sim.advance(until=time)
        gained.append(1e7 * sim.state.piston[1])
    moved = (pressures[0] - pressures[1]) * 10.0 * time
    temperatures = np.array([4.0, 1.0])
    variance = (4.0 * 4.0 * 10.0 * time * np.sqrt(2.0 / math.pi) * temperatures**1.5).sum()
    variance -= ((pressures * 10.0 * time) ** 2 / 400).sum()  # their number is fixed
    assert abs(np.mean(gained) - moved) < 3.0 * math.sqrt(variance / runs)
    assert math.sqrt(variance / runs) < 0.05 * moved
    assert np.var(gained, ddof=1) == pytest.approx(variance, rel=4.0 * math.sqrt(2.0 / runs))


@pytest.mark.thorough
def test_a_wall_drifts_to_the_hot_gas_although_the_pressures_are_equal():
    """Points, P = 4 on both sides, T = 4 and 1, and ends so far that nothing comes back from them. From the
    force on a wall of velocity V, A P - gamma_1 V + m n_1 A V^2 + ..., and that of the other side follow, in
    first order of m / M, <V^2> = sqrt(T_1 T_2) / M and the mean sqrt(2 pi m) / (4 M) (sqrt(T_2) - sqrt(T_1))
    (Gruber & Piasecki, Physica A 268, 412 (1999)). From rest, this takes M / (gamma_1 + gamma_2), and <V^2>,
    on which it depends, half of that."""
    mass, width, lengths, time, runs = 20.0, 100.0, (90.0, 50.0), 21.0, 1600
    linear, temperatures = np.array([2.0, 8.0]), np.array([4.0, 1.0])  # particles per length of the container
    counts = np.round(linear * lengths).astype(int).tolist()
    scene = divided((counts[0], 4.0), (counts[1], 1.0), mass, (sum(lengths), width), lengths[0], 5e-3)
    moved, squares = [], []
    for seed in range(runs):
        sim = gp.Simulation(scene, gp.EventDriven(boxes_per_side=1), seed=seed)
        sim.advance(until=time)
        place, velocity = sim.state.piston
        moved.append(place - lengths[0])
        squares.append(velocity**2)
    relaxation = mass / (4.0 * linear * np.sqrt(temperatures / (2.0 * math.pi))).sum()
    drift = math.sqrt(2.0 * math.pi) / (4.0 * mass) * (1.0 - 2.0)
    error, spread = np.std(moved) / math.sqrt(runs), np.std(squares) / math.sqrt(runs)
    assert error < 0.1 * abs(drift) * time
    assert abs(np.mean(moved) - drift * (time - 1.5 * relaxation)) < 3.0 * error
    assert abs(np.mean(squares) - 2.0 / mass) < 3.0 * spread


@pytest.mark.interpreted
def test_what_a_wall_that_moves_does_not_go_with_is_refused():
    scene = divided()
    (wall,) = scene.walls
    for walls, rule in (
        ([wall, gp.Wall((1.0, 1.0), (2.0, 1.0))], "must be the only interior wall"),
        ([replace(wall, temperature=1.0)], "excludes a temperature"),
        ([gp.Wall((8.0, 0.0), (8.5, 6.0), mass=1.0)], "must reach across the whole container"),
        ([across(3.0, 16.0, 1.0, axis=1)], "needs walls across y"),
    ):
        with pytest.raises(gp.SceneError, match=rf"walls\[\d\].mass.*{rule}"):
            replace(scene, walls=walls)
    for key, value in (
        ("gravity", (-1.0, 0.0)),
        ("restitution", gp.Restitution(1.0, 0.5)),
        ("thermostat", gp.Thermostat(1.0, 0.1)),
        ("faces", {"x_low": gp.Vibrating(0.1, 1.0)}),
        ("faces", {"x_low": gp.Piston(1.0, 1.0)}),
        ("faces", {"x_low": gp.Sticky(0.1)}),
        ("particles", [gp.Particle((1.0, 1.0), (0.0, 0.0), 0.1, fixed=True)]),
    ):
        with pytest.raises(gp.SceneError, match="excludes (an interior wall that|piston faces)"):
            replace(scene, **{key: value})
    with pytest.raises(gp.SceneError, match=r"walls\[0\].mass = 20.0: .* needs particles on both sides"):
        gp.Simulation(divided(right=(0, 1.0)), EVENT)


@pytest.mark.interpreted
def test_a_given_state_must_have_the_same_piston():
    scene = divided()
    state = gp.Simulation(scene, EVENT, seed=1).initial_state
    with pytest.raises(gp.SceneError, match=r"is the face that is the piston, walls\[0\] in the scene"):
        gp.Simulation(scene, EVENT, initial=replace(state, piston_face="x_high"))
    nearest = state.positions[state.positions[:, 0] < 8.0, 0].max()
    touching = replace(state, piston=np.array([nearest + 0.4 - 4e-7, 0.0]))  # as in single precision
    placed = gp.Simulation(scene, EVENT, initial=touching).initial_state
    assert placed.positions[placed.positions[:, 0] < 8.0, 0].max() == pytest.approx(nearest - 4e-7, abs=1e-12)
    with pytest.raises(gp.SceneError, match="is not inside the container, or beyond the piston at"):
        gp.Simulation(scene, EVENT, initial=replace(state, piston=np.array([nearest + 0.2, 0.0])))
    with pytest.raises(gp.SceneError, match="must be a position from 0 to 16 and a velocity"):
        gp.Simulation(scene, EVENT, initial=replace(state, piston=np.array([17.0, 0.0])))
