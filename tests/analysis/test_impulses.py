"""Densities from impulses: exactly from exact momenta, mixed with counts, and as those of runs."""

import math
from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.impulses import MomentumFlux, mixture, numbers_by_impulses
from gaspart.analysis.run import open_run
from gaspart.cli.stated_run import run_options
from gaspart.state.tally import ImpulseTally
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import read_recipe

A = gp.analysis
RISE = np.random.default_rng(3)
COLUMN = gp.Scene(
    gp.Container((6.0, 6.0, 8.0), ("periodic", "periodic", "wall")),
    [gp.Species(20, 0.4, temperature=1.0)],
    gravity=(0.0, 0.0, -0.5),
)


@pytest.mark.parametrize(("pull", "walled"), [(0.0, True), (-1.3, True), (1.3, True), (0.0, False)])
def test_numbers_follow_exactly_from_the_momentum_of_a_known_density(pull, walled):
    """Of points in a temperature that rises along the axis; without walls the flux through the face is
    unknown."""
    places = np.sort(RISE.uniform(0.0, 4.0, 50))  # of particles, which stay there, with any <m v^2>
    bins, time, width = 8, np.array([0.5, 2.0]), 0.5
    spread = np.linspace(1.0, 2.0, bins)
    cells = (places / width).astype(int)
    number = np.bincount(cells, minlength=bins)
    above = np.bincount(cells, cells + 1.0 - places / width, minlength=bins) / number
    below = np.cumsum(number) - number + number * above  # the mean over the planes of each bin
    flux = time[:, None] * (number * spread / width - pull * below)
    face = 0.0 if walled else 7.0 * spread / width
    found = MomentumFlux(flux - face, time, 50, spread, above, number > 0, width, pull, walled).numbers()
    assert found == pytest.approx(time[:, None] * number, rel=1e-12)
    assert found.sum(axis=1) == pytest.approx(50.0 * time)


def test_weights_are_of_the_other_half_and_prefer_what_has_less_noise():
    noise = np.random.default_rng(1).standard_normal((4, 64, 40))
    counted, impulses = 1.0 + noise[0], 1.0 + 0.1 * noise[1]
    impulses[:, 20:] = 1.0 + 10.0 * noise[2, :, 20:]
    weights = mixture(counted, impulses, periodic=False)
    assert (weights[:, :18] > 0.95).all() and (weights[:, 22:] < 0.05).all()
    both = [np.concatenate([noise[3, :32], one[32:]]) for one in (counted, impulses)]
    changed = mixture(*both, periodic=False)
    turned = mixture(*(np.roll(one, 7, axis=1) for one in (counted, impulses)), periodic=True)
    round_ = mixture(counted, impulses, periodic=True)
    assert turned == pytest.approx(np.roll(round_, 7, axis=1), rel=1e-9)
    assert round_[:, 1:-1] == pytest.approx(weights[:, 1:-1], rel=1e-9)
    assert np.array_equal(changed[:32], weights[:32]) and not np.array_equal(changed[32:], weights[32:])


ENGINES = {"event": gp.EventDriven(), "step": gp.TimeStepped(2.0**-6)}


@pytest.fixture(scope="module", params=ENGINES)
def column(request, tmp_path_factory):
    """A thin column of spheres that fall, with its impulses."""
    path = tmp_path_factory.mktemp("column") / f"{request.param}.nc"
    return gp.run(COLUMN, ENGINES[request.param], 5, 600.0, 0.5, path, tallies=[gp.ImpulseTally("z", 80)])


def counted(run):
    """The same without its impulses."""
    return run.assign_attrs(tallies="[]")


def test_the_density_of_a_run_has_less_error_with_impulses(column):
    with open_trajectory(column) as run:
        found, other = A.profile(run), A.profile(counted(run), bins=80)
        row, other_bins = A.profile(run, bins=20), A.profile(run, bins=30)
        layers, plain_layers = (A.field(one, axes="z", cells=20) for one in (run, counted(run)))
        sideways = A.field(run, axes="x", cells=20)
    assert (found.attrs["estimator"], other.attrs["estimator"]) == ("counts and impulses", "counts")
    assert "--impulses z:200" in other.attrs["note"] and "note" not in found.attrs
    assert "kept in 80 bins, which 30 do not divide" in other_bins.attrs["note"]
    assert (
        layers.attrs["estimator"] == "counts and impulses" and (layers.estimate == row.estimate.values).all()
    )
    assert "--impulses z:200" in plain_layers.attrs["note"] and "--impulses x:200" in sideways.attrs["note"]
    inside = other.error > 0.0
    assert float(((other.error / found.error)[inside] ** 2).median()) > 15.0
    assert float(found.estimate.sum()) * 36.0 * 0.1 == pytest.approx(20.0)
    beyond = 1e-3 if column.stem == "step" else 0.0  # centres that a contact has moved, until the next step
    wide = found.estimate.values.reshape(20, 4).mean(axis=1)
    assert row.estimate.values == pytest.approx(wide, rel=0.05, abs=beyond * wide.max())
    assert (found.estimate[[*range(4), *range(-4, 0)]] <= beyond * wide.max()).all()
    assert not (found.error[-4:] > beyond * wide.max()).any()


@pytest.mark.parametrize("bins", [16, 80])
def test_counts_and_impulses_agree(column, bins):
    with open_trajectory(column) as data, open_run(data, 120.0) as run:
        found = numbers_by_impulses(run, 2, bins, None)
        places = run.positions[1:, :, 2]
    counts = np.stack([np.histogram(frame, bins, (0.0, 8.0))[0] for frame in places])
    apart = (counts - found / 0.5).reshape(32, -1, bins).mean(axis=1)
    filled = counts.sum(axis=0) > 200
    apart = apart[:, filled]
    z = apart.mean(axis=0) / apart.std(axis=0, ddof=1) * math.sqrt(32.0)
    assert abs(math.sqrt((z**2).mean()) - 1.0) < 3.0 / math.sqrt(2.0 * z.size) + 0.04


def test_the_density_at_the_floor_is_the_pressure_on_it(column):
    """The contact theorem, at which counts need narrow bins: the wall carries all momentum of the lowest
    particles."""
    with open_trajectory(column) as run:
        found = A.profile(run, bins=80, start=150.0)
        part = run.isel(frame=run["time"].values >= 150.0)
        pressure = float(np.diff(part["wall_impulse"].isel(face=4).values[[0, -1]])[0] / 450.0 / 36.0)
        temperature = 2.0 * float(part["kinetic_energy"].mean()) / (3.0 * 20.0 - 2.0)
    lowest = found.isel(position=4)
    assert lowest.position == pytest.approx(0.45)
    expected = pressure / temperature * (1.0 - 0.5 * 0.05 / temperature)  # in the middle of its bin, nearly
    assert float(lowest.estimate) == pytest.approx(expected, rel=0.03)


def test_along_a_periodic_axis_a_gas_is_uniform_in_a_moving_frame_too():
    start = gp.Simulation(COLUMN, gp.EventDriven(), 2).initial_state
    initial = replace(start, velocities=start.velocities + np.array([1.5, 0.0, 0.0]))
    asked = [ImpulseTally("x", 12)]
    simulation = gp.Simulation(COLUMN, gp.EventDriven(), 2, initial=initial, tallies=asked)
    simulation.advance(until=200.0)
    found = A.profile(simulation, axis="x")
    assert found.attrs["estimator"] == "counts and impulses" and found.sizes["position"] == 12
    apart = (found.estimate - 20.0 / 288.0) / found.error
    assert abs(float((apart**2).mean()) - 1.0) < 3.0 * math.sqrt(2.0 / 12.0) + 0.2


@pytest.mark.parametrize("name", ENGINES)
def test_a_run_that_is_extended_keeps_its_impulses(name, tmp_path):
    engine = ENGINES[name]
    whole = gp.run(COLUMN, engine, 1, 20.0, 1.0, tmp_path / "whole.nc", tallies=[gp.ImpulseTally("z", 10)])
    short = gp.run(
        COLUMN,
        engine,
        1,
        10.0,
        1.0,
        tmp_path / "short.nc",
        tallies=[gp.ImpulseTally("z", 10)],
        keep_checkpoint=True,
    )
    assert gp.resume(short, duration=20.0).read_bytes() == whole.read_bytes()
    assert "--impulses z:10" in " ".join(run_options(whole, read_recipe(whole)))


def test_runs_with_different_impulses_are_neither_one_run_nor_replicas(tmp_path):
    path = gp.run(
        COLUMN, gp.EventDriven(), 1, 20.0, 0.5, tmp_path / "one.nc", tallies=[gp.ImpulseTally("z", 10)]
    )
    bits = path.read_bytes()
    for n, other in enumerate(([gp.ImpulseTally("z", 20)], [gp.ImpulseTally("x", 10)], [])):
        text = other[0].to_text() if other else "none"
        with pytest.raises(gp.SceneError, match="of another run"):
            gp.run(COLUMN, gp.EventDriven(), 1, 20.0, 0.5, path, tallies=other)
        apart = gp.run(COLUMN, gp.EventDriven(), 2, 20.0, 0.5, tmp_path / f"{n}.nc", tallies=other)
        with pytest.raises(gp.SceneError, match=f"impulses = '{text}': are z:10 in .*one.nc"):
            A.replicas("density", [path, apart])
    assert path.read_bytes() == bits
