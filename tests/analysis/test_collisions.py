"""The data set of collisions: rows that follow from one another, and what kinetic theory says of them."""

from dataclasses import replace
from time import sleep

import numpy as np
import pytest
import xarray as xr
from scenes import gas
from scipy import stats

import gaspart as gp
from gaspart import theory
from gaspart.analysis.collisions import COMPLETE, record_collisions
from gaspart.analysis.lyapunov import Deviation, follow
from gaspart.errors import SceneError


@pytest.mark.parametrize("boundary", ["periodic", "wall"])
def test_rows_agree_with_the_events(boundary):
    scene = gas(2, 20, 0.2, boundary)
    data = gp.collision_data(scene, 200, seed=3)
    assert data.sizes["collision"] >= 200
    assert np.all(data["approach"] > 0.0)
    assert np.all(data["approach"] <= data["relative_speed"] * (1 + 1e-12))
    assert np.allclose((data["normal"] ** 2).sum("axis"), 1.0)
    sim = gp.Simulation(scene, gp.EventDriven(), seed=3)
    sim.record_events = True
    sim.advance(until=float(data["time"][-1]))
    times, particles = sim.events["time"], sim.events["particles"]
    last, speeds, flown = dict.fromkeys(range(20), np.nan), sim.initial_state.speeds, 0.0
    expected = []
    for time, pair, after in zip(times, particles, sim.events["velocities"], strict=True):
        if pair[1] >= 0:
            expected.append([time - last[particle] for particle in pair])
        for particle, velocity in zip(pair, after, strict=True):
            if particle >= 0:
                flown += speeds[particle] * (time - np.nan_to_num(last[particle]))
                last[particle], speeds[particle] = time, np.hypot(*velocity)
    flown += sum(speeds[n] * (times[-1] - np.nan_to_num(last[n])) for n in range(20))
    assert data.mean_free_path == pytest.approx(flown / (2.0 * len(expected)), rel=1e-12)
    assert np.array_equal(data["free_time"], np.array(expected), equal_nan=True)
    assert np.array_equal(data["particles"], particles[particles[:, 1] >= 0])


@pytest.fixture(scope="module", params=[2, 3])
def data(request):
    return gp.collision_data(gas(request.param, 200, 0.2), 30_000, seed=5, equilibration=5.0)


def test_the_contact_value_is_that_of_theory(data):
    dimension = data.sizes["axis"]
    chi = gp.contact_value(data)
    finite = theory.collision_rate_finite_size_factor(0.2, dimension, 200)
    assert chi.error < 0.01 * chi.value
    assert abs(chi.value - float(theory.contact_value(0.2, dimension)) * float(finite)) < 3 * chi.error


def test_invalid_input_is_refused():
    with pytest.raises(gp.SceneError, match="gravity"):
        gp.collision_data(gp.Scene(gp.Container((9.0, 9.0)), gravity=(0.0, -1.0)), 10)
    with pytest.raises(gp.SceneError, match="collisions = 0"):
        gp.collision_data(gas(2, 20, 0.2), 0)
    with pytest.raises(gp.SimulationError, match="no event"):
        gp.collision_data(gp.Scene(gp.Container((9.0, 9.0), "periodic"), [gp.Species(2, 0.5)]), 10)
    mixed = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(5, r, speed=1.0) for r in (0.3, 0.5)])
    with pytest.raises(gp.SceneError, match="equal particles"):
        gp.contact_value(gp.collision_data(mixed, 50))


def test_a_file_written_a_second_later_has_the_same_bytes(tmp_path):
    data = record_collisions(gas(2, 20, 0.2), tmp_path / "one.nc", 100, seed=3)
    sleep(1.01)  # formats store seconds
    record_collisions(gas(2, 20, 0.2), tmp_path / "other.nc", 100, seed=3)
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "other.nc").read_bytes()
    with xr.open_dataset(tmp_path / "one.nc") as read:
        xr.testing.assert_identical(read.load(), data)


# Free flights of recorded events: against a count by hand, and against theory.


def recorded(scene, collisions, seed=1):
    """A simulation with so many recorded collisions per particle, after some that are not."""
    sim = gp.Simulation(scene, gp.EventDriven(), seed)
    sim.advance(max_events=5 * scene.count)
    sim.record_events = True
    sim.advance(max_events=int(0.5 * collisions * scene.count))
    return sim


def test_flights_are_those_counted_by_hand():
    sim = recorded(gas(2, 20, 0.2), 80)
    found = gp.analysis.free_flight_times(sim, bins=10)
    events, last, flights = sim.events, {}, []
    for time, pair, velocities in zip(events["time"], events["particles"], events["velocities"], strict=True):
        for particle, velocity in zip(pair.tolist(), velocities, strict=True):
            if particle in last:
                begun, speed = last[particle]
                flights.append((begun, particle % 16, time - begun, speed * (time - begun)))
            last[particle] = time, np.linalg.norm(velocity)
    mean = (sim.time - events["time"][0]) * 20 / (2 * len(events["time"]))
    flights = np.array([flight for flight in flights if flight[0] < sim.time - COMPLETE * mean])
    assert float(found["mean_free_time"]) == pytest.approx(flights[:, 2].mean())  # not of each particle
    assert float(found["mean_free_path"]) == pytest.approx(flights[:, 3].mean())
    density = np.histogram(flights[:, 2], 10, (0, 5 * mean))[0] / len(flights)
    assert np.allclose(found.estimate, density / (0.5 * mean))
    filled = density > 0.0
    freedom = found["free_flight_times_freedom"].values
    groups = [
        {flight[1] for flight in flights if 0 <= flight[2] - n * 0.5 * mean < 0.5 * mean} for n in range(10)
    ]
    counted = np.array([len(group) - 1.0 for group in groups])
    assert np.array_equal(freedom[filled], np.where(counted >= 2.0, counted, np.nan)[filled], equal_nan=True)
    assert np.isnan(freedom[~filled]).all()


@pytest.mark.parametrize(("dimension", "eta"), [(2, 0.02), (3, 0.002), (3, 0.01)])
def test_a_dilute_gas_flies_as_theory_says(dimension, eta):
    """In a dense gas consecutive collisions are not independent, and short flights rarer than in theory."""
    found = gp.analysis.free_flight_times(recorded(gas(dimension, 1000, eta), 150))
    judged = found.estimate.values * found["mean_free_time"].values > 0.02  # enough in each group
    chi_square = _chi_square(found, judged)
    assert stats.chi2.sf(chi_square, judged.sum()) > 1e-3
    for name in ("mean_free_time", "mean_free_path"):
        error = float(found[f"{name}_error"])
        assert error < 0.01 * float(found[name])
        assert abs(float(found[name] - found[f"{name}_theory"])) < 4.0 * error


def _chi_square(found, judged):
    """Of Student's deviations with 15 degrees of freedom, as Gaussian ones of the same probability."""
    t = ((found.estimate - found.theory) / found.error).values[judged]
    return float((stats.norm.isf(stats.t.sf(np.abs(t), 15)) ** 2).sum())


def test_what_has_no_free_flights_is_refused():
    sim = gp.Simulation(gas(2, 20, 0.2), gp.EventDriven())
    with pytest.raises(gp.SceneError, match="set record_events to True"):
        gp.analysis.free_flight_times(sim)
    with pytest.raises(gp.SceneError, match="must be 32 collisions of a particle or more"):
        gp.analysis.free_flight_times(recorded(gas(2, 20, 0.2), 20))
    with pytest.raises(gp.SceneError, match="has walls, which end flights"):
        gp.analysis.free_flight_times(recorded(gas(2, 20, 0.2, "wall"), 80))
    with pytest.raises(gp.SceneError, match="needs 16 moving particles"):
        gp.analysis.free_flight_times(recorded(gas(2, 10, 0.2), 80))


# The tangent map against runs that start a little apart, the exponent against an independent program's.


SPECIES = (gp.Species(12, 0.5, mass=1.0, temperature=1.0), gp.Species(6, 0.3, mass=4.0, temperature=1.0))


@pytest.mark.thorough
@pytest.mark.parametrize(
    "container",
    [
        gp.Container((7.0, 8.0), "wall"),
        gp.Container((7.0, 8.0), "periodic"),
        gp.Container((4.5, 4.0, 5.0), ("wall", "periodic", "wall")),
    ],
    ids=["discs between walls", "periodic discs", "spheres"],
)
def test_a_deviation_is_the_difference_of_two_runs_over_their_first_distance(container):
    """Of two sizes and masses. The difference of runs 2 h apart about the first is right to order h^2."""
    scene = gp.Scene(container, species=SPECIES)
    run = gp.Simulation(scene, gp.EventDriven(), seed=3)
    run.record_events = True
    start = run.state
    run.advance(duration=1.2)
    assert run.tally.collisions > 8
    rng = np.random.default_rng(1)
    shift, push = rng.standard_normal((2, *start.positions.shape))
    deviation = Deviation(shift, push, 0.0)
    follow(deviation, scene, start.masses, run.events)
    for n in range(start.count):
        deviation.advance(n, 1.2)
    h, ends = 1e-7, []
    for sign in (1.0, -1.0):
        moved = replace(
            start, positions=start.positions + sign * h * shift, velocities=start.velocities + sign * h * push
        )
        beside = gp.EventDriven().start(scene, moved)
        beside.advance(1.2)
        assert beside.tally.collisions == run.tally.collisions
        ends.append(beside.state)
    lengths = np.array(container.lengths)
    apart = ends[0].positions - ends[1].positions
    apart -= np.where(container.periodic, lengths * np.rint(apart / lengths), 0.0)
    scale = np.abs(deviation.positions).max()
    assert np.array(deviation.positions) == pytest.approx(apart / (2.0 * h), abs=1e-4 * scale)
    faster = (ends[0].velocities - ends[1].velocities) / (2.0 * h)
    assert np.array(deviation.velocities) == pytest.approx(faster, abs=1e-4 * np.abs(faster).max())


def test_the_exponent_of_discs_is_that_of_an_independent_program():
    """2.760(9) per collision of a particle: 100 discs at 0.1 between walls, tangent dynamics of a session."""
    side = np.sqrt(100 * np.pi / 4.0 / 0.1)
    scene = gp.Scene(gp.Container((side, side), "wall"), species=[gp.Species(100, 0.5, temperature=1.0)])
    found = []
    for seed in range(6):
        run = gp.Simulation(scene, gp.EventDriven(), seed=seed)
        run.advance(duration=20.0)
        run.reset_tally()
        run.record_events = True
        run.advance(duration=150.0)
        exponent = gp.analysis.lyapunov_exponent(run)
        rate = 2.0 * run.tally.collisions / (100 * run.tally.time)
        assert 0.0 < float(exponent.error) < 0.1 * float(exponent.estimate)
        found.append(float(exponent.estimate) / rate)
    error = np.std(found, ddof=1) / np.sqrt(6)
    assert error < 0.04
    assert np.mean(found) == pytest.approx(2.760, abs=4.0 * np.hypot(error, 0.009))


def test_a_long_run_of_a_dilute_gas_does_not_overflow():
    """The deviation grows by exp(13) in a collision of each sphere: beyond the range of numbers within 60."""
    side = (60 * np.pi / 6.0 / 0.001) ** (1.0 / 3.0)
    scene = gp.Scene(gp.Container((side,) * 3), species=[gp.Species(60, 0.5, temperature=1.0)])
    run = gp.Simulation(scene, gp.EventDriven(), seed=1)
    run.record_events = True
    run.advance(duration=25_000.0)
    assert run.tally.collisions > 100 * 60
    per_collision = 60 * run.time / (2.0 * run.tally.collisions)
    exponent = gp.analysis.lyapunov_exponent(run, start=0.6 * run.time)
    assert float(exponent.estimate) * per_collision == pytest.approx(13.0, abs=2.5)


def test_what_has_no_exponent_is_refused():
    scene = gp.Scene(gp.Container((9.0, 9.0)), species=[gp.Species(9, 0.5, temperature=1.0)])
    run = gp.Simulation(scene, gp.EventDriven())
    with pytest.raises(SceneError, match="record_events"):
        gp.analysis.lyapunov_exponent(run)
    run.record_events = True
    with pytest.raises(SceneError, match="events = 0: must be at least"):
        gp.analysis.lyapunov_exponent(run)
    inelastic = gp.Simulation(replace(scene, restitution=gp.Restitution(0.9)), gp.EventDriven())
    with pytest.raises(SceneError, match="restitution.*smooth elastic contacts"):
        gp.analysis.lyapunov_exponent(inelastic)
