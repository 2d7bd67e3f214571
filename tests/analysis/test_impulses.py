"""Densities from impulses: exactly from exact momenta, mixed with counts, and as those of runs."""

import math
from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart.accuracy.estimates import components
from gaspart.accuracy.target import Target
from gaspart.analysis.impulses import (
    MomentumFlux,
    group_count,
    mixture,
    numbers_by_impulses,
    subtract_controls,
    wall_controls,
)
from gaspart.analysis.run import open_run
from gaspart.analysis.series import face_pressures
from gaspart.cli.options import run_options
from gaspart.runs.ending import Accuracy
from gaspart.state.tally import ImpulseTally
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import read_recipe

RISE = np.random.default_rng(3)
COLUMN = gp.Scene(
    gp.Container((6.0, 6.0, 8.0), ("periodic", "periodic", "wall")),
    [gp.Species(20, 0.4, temperature=1.0)],
    gravity=(0.0, 0.0, -0.5),
)


@pytest.mark.parametrize(("pull", "walled"), [(0.0, True), (-1.3, True), (1.3, True), (0.0, False)])
def test_numbers_follow_exactly_from_the_momentum_of_a_known_density(pull, walled):
    """Of points in a temperature that rises; without walls the flux through the face is unknown."""
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
TIERED = ["event", pytest.param("step", marks=pytest.mark.thorough)]


@pytest.fixture(scope="module", params=TIERED)
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
    """The contact theorem, for which counts need narrow bins."""
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


@pytest.mark.thorough
@pytest.mark.parametrize("name", TIERED)
def test_a_run_that_is_extended_keeps_its_impulses(name, tmp_path):
    engine = ENGINES[name]
    whole = gp.run(COLUMN, engine, 1, 20.0, 1.0, tmp_path / "whole.nc", tallies=[gp.ImpulseTally("z", 10)])
    kept = {"tallies": [gp.ImpulseTally("z", 10)], "keep_checkpoint": True}
    short = gp.run(COLUMN, engine, 1, 10.0, 1.0, tmp_path / "short.nc", **kept)
    assert gp.resume(short, duration=20.0).read_bytes() == whole.read_bytes()
    assert "--impulses z:10" in " ".join(run_options(whole, read_recipe(whole)))


def test_runs_with_different_impulses_are_neither_one_run_nor_replicas(tmp_path):
    kept = [gp.ImpulseTally("z", 10)]
    path = gp.run(COLUMN, gp.EventDriven(), 1, 20.0, 0.5, tmp_path / "one.nc", tallies=kept)
    bits = path.read_bytes()
    for n, other in enumerate(([gp.ImpulseTally("z", 20)], [gp.ImpulseTally("x", 10)], [])):
        text = other[0].to_text() if other else "none"
        with pytest.raises(gp.SceneError, match="of another run"):
            gp.run(COLUMN, gp.EventDriven(), 1, 20.0, 0.5, path, tallies=other)
        apart = gp.run(COLUMN, gp.EventDriven(), 2, 20.0, 0.5, tmp_path / f"{n}.nc", tallies=other)
        with pytest.raises(gp.SceneError, match=f"impulses = '{text}': are z:10 in .*one.nc"):
            A.replicas("density", [path, apart])
    assert path.read_bytes() == bits


# Control variates: of planted series, and of pressures on walls against virial theorem and equipartition.


A = gp.analysis
SLIT = gp.Container((5.0, 5.0, 8.0), ("periodic", "periodic", "wall"))
GAS = gp.Species(19, 0.5, temperature=1.0)
SCENE = gp.Scene(SLIT, [GAS])
PLANTED = 2000


def test_planted_controls_are_taken_off_and_leave_the_mean_unbiased():
    """In 2000 series of mean 5 that have 3 and -2 of two controls, and noise of 0.5."""
    rng = np.random.default_rng(1)
    controls, noise = rng.standard_normal((PLANTED, 96, 2)), rng.standard_normal((PLANTED, 96))
    series = 5.0 + controls @ (3.0, -2.0) + 0.5 * noise
    found = np.array([subtract_controls(*one, 64) for one in zip(series, controls, strict=True)])
    means = found.mean(axis=1)
    assert means.mean() == pytest.approx(5.0, abs=4.0 * means.std() / PLANTED**0.5)
    assert means.std() == pytest.approx(0.5 / 96**0.5, rel=0.1)  # two coefficients from 32 groups
    claimed = found.std(axis=1, ddof=1) / 96**0.5
    assert np.sqrt((claimed**2).mean()) == pytest.approx(means.std(), rel=0.05)


def test_coefficients_are_those_of_the_other_half():
    rng = np.random.default_rng(2)
    controls, series = rng.standard_normal((64, 1)), rng.standard_normal(64)
    other = series.copy()
    other[:32] += 7.0 * controls[:32, 0]
    before, after = subtract_controls(series, controls, 64), subtract_controls(other, controls, 64)
    assert after[:32] - before[:32] == pytest.approx(7.0 * controls[:32, 0])  # with the coefficient of before
    assert after[32:] - before[32:] == pytest.approx(-7.0 * controls[32:, 0])


@pytest.fixture(scope="module")
def thin(tmp_path_factory):
    """A thin gas between two walls, with its impulses."""
    path = tmp_path_factory.mktemp("thin") / "run.nc"
    return gp.run(SCENE, gp.EventDriven(), 1, 800.0, 0.5, path, tallies=[gp.ImpulseTally("z", 8)])


def test_the_balance_of_the_virial_holds_without_contacts(tmp_path):
    """Of points, to rounding: the impulses of both walls are twice the kinetic energy along their normal,
    over the way that centres have, less what is stored."""
    points = gp.Scene(SLIT, [gp.Species(7, 1e-6, temperature=1.0)])
    kept = [gp.ImpulseTally("z", 5)]
    path = gp.run(points, gp.EventDriven(), 3, 40.0, 1.0, tmp_path / "run.nc", tallies=kept)
    with open_trajectory(path) as data, open_run(data, 0.0) as run:
        assert not run.increments("collisions").any() and not group_count(run)
        low, high = 25.0 * face_pressures(run)[:, 4:].T
        known = wall_controls(run, 2)
        energy = known[:, 0] + 7.0 * run.temperature
    assert low - high == pytest.approx(known[:, 1], abs=1e-4)
    assert 0.5 * (low + high) * 8.0 == pytest.approx(energy - known[:, 2], abs=1e-4)


def test_pressures_have_less_error_and_agree(thin):
    with open_trajectory(thin) as data:
        found, plain = A.wall_pressure(data), A.wall_pressure(data.assign_attrs(tallies="[]"))
        better, usual = (components(one, "pressure") for one in (data, data.assign_attrs(tallies="[]")))
    assert found.attrs["estimator"] != plain.attrs["estimator"] == "wall impulses"
    assert "--impulses z:40" in plain.attrs["note"] and "note" not in found.attrs
    assert "wall_pressure_freedom" not in plain
    assert found["wall_pressure_freedom"].values.tolist() == [12.0, 12.0]  # of 16 blocks and 3 controls
    assert ((plain.error / found.error) ** 2 > 4.0).all()
    apart = (plain.estimate - found.estimate) / np.sqrt(plain.error**2 + found.error**2)
    assert (abs(apart) < 3.0).all() and (abs(found.deviation) < 3.0).all()
    assert float(found.estimate[0]) == pytest.approx(float(found.estimate[1]), rel=1e-3)
    for face, one in better.items():
        assert (usual[face].error(600.0) / one.error(600.0)) ** 2 > 8.0
        assert one.value == pytest.approx(float(found.estimate.sel(face=face)), rel=1e-3)


UNEVEN = {
    "gravity": gp.Scene(SLIT, [GAS], gravity=(0.0, 0.0, -0.3)),
    "a well": gp.Scene(SLIT, [GAS], faces={"z_low": gp.Well(1.0, 0.7)}),
    "a thermal face": gp.Scene(SLIT, [GAS], faces={"z_low": gp.Thermal(1.0)}),
    "rough": gp.Scene(SLIT, [GAS], restitution=gp.Restitution(1.0, 1.0)),
}


@pytest.mark.thorough
@pytest.mark.parametrize("name", UNEVEN)
def test_where_the_energy_is_not_constant_there_are_no_controls(name, tmp_path):
    kept = [gp.ImpulseTally("z", 8)]
    path = gp.run(UNEVEN[name], gp.EventDriven(), 1, 60.0, 0.5, tmp_path / "run.nc", tallies=kept)
    with open_trajectory(path) as data, open_run(data, 0.0) as run:
        assert wall_controls(run, 2) is None and group_count(run)
    found = A.wall_pressure(path)
    assert found.attrs["estimator"] == "wall impulses" and "note" not in found.attrs
    assert not Target(UNEVEN[name], "pressure").tallies(gp.EventDriven())


@pytest.mark.thorough
def test_steps_keep_no_impulses_for_a_pressure_as_they_share_energy_unevenly(tmp_path):
    steps = gp.TimeStepped(0.02)
    run = gp.run(SCENE, steps, 1, 100.0, 0.5, tmp_path / "run.nc", tallies=[gp.ImpulseTally("z", 8)])
    with open_trajectory(run) as data, open_run(data, 0.0) as opened:
        assert wall_controls(opened, 2) is None and group_count(opened)
        found, bare = A.wall_pressure(data), A.wall_pressure(data.assign_attrs(tallies="[]"))
    assert found.attrs["estimator"] == "wall impulses" and found.identical(bare)
    assert "note" not in found.attrs
    for engine, kept in ((steps, 0), (gp.EventDriven(), 1)):
        assert len(Target(SCENE, "pressure", "z low").tallies(engine)) == kept
        assert len(Target(SCENE, "density").tallies(engine)) == 1


def test_a_file_without_all_states_and_another_axis_have_none(tmp_path):
    box = gp.Scene(gp.Container((5.0, 5.0, 8.0)), [GAS])
    kept, options = [gp.ImpulseTally("x", 8)], ({}, {"follow": 3}, {"keep": "positions"})
    whole, path, half = (
        gp.run(box, gp.EventDriven(), 1, 60.0, 0.5, tmp_path / f"{n}.nc", tallies=kept, **more)
        for n, more in enumerate(options)
    )
    for lacking in (path, half):
        with open_run(lacking, 0.0) as run:
            assert wall_controls(run, 0) is None
    with open_trajectory(half) as data:
        assert len(components(data, "pressure")) == 6
    with open_run(whole, 0.0) as run:
        assert wall_controls(run, 0) is not None and wall_controls(run, 2) is None
    assert A.wall_pressure(whole)["wall_pressure_freedom"].values.tolist() == [12.0, 12.0, *[15.0] * 4]


def test_a_run_until_a_pressure_is_accurate_keeps_what_it_needs(tmp_path):
    box = gp.Scene(gp.Container((5.0, 5.0, 8.0)), [GAS])
    engine = gp.EventDriven()
    kept = [Target(box, "pressure", face).tallies(engine) for face in ("y high", None)]
    assert [one.to_text() for one in kept[0]] == ["y:40"] and not kept[1]  # of all walls the worst counts
    assert not Target(SCENE, "pressure").tallies(gp.DSMC(0.05, (4, 4, 4)))
    path = gp.run(
        SCENE, engine, 1, sample_interval=1.0, path=tmp_path / "run.nc",
        until=Accuracy("pressure", 0.05, face="z low"), at_most=1600.0,
    )  # fmt: skip
    assert [one.to_text() for one in read_recipe(path).tallies] == ["z:40"]
    (reached,) = gp.reached_accuracy(path)
    assert reached.met and reached.freedom >= 15.0


@pytest.mark.thorough
def test_the_pressure_of_two_discs_has_no_controls_and_an_honest_error(tmp_path):
    """With controls 52 of 60 values were within two errors of their mean."""
    kind = gp.Species(2, 0.5, temperature=1.0, exact_temperature=True)
    scene = gp.Scene(gp.Container((2.6, 2.9)), [kind])
    values, errors = [], []
    for seed in range(30):
        path, kept = tmp_path / f"{seed}.nc", [gp.ImpulseTally("y", 40)]
        gp.run(scene, gp.EventDriven("direct"), seed, 60.0, 0.25, path, tallies=kept)
        found = gp.measure(path, "pressure").sel(face="y low")
        assert "known mean" not in str(found.attrs["estimator"])
        values.append(float(found.estimate))
        errors.append(float(found.error))
    ratio = np.std(values, ddof=1) / np.sqrt(np.mean(np.square(errors)))
    assert 0.7 < ratio < 1.35  # of 29 degrees of freedom, and 15 of each error


def test_a_run_without_any_impulse_has_the_density_of_counts(tmp_path):
    scene = gp.Scene(gp.Container((20.0,) * 3), [gp.Species(20, 0.05, temperature=1.0)])
    path = gp.run(scene, gp.EventDriven(), 1, 0.02, 0.001, tmp_path / "a.nc", tallies=[ImpulseTally("z", 40)])
    found = gp.analysis.density(path)
    assert found.attrs["estimator"] == "counts"
    assert float(found.estimate.mean()) == pytest.approx(scene.number_density)
