"""Open faces: effusion, the grand-canonical ensemble, and flow between reservoirs, exactly."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from referee import WORK, check_same
from scenes import opened

import gaspart as gp
from gaspart import theory
from gaspart.errors import SceneError, SimulationError

LENGTHS = (8.0, 4.0, 4.0)
POINT = 1e-3
"""A radius with which hardly any particles collide."""
PERIODIC = ("wall", "periodic", "periodic")
ENGINES = {
    "event": gp.EventDriven(),
    "dsmc": gp.DSMC(time_step=0.5, cells_per_side=(2, 1, 1), adapt="nothing"),
}
"""Engines that model open faces. The particles of some tests never collide."""
in_both = pytest.mark.parametrize("engine", ENGINES.values(), ids=ENGINES)


def reservoir(density, temperature=1.0, radius=POINT):
    """A face open to an ideal gas of particles of this radius."""
    return gp.Open(density * 4.0 / 3.0 * math.pi * radius**3, temperature)


def slit(faces, count=100, radius=POINT, temperature=1.0, lengths=LENGTHS, **more):
    species = [gp.Species(count, radius, temperature=temperature, **more)]
    return gp.Scene(gp.Container(lengths, PERIODIC), species, faces=faces, centres_to_walls=True)


def blocks(simulation, number, duration, samples):
    """(number, samples) particles inside at even times, and the tally of each of these blocks."""
    counts, tallies = [], []
    for _ in range(number):
        simulation.reset_tally()
        row = []
        for _ in range(samples):
            simulation.advance(duration=duration / samples)
            row.append(simulation.state.count)
        counts.append(row)
        tallies.append(simulation.tally)
    simulation.check_invariants()
    return np.array(counts), tallies


def agrees(values, expected, least):
    """Whether the mean of blocks (K,) is `expected` within 3 errors, each at most a part `least` of it."""
    error = np.std(values, ddof=1) / math.sqrt(len(values))
    assert error < least * abs(expected)
    return abs(np.mean(values) - expected) < 3.0 * error


@pytest.mark.thorough
@in_both
def test_effusion_into_a_vacuum(engine):
    """Behind the mirror at the far end stands its image: a free particle leaves once it has gone a way that
    is evenly spread over 2L at the start, at a speed |v| of a normal distribution. The number of those that
    stay is binomial."""
    count = 4000
    simulation = gp.Simulation(slit({"x_low": gp.Open()}, count), engine, seed=1)
    for time in (2.0, 8.0, 32.0, 128.0):
        simulation.advance(until=time)
        a = 2.0 * LENGTHS[0] / time
        stays = math.erf(a / math.sqrt(2.0)) - math.sqrt(2.0 / math.pi) / a * -math.expm1(-0.5 * a * a)
        spread = math.sqrt(count * stays * (1.0 - stays))
        assert simulation.state.count == pytest.approx(count * stays, abs=3.0 * spread)
        assert simulation.state.count == count - simulation.tally.wall_hits[0]
    simulation.check_invariants()


@cache
def ideal(engine):
    """(40, 20) numbers of an ideal gas with the reservoirs of one gas at both ends, and tallies."""
    density = 1.5
    faces = {"x_low": reservoir(density), "x_high": reservoir(density)}
    simulation = gp.Simulation(slit(faces, 150), engine, seed=3)
    simulation.advance(duration=50.0)
    return density * math.prod(LENGTHS), *blocks(simulation, 40, 200.0, 20)


@pytest.mark.thorough
@in_both
def test_an_ideal_gas_has_the_distribution_of_poisson(engine):
    expected, counts, _ = ideal(engine)
    assert agrees(counts.mean(axis=1), expected, 0.005)
    assert agrees(((counts - expected) ** 2).mean(axis=1), expected, 0.08)
    third = ((counts - expected) ** 3).mean(axis=1)
    assert abs(third.mean() - expected) < 3.0 * third.std(ddof=1) / math.sqrt(len(third))


@pytest.mark.thorough
@in_both
def test_as_many_enter_as_kinetic_theory_has_it(engine):
    """n (k_B T / 2 pi m)^(1/2) per area, in and out; momentum and energy as from a gas in equilibrium."""
    expected, _, tallies = ideal(engine)
    density, area = expected / math.prod(LENGTHS), LENGTHS[1] * LENGTHS[2]
    for face in (0, 1):
        each = density * area * math.sqrt(0.5 / math.pi)
        assert agrees([tally.entries[face] / tally.time for tally in tallies], each, 0.005)
        assert agrees([tally.wall_hits[face] / tally.time for tally in tallies], each, 0.005)
        assert agrees([tally.wall_impulse[face] / tally.time for tally in tallies], density * area, 0.005)
    heat = [tally.wall_energy[:2].sum() for tally in tallies]
    assert abs(np.mean(heat)) < 3.0 * np.std(heat, ddof=1) / math.sqrt(len(heat))


@pytest.mark.thorough
@in_both
def test_flow_between_two_reservoirs_without_collisions(engine):
    """(z_1 T_1^(1/2) - z_2 T_2^(1/2)) / (2 pi m)^(1/2) of particles, and 2 k_B T of energy with each."""
    dense, thin = (2.0, 1.0), (0.5, 4.0)
    faces = {"x_low": reservoir(*dense), "x_high": reservoir(*thin)}
    simulation = gp.Simulation(slit(faces), engine, seed=4)
    simulation.advance(duration=100.0)
    _, tallies = blocks(simulation, 40, 100.0, 1)
    area = LENGTHS[1] * LENGTHS[2]
    one, other = (z * math.sqrt(t / (2.0 * math.pi)) * area for z, t in (dense, thin))
    for face, sign in ((0, 1.0), (1, -1.0)):
        net = [sign * (tally.entries[face] - tally.wall_hits[face]) / tally.time for tally in tallies]
        assert agrees(net, one - other, 0.02)
    heat = [-tally.wall_energy[0] / tally.time for tally in tallies]
    assert agrees(heat, 2.0 * (one * dense[1] - other * thin[1]), 0.05)


CHANNELS = {
    "gradient": gp.Thermal({"x_low": 4.0, "x_high": 1.0}),
    "partial": gp.Thermal(3.0, accommodation=0.6),
}


@pytest.mark.thorough
@in_both
@pytest.mark.parametrize("wall", CHANNELS)
def test_no_net_flow_between_reservoirs_that_send_equally_many(wall, engine):
    """z sqrt(T) is equal on both sides: without collisions as many pass each way, whatever the walls."""
    faces = {"x_low": reservoir(0.5, 4.0), "x_high": reservoir(1.0, 1.0), "y_low": CHANNELS[wall]}
    container = gp.Container(LENGTHS, ("wall", "wall", "periodic"))
    species = [gp.Species(80, POINT, temperature=2.0)]
    scene = gp.Scene(container, species, faces=faces, centres_to_walls=True)
    simulation = gp.Simulation(scene, engine, seed=11)
    simulation.advance(duration=100.0)
    _, tallies = blocks(simulation, 40, 50.0, 1)
    each = 0.5 * math.sqrt(4.0 / (2.0 * math.pi)) * LENGTHS[1] * LENGTHS[2]
    for face, sign in ((0, 1.0), (1, -1.0)):
        assert agrees([tally.entries[face] / tally.time for tally in tallies], each, 0.01)
        net = [sign * (tally.entries[face] - tally.wall_hits[face]) / tally.time for tally in tallies]
        error = np.std(net, ddof=1) / math.sqrt(len(net))
        assert abs(np.mean(net)) < 3.0 * error < 0.05 * each
    heat = [-tally.wall_energy[0] / tally.time for tally in tallies]  # but hot ones pass to the cold side
    assert np.mean(heat) > 10.0 * np.std(heat, ddof=1) / math.sqrt(len(heat))


TWO = dict.fromkeys(("x_low", "y_high"), gp.Open(2.0 * math.pi / 4.0, 1.0))
ONE = [gp.Species(1, 0.5, temperature=1.0)]
FEW = gp.Scene(gp.Container((1.5, 0.5)), ONE, faces=TWO, centres_to_walls=True)
"""Room for the centres of two discs at most, and two reservoirs of z = 2."""


@pytest.mark.thorough
@pytest.mark.parametrize("search", ["boxes", "pairs"])
def test_two_discs_at_most(search):
    """P(N) is proportional to z^N Q_N: Q_1 the area for a centre, Q_2 half that for two centres a diameter
    apart or more, an integral over their separation."""
    x, y = (np.linspace(-side, side, 4001) for side in FEW.container.lengths)
    room = (1.5 - abs(x))[:, None] * (0.5 - abs(y)) * (np.hypot(x[:, None], y) > 1.0)
    two = 0.5 * room.sum() * (x[1] - x[0]) * (y[1] - y[0])
    weights = np.array([1.0, 2.0 * 0.75, 4.0 * two])
    simulation = gp.Simulation(FEW, gp.EventDriven(search), seed=5)
    counts, tallies = blocks(simulation, 40, 200.0 if search == "boxes" else 40.0, 100)
    for number, expected in enumerate(weights / weights.sum()):
        part = (counts == number).mean(axis=1)
        assert abs(part.mean() - expected) < 3.0 * part.std(ddof=1) / math.sqrt(len(part))
        assert expected > 0.02
    assert counts.max() == 2 and sum(tally.collisions for tally in tallies) > 100


@pytest.mark.thorough
def test_a_moderately_dense_gas_is_that_of_the_reservoir():
    """In the middle of a slit the density is that of the reservoir, by the equation of state; on the open
    face and on the hard one the momentum is its pressure, as the contact theorem has it."""
    eta, radius, lengths = 0.15, 0.5, (9.0, 5.0, 5.0)
    faces = {"x_low": gp.Open(float(theory.activity(eta, 3)), 1.0)}
    scene = slit(faces, 60, radius, lengths=lengths)
    simulation = gp.Simulation(scene, seed=6)
    simulation.advance(duration=50.0)
    middle, pressures = [], []
    for _ in range(40):
        simulation.reset_tally()
        inside = 0
        for _ in range(80):
            simulation.advance(duration=1.0)
            places = simulation.state.positions[:, 0]
            inside += np.count_nonzero(abs(places - 4.5) < 1.5) / 80
        middle.append(inside / (3.0 * 25.0))
        pressures.append(simulation.tally.wall_impulse[:2] / (25.0 * simulation.tally.time))
    simulation.check_invariants()
    density = eta / (math.pi / 6.0)
    pressure = density * float(theory.compressibility_factor(eta, 3))
    assert agrees(middle, density, 0.01)
    for face in (0, 1):
        assert agrees(np.array(pressures)[:, face], pressure, 0.02)
    assert abs(density - float(theory.activity(eta, 3)) / (math.pi / 6.0)) > 0.2 * density


MIXED = {"x_low": gp.Open(0.3, 2.0), "x_high": gp.Open(0.1, 1.0)}
MIXED |= {"y_low": gp.Thermal(3.0), "y_high": gp.Open()}
DOZEN = [gp.Species(12, 0.5, mass=2.0, temperature=1.0)]
DISCS = gp.Scene(gp.Container((6.0, 6.0)), DOZEN, faces=MIXED, centres_to_walls=True)
"""Discs between two reservoirs, a vacuum and a thermal face."""


@pytest.mark.thorough
@given(opened(), st.integers(0, 1000))
@settings(max_examples=15)
def test_random_open_scenes_keep_their_books_and_bits(scene, seed):
    whole, parts = gp.Simulation(scene, seed=seed), gp.Simulation(scene, gp.EventDriven("pairs"), seed=seed)
    begun, opened = whole.state.energy, [n for n, _ in scene.faces_of(gp.Open)]
    whole.advance(max_events=400, until=50.0)
    parts.advance(max_events=150, until=50.0)
    other = gp.Simulation(scene, gp.EventDriven("direct"), seed=seed)
    other.restore(parts.checkpoint())
    other.advance(max_events=250, until=50.0)
    state, tally = whole.state, whole.tally
    check_same(whole, other, WORK)
    assert state.count == scene.count + tally.entries.sum() - tally.wall_hits[opened].sum()
    exchanged = np.abs(tally.wall_energy).sum() + begun
    assert state.energy + tally.wall_energy.sum() == pytest.approx(begun, abs=1e-12 * exchanged)
    assert state.count <= scene.capacity
    whole.check_invariants()


@pytest.mark.interpreted
def test_numbers_of_particles_are_those_of_the_lowest_free_places():
    simulation, before = gp.Simulation(DISCS, seed=10), 12
    assert DISCS.capacity > 12 and simulation.state.count == 12
    for state in simulation.replay("time", 1.0):
        assert len(state.velocities) == len(state.radii) == len(state.spins) == state.count
    while simulation.time < 20.0:
        simulation.advance(max_events=1)
        numbers = simulation.state.numbers
        assert (np.diff(numbers) > 0).all() and numbers.max(initial=0) < DISCS.capacity
    assert simulation.state.count < before or simulation.tally.entries.any()


@pytest.mark.interpreted
def test_an_empty_container_stays_empty():
    simulation = gp.Simulation(slit({"x_low": gp.Open(), "x_high": gp.Open()}, 5), seed=1)
    simulation.advance(duration=1e6)
    assert simulation.state.count == 0 and simulation.state.energy == 0.0
    simulation.check_invariants()
    simulation.advance(duration=1e6)
    assert simulation.tally.wall_hits[:2].sum() == 5 and simulation.time == 2e6


@pytest.mark.interpreted
def test_a_full_container_ends_the_run():
    """Which never happens: the room is taken away."""
    simulation = gp.Simulation(FEW, seed=1)
    simulation._dynamics._model.faces.open.present[1:] = 1
    simulation._dynamics._flights["position"][1:] = -50.0
    with pytest.raises(SimulationError, match="no room for more than"):
        simulation.advance(duration=1000.0)


@pytest.mark.thorough
def test_attempts_to_enter_are_events():
    """Of a reservoir that sends 7000 times as many particles as there is room for, nearly all are refused."""
    faces, species = {"x_low": gp.Open(2000.0, 1.0), "x_high": gp.Open()}, replace(DOZEN[0], mass=1.0)
    container = gp.Container((6.0, 6.0), ("wall", "periodic"))
    scene = gp.Scene(container, [species], faces=faces, centres_to_walls=True)
    simulation, parts = gp.Simulation(scene, seed=1), gp.Simulation(scene, gp.EventDriven("pairs"), seed=1)
    simulation.advance(max_events=20_000)
    attempts = simulation.time * 2000.0 / (0.25 * math.pi) * 6.0 / math.sqrt(2.0 * math.pi)
    tally = simulation.tally
    events = tally.collisions + tally.wall_hits.sum() + attempts
    assert events == pytest.approx(20_000, abs=5.0 * math.sqrt(20_000))
    assert 5 < tally.entries[0] < 0.1 * attempts
    for number in (1, 2, 6997, 13_000):
        parts.advance(max_events=number)
    check_same(simulation, parts, WORK)
    simulation.check_invariants()


@pytest.mark.thorough
def test_numbers_beyond_the_first_block_are_found():
    """Of a thousand numbers those of the first 256 are taken, then the lowest that is vacant."""
    from gaspart.kernels.model import Open
    from gaspart.kernels.obstacles.opening import NUMBERS, lowest_vacant

    present = np.ones(1000, dtype=np.uint8)
    opened = Open(present, np.zeros(4, dtype=np.int64), np.zeros(4, dtype=np.int64))
    assert lowest_vacant.py_func(opened) == -1
    for number in (999, 700, NUMBERS, NUMBERS - 1, 0):
        present[number] = 0
        opened.vacant[number // NUMBERS] += 1
        assert lowest_vacant.py_func(opened) == number


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        ({"centres_to_walls": False}, "faces.x_low.*needs centres_to_walls: true"),
        ({"gravity": (0.0, -1.0)}, "gravity.*excludes open faces.*nothing acts on the gas"),
        ({"restitution": gp.Restitution(0.9)}, "restitution.normal.*excludes open faces.*smooth and elastic"),
        ({"faces": MIXED | {"y_low": gp.Thermal(1.0, velocity=(1.0, 0.0))}}, "a thermal one is at rest"),
        ({"faces": MIXED | {"y_high": gp.Open(1e20, 1.0)}}, "y_high.activity = 1e.20: must let at most"),
        ({"thermostat": gp.Thermostat(1.0, 0.1)}, "thermostat.*excludes open faces"),
        ({"species": [gp.Species(2, 0.5), gp.Species(1, 0.4)]}, "particles of one species"),
        ({"species": [gp.Species(9, 0.5, polydispersity=0.1)]}, "polydispersity.*excludes open faces"),
        ({"species": [gp.Species(9, 0.5, fixed=True)]}, "fixed.*excludes open faces"),
        ({"particles": [gp.Particle((3.0, 3.0), (0.0, 0.0), 0.5)]}, "particles of one species"),
        ({"faces": MIXED | {"y_low": gp.Piston(1.0, 1.0)}}, "excludes.*the others are hard or thermal"),
        ({"container": gp.Container((6.0, 6.0), ("periodic", "wall"))}, "a periodic axis has no faces"),
    ],
)
def test_scenes_that_are_refused(changes, rule):
    with pytest.raises(gp.SceneError, match=rule):
        replace(DISCS, **changes)


@pytest.mark.interpreted
@pytest.mark.parametrize("settings", [{"activity": 0.1}, {"temperature": 1.0}])
def test_reservoirs_that_are_refused(settings):
    with pytest.raises(gp.SceneError, match="must be given together with activity"):
        gp.Open(**settings)


@pytest.mark.interpreted
def test_what_is_not_defined_of_changing_particles():
    simulation = gp.Simulation(DISCS, seed=1)
    simulation.advance(duration=1.0)
    with pytest.raises(gp.SceneError, match="events are not recorded"):
        simulation.record_events = True
    with pytest.raises(gp.SceneError, match="look at the states"):
        simulation.properties("positions", at=[0.0])
    for engine, able in (
        (gp.TimeStepped(0.01), '"event" or "dsmc" engine'),
        (gp.DSMC(0.1, 1, "enskog"), '"event" engine, or the "boltzmann" model'),
    ):
        with pytest.raises(gp.SceneError, match=f"faces.x_low.*needs the {able}"):
            gp.Simulation(DISCS, engine)
    with pytest.raises(gp.SceneError, match="neighbour lists do not support open faces"):
        gp.Simulation(DISCS, gp.EventDriven("lists"))


def times_of_leaving(positions, velocities):
    """When points leave a chamber of 10 x 10 through a slit from y = 4 to 6, and the vacuum face at x = 20;
    a point is at the slit's plane after every flight to the far wall and back."""
    times = []
    for (x, y), (v, w) in zip(positions, velocities, strict=True):
        time, period = (10.0 - x) / v if v > 0.0 else (10.0 + x) / -v, 20.0 / abs(v)
        arrivals = time + period * np.arange(1 + int(100.0 / period))
        heights = np.abs((y + w * arrivals + 10.0) % 20.0 - 10.0)  # mirrors at 0 and 10
        through = arrivals[(heights > 4.0) & (heights < 6.0)]
        times.append(through[0] + 10.0 / abs(v) if len(through) else np.inf)
    return np.array(times)


@pytest.mark.thorough
def test_interior_walls_stand_before_a_vacuum():
    """Points leave a chamber through a slit, each at its own time."""
    walls = [gp.Wall((10.0, 0.0), (10.0, 4.0)), gp.Wall((10.0, 6.0), (10.0, 10.0))]
    species = [gp.Species(200, 1e-9, temperature=1.0, region=((0.0, 0.0), (10.0, 10.0)))]
    scene = gp.Scene(gp.Container((20.0, 10.0)), species, walls=walls, faces={"x_high": gp.Open()})
    simulation = gp.Simulation(scene, seed=1)
    start = simulation.initial_state
    leaves = times_of_leaving(start.positions, start.velocities)
    for time in (5.0, 20.0, 50.0, 100.0):
        simulation.advance(until=time)
        assert simulation.state.count == (leaves > time).sum()
    assert simulation.state.count < 120


def test_a_reservoir_excludes_what_a_vacuum_allows():
    wall, container = gp.Wall((4.0, 0.0), (4.0, 4.0)), gp.Container((8.0, 8.0))
    species, face = [gp.Species(5, 0.1, temperature=1.0)], {"x_low": gp.Open(0.01, 1.0)}
    gp.Scene(container, species, walls=[wall], faces={"x_low": gp.Open()})
    with pytest.raises(SceneError, match=r"faces\.x_low\.activity = .*or no activity \(a vacuum\)"):
        gp.Scene(container, species, walls=[wall], faces=face)
    with pytest.raises(SceneError, match="excludes interior walls"):
        gp.Scene(container, species, walls=[wall], faces=face, centres_to_walls=True)


@pytest.mark.interpreted
@pytest.mark.parametrize("engine", [gp.EventDriven(), gp.DSMC(time_step=0.1)], ids=["event", "dsmc"])
def test_a_disc_leaves_when_its_surface_reaches_a_vacuum(engine):
    scene = gp.Scene(gp.Container((20.0, 10.0)), [gp.Species(1, 0.5, speed=1.0)], faces={"x_high": gp.Open()})
    simulation = gp.Simulation(scene, engine, seed=3)
    (x, _), (v, _) = simulation.initial_state.positions[0], simulation.initial_state.velocities[0]
    leaves = (19.5 - x) / v if v > 0.0 else (x - 0.5 + 19.0) / -v
    simulation.advance(until=leaves - 1e-6)
    assert simulation.state.count == 1
    simulation.advance(until=leaves + 0.2)
    assert simulation.state.count == 0
