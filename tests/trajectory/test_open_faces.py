"""Trajectories of containers with open faces: the same bytes however they were made, and what is refused."""

import math
import shlex
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import gsd.hoomd
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import opened

import gaspart as gp
from gaspart import analysis
from gaspart.accuracy.plan import plan
from gaspart.analysis.conditions import VARYING
from gaspart.analysis.observables import OBSERVABLES
from gaspart.cli import main
from gaspart.inspection.checks import judge_open
from gaspart.inspection.energy import certificate
from gaspart.inspection.readers import read_frames
from gaspart.simulation import Simulation
from gaspart.trajectory.export import export

pytestmark = pytest.mark.thorough

FACES = {"x_low": gp.Open(0.2, 2.0), "x_high": gp.Open(), "y_high": gp.Thermal(1.5)}
DISCS = gp.Scene(
    gp.Container((8.0, 8.0)), [gp.Species(12, 0.5, temperature=1.0)], faces=FACES, centres_to_walls=True
)


def made(path, duration=20.0, **more):
    return gp.run(DISCS, seed=3, duration=duration, sample_interval=0.5, path=path, **more)


@pytest.fixture(scope="module")
def trajectory(tmp_path_factory):
    path = made(tmp_path_factory.mktemp("open") / "run.nc", keep_checkpoint=True)
    with gp.open_trajectory(path) as data:
        yield path, data.load()


def test_frames_have_each_particle_at_its_number(trajectory):
    _, data = trajectory
    simulation = gp.Simulation(DISCS, seed=3)
    numbers = set()
    assert data.sizes["atom"] == DISCS.capacity > 12
    for frame, time in enumerate(data["time"].values):
        simulation.advance(until=time)
        state, absent = simulation.state, np.ones(DISCS.capacity, dtype=bool)
        absent[state.numbers] = False
        numbers |= set(state.numbers.tolist())
        for name, values in (("coordinates", state.positions), ("velocities", state.velocities)):
            stored = data[name].values[frame]
            assert np.isnan(stored[absent]).all()
            assert np.array_equal(stored[state.numbers], values.astype(np.float32))
        assert float(data["kinetic_energy"][frame]) == state.kinetic_energy
        assert np.array_equal(data["entries"].values[frame], simulation.tally.entries)
    assert data["entries"].values[-1, 0] > 5 and len(numbers) > 12


def test_a_run_that_goes_on_has_the_bytes_of_one_in_one_go(trajectory, tmp_path):
    whole = trajectory[0].read_bytes()
    part = made(tmp_path / "part.nc", 7.0, keep_checkpoint=True)
    assert gp.resume(part, duration=20.0).read_bytes() == whole


@pytest.mark.parametrize("engine", ["event", "dsmc"])
def test_a_run_that_was_cut_short_is_continued_to_the_same_bytes(engine, trajectory, tmp_path, monkeypatch):
    path, checked = tmp_path / "cut.nc", Simulation.check_invariants
    whole = trajectory[0] if engine == "event" else made(tmp_path / "whole.nc", engine=engine)

    def fails(self, state=None):
        if self.time > 12.0:
            raise KeyboardInterrupt
        checked(self, state)

    with monkeypatch.context() as patched:
        patched.setattr(Simulation, "check_invariants", fails)
        with pytest.raises(KeyboardInterrupt):
            made(path, engine=engine, checkpoint_seconds=0.0)
    assert gp.resume(path).read_bytes() == whole.read_bytes()


def test_the_energy_is_conserved_and_the_numbers_are_stated(trajectory):
    path, data = trajectory
    drift, contacts, inside = certificate(path)
    assert float(drift.split()[4]) < 1e-12 and "collisions" in contacts
    first, last = (int(np.isfinite(data["coordinates"].values[n, :, 0]).sum()) for n in (0, -1))
    assert inside.startswith(f"{first} particles at the start, {last} at the end")


def test_the_temperature_is_about_the_flow_in_each_frame(trajectory):
    """Of those in a cell, half of sum (v - mean v)^2 over the number less one."""
    path, data = trajectory
    late = data["time"].values >= 5.0
    places, velocities = (data[name].values[late].astype(float) for name in ("coordinates", "velocities"))
    energies, freedoms = np.zeros(2), np.zeros(2)
    for x, v in zip(places[..., 0], velocities, strict=True):
        for n in range(2):
            chosen = v[np.isfinite(x) & (np.clip(x // 4.0, 0, 1) == n)]
            energies[n] += ((chosen - chosen.mean(axis=0)) ** 2).sum() if len(chosen) else 0.0
            freedoms[n] += 2.0 * max(0, len(chosen) - 1)
    found = analysis.profile(path, "temperature", "x", bins=2)
    assert found.estimate.values == pytest.approx(energies / freedoms)


def test_the_flux_through_a_plane_is_what_comes_in_less_what_stays(trajectory):
    path, data = trajectory
    late = data["time"].values >= 5.0
    places = data["coordinates"].values[late, :, 0]
    low = np.nansum(places <= 4.0, axis=1)
    came = (data["entries"] - data["wall_hits"]).values[late, 0]
    passed = (came[-1] - came[0]) - (low[-1] - low[0])
    found = analysis.particle_flux(path)
    assert found.estimate.values == pytest.approx(passed / 15.0) and passed > 0
    with pytest.raises(gp.SceneError, match="x_low.*come and go on either side"):
        analysis.particle_flux(path, "y")


def test_pictures_and_exports_are_of_those_inside(trajectory, tmp_path):
    path, data = trajectory
    inside = int(np.isfinite(data["coordinates"].values[-1, :, 0]).sum())
    simulation = gp.Simulation(DISCS, seed=3)
    simulation.advance(until=20.0)
    assert np.array_equal(gp.render(path, size=(160, 120)), gp.render(simulation, size=(160, 120)))
    with pytest.raises(gp.SceneError, match="x_low.*a trail is of one that stays"):
        gp.film(path, tmp_path / "film.gif", trail=0)
    text = export(path, tmp_path / "last.data").read_text()
    assert f"{inside} atoms" in text and "nan" not in text


def test_the_last_state_is_that_of_a_checkpoint(trajectory, tmp_path):
    path, _ = trajectory
    simulation = gp.Simulation(DISCS, seed=3)
    simulation.advance(until=20.0)
    assert np.array_equal(gp.last_state(path).positions, simulation.state.positions)
    with pytest.raises(gp.SceneError, match="x_low.*no checkpoint of its end"):
        gp.last_state(made(tmp_path / "other.nc"))
    with pytest.raises(gp.SceneError, match="initial.*must be as in the scene, 12 in 2"):
        gp.Simulation(DISCS, initial=simulation.state)


@pytest.mark.parametrize(
    ("settings", "rule"),
    [
        ({"displacements": True}, "excludes displacements"),
        ({"follow": 3}, "excludes follow"),
        ({"pairs": True}, "excludes pairs"),
        ({"correlations": gp.Correlations(0.5, 4)}, "excludes correlations"),
        ({"tallies": [gp.ImpulseTally("x", 8)]}, "excludes impulses"),
        ({"tallies": [gp.PairImpulseTally(2.0, 8)]}, "needs a periodic container"),
    ],
)
def test_runs_that_are_refused(settings, rule, tmp_path):
    with pytest.raises(gp.SceneError, match=rule):
        made(tmp_path / "run.nc", **settings)
    assert not list(tmp_path.iterdir())


def test_the_same_run_is_no_replica(trajectory):
    path, data = trajectory
    simulation, other = (gp.Simulation(DISCS, seed=seed) for seed in (3, 4))
    for one in (simulation, other):
        one.advance(duration=20.0)
    for source in (path, data):
        with pytest.raises(gp.SceneError, match="bit for bit"):
            analysis.replicas("number", [source, simulation])
    assert analysis.replicas("number", [path, other]).error > 0.0


@pytest.mark.parametrize(("name", "accuracy"), [("number", 0.05), ("density", 0.2), ("flux", 0.1)])
def test_a_steady_run_ends_when_it_is_accurate(name, accuracy, tmp_path):
    path = gp.run(DISCS, until=gp.Accuracy(name, accuracy), path=tmp_path / "run.nc", at_most=20_000.0)
    (reached,) = gp.reached_accuracy(path)
    assert reached.met and reached.accuracy < accuracy and reached.value > 0.0


def test_what_is_not_steady_or_vanishes_ends_no_run(tmp_path):
    closed = replace(DISCS, faces={"x_low": gp.Open(0.2, 2.0)})
    for scene, name, rule in (
        (EMPTY, "number", "x_low.*has no reservoir: all particles leave"),
        (closed, "flux", "net flux between walls is 0 in a steady state"),
        (closed, "Z", "particles that stay"),
    ):
        with pytest.raises(gp.SceneError, match=rule):
            gp.run(scene, until=gp.Accuracy(name, 0.1), path=tmp_path / "run.nc")


OPEN_RUNS = st.one_of(st.tuples(opened(), st.just("event")), st.tuples(opened(most=0.1), st.just("dsmc")))


@given(OPEN_RUNS, st.integers(0, 1000))
@settings(max_examples=16)
@pytest.mark.filterwarnings("ignore:gaspart")
def test_random_open_runs_are_read_checked_and_exported(scene_and_engine, seed):
    """Also those without any particle in some or all frames."""
    scene, engine = scene_and_engine
    with TemporaryDirectory() as folder:
        path = gp.run(scene, engine, seed, 8.0, 0.4, Path(folder, "run.nc"))
        with gp.open_trajectory(path) as data:
            counts = np.isfinite(data["coordinates"].values[..., 0]).sum(axis=1)
        assert not any(check.passed is False for check in judge_open(path)[1])
        for name in ("run.gsd", "run.xyz"):
            export(path, Path(folder, name), frame="all")
        with gsd.hoomd.open(Path(folder, "run.gsd")) as frames:
            assert [frame.particles.N for frame in frames] == counts.tolist()
        number = gp.measure(path, "number", start=0.0)
        assert float(number.estimate) == pytest.approx(counts.mean(), rel=0.2, abs=0.5)


@pytest.mark.parametrize("name", ["number", "density", "temperature", "pressure", "pressure:y low"])
def test_advice_on_an_open_scene_names_the_run_that_ends_by_itself(name):
    with pytest.raises(gp.SceneError, match="x_low: lets.*no cost is predicted") as error:
        plan(DISCS, name, 0.1)
    assert f"--until {shlex.quote(f'{name}=0.01')}` ends" in str(error.value)


def test_what_needs_particles_that_stay_is_refused(trajectory):
    """By one line that names the face: all observables but those that declare that they do not."""
    path, data = trajectory
    served = {"number", "density", "velocity", "temperature", "pressure", "force", "flux", "heat_flux"}
    for name, one in analysis.observables.OBSERVABLES.items():
        assert one.varying == (name in served) == (name in VARYING.replace(",", "").split())
        if name not in served:
            with pytest.raises(gp.SceneError, match="faces.x_low.*open.*particles that stay"):
                getattr(analysis, one.function)(path)
    for refused in (lambda path: gp.view(path, order=True), read_frames):
        with pytest.raises(gp.SceneError, match="faces.x_low.*changes the particles"):
            refused(path)
    with pytest.raises(gp.SceneError, match="faces.x_low.*follows particles that stay"):
        analysis.by_species(path)
    with pytest.raises(gp.SceneError, match="none is open"):
        closed = gp.Simulation(gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(3, 0.5, temperature=1.0)]))
        closed.advance(duration=1.0)
        analysis.particle_number(closed)
    assert "count" not in data.attrs and math.isfinite(data.attrs["dimension"])


def test_a_run_is_checked_by_its_books(trajectory, tmp_path):
    path, data = trajectory
    title, checks = judge_open(path)
    counts = np.isfinite(data["coordinates"].values[..., 0]).sum(axis=1)
    assert f"{counts.min()} to {counts.max()} discs in 41 frames" in title
    passed = {check.name: check.passed for check in checks}
    assert [name for name, one in passed.items() if one] == [
        "overlaps", "container", "particles", "energy", "flights",
    ]  # fmt: skip
    assert main(["check", str(path)]) == 0
    assert main(["check", str(path), "--radius", "0.5"]) == 2


@pytest.mark.parametrize(
    ("name", "frame", "change", "wrong"),
    [
        ("coordinates", 30, np.nan, "particles"),
        ("coordinates", 30, 3.0, "flights"),
        ("wall_energy", 30, 1e-3, "energy"),
        ("coordinates", 30, -9.0, "container"),
    ],
)
def test_a_damaged_run_is_found(trajectory, monkeypatch, name, frame, change, wrong):
    path, data = trajectory
    damaged = data.copy(deep=True)
    velocities = data["velocities"].values
    same_velocity = (velocities[frame] == velocities[frame - 1]).all(axis=1)
    particle = int(np.flatnonzero(same_velocity)[0]) if name == "coordinates" else 0
    damaged[name].values[frame, particle] += change
    monkeypatch.setattr("gaspart.inspection.checks.open_trajectory", lambda _: damaged)
    assert wrong in {check.name for check in judge_open(path)[1] if check.passed is False}


EMPTY = gp.Scene(
    gp.Container((6.0, 4.0, 4.0), ("wall", "periodic", "periodic")),
    [gp.Species(4, 0.5, temperature=1.0)],
    faces={"x_low": gp.Open(), "x_high": gp.Open()},
    centres_to_walls=True,
)
"""Spheres that all leave into a vacuum."""


@pytest.fixture(scope="module")
def empty(tmp_path_factory):
    path = tmp_path_factory.mktemp("empty") / "run.nc"
    return gp.run(EMPTY, duration=400.0, sample_interval=2.0, path=path, keep_checkpoint=True)


def test_a_frame_may_have_no_particle(empty, tmp_path):
    """In every observable, file, picture and check."""
    simulation = gp.Simulation(EMPTY)
    simulation.advance(duration=400.0)
    assert simulation.state.count == gp.last_state(empty).count == 0
    for source in (empty, simulation):
        for name, one in OBSERVABLES.items():
            if one.varying and name != "heat_flux":  # no face has a temperature
                found = getattr(analysis, one.function)(source, start=200.0, **one.arguments)
                values = found.estimate.values
                assert (
                    np.isnan(values).all() if name in ("velocity", "temperature") else (values == 0.0).all()
                )
        picture = gp.render(source, size=(80, 60))
        assert (picture[5, 5] == picture[30, 40]).all()
        page = gp.view(source, frames=5).page
        assert '"inside": [4, ' in page and ", 0]" in page
    assert judge_open(empty)[1] and all(check.passed is not False for check in judge_open(empty)[1])
    assert "0 atoms" in export(empty, tmp_path / "last.data").read_text()
    with gsd.hoomd.open(export(empty, tmp_path / "last.gsd"), "r") as frames:
        assert frames[0].particles.N == 0
    text = export(empty, tmp_path / "all.xyz", frame="all").read_text()
    assert text.startswith("4\n") and text.splitlines()[-2] == "0"
