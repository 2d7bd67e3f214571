"""Trajectories of containers with open faces: the same bytes however they were made, and what is refused."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart import analysis
from gaspart.inspection.certificate import certificate
from gaspart.inspection.readers import read_frames
from gaspart.rendering.live import LiveGas
from gaspart.simulation import Simulation
from gaspart.trajectory.export import export

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


def test_a_run_that_was_cut_short_is_continued_to_the_same_bytes(trajectory, tmp_path, monkeypatch):
    path, checked = tmp_path / "cut.nc", Simulation.check_invariants

    def fails(self, state=None):
        if self.time > 12.0:
            raise KeyboardInterrupt
        checked(self, state)

    with monkeypatch.context() as patched:
        patched.setattr(Simulation, "check_invariants", fails)
        with pytest.raises(KeyboardInterrupt):
            made(path, checkpoint_seconds=0.0)
    assert gp.resume(path).read_bytes() == trajectory[0].read_bytes()


def test_the_energy_is_conserved_and_the_numbers_are_stated(trajectory):
    path, data = trajectory
    drift, contacts, inside = certificate(path)
    assert float(drift.split()[4]) < 1e-12 and "collisions" in contacts
    first, last = (int(np.isfinite(data["coordinates"].values[n, :, 0]).sum()) for n in (0, -1))
    assert inside.startswith(f"{first} particles at the start, {last} at the end")


def test_the_number_of_particles(trajectory):
    path, data = trajectory
    counts = np.isfinite(data["coordinates"].values[..., 0]).sum(axis=1)
    late = data["time"].values >= 5.0
    simulation = gp.Simulation(DISCS, seed=3)
    simulation.advance(duration=20.0)
    for source in (path, data):
        assert float(analysis.particle_number(source).estimate) == pytest.approx(counts[late][1:].mean())
    again = analysis.particle_number(simulation, start=5.0)
    assert float(again.estimate) == pytest.approx(counts[late][1:].mean(), rel=0.05)


def test_profiles_are_of_those_inside(trajectory):
    path, data = trajectory
    late = data["time"].values >= 5.0
    places, velocities = (data[name].values[late].astype(float) for name in ("coordinates", "velocities"))
    inside = np.isfinite(places[..., 0])
    bins = np.clip((places[inside][:, 0] / 2.0).astype(int), 0, 3)
    counted = np.bincount(bins, minlength=4)
    density = analysis.profile(path, "density", "x", bins=4)
    assert density.estimate.values == pytest.approx(counted / (late.sum() * 16.0))
    flow = analysis.velocity_profile(path, "x", bins=4)
    for component in (0, 1):
        mean = np.bincount(bins, velocities[inside][:, component], 4) / counted
        assert flow.estimate.values[component] == pytest.approx(mean)
    field = analysis.field(path, "density", "xy", 2)
    assert float(field.estimate.sum()) * 16.0 == pytest.approx(inside.sum() / late.sum())


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
    found = analysis.particle_flux(path, "x")
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
    with pytest.raises(gp.SceneError, match="initial.*the scene has 12 in 2"):
        gp.Simulation(DISCS, initial=simulation.state)


@pytest.mark.parametrize(
    ("settings", "rule"),
    [
        ({"displacements": True}, "excludes displacements"),
        ({"follow": 3}, "excludes follow"),
        ({"pairs": True}, "excludes pairs"),
        ({"correlations": gp.Correlations(0.5, 4)}, "excludes correlations"),
        ({"impulses": "x:8"}, "not with open faces"),
        ({"pair_impulses": "2:8"}, "needs a periodic container"),
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


@pytest.mark.parametrize("name", ["density", "velocity", "pressure"])
def test_no_length_of_a_run_is_planned(name, tmp_path):
    with pytest.raises(gp.SceneError, match="length of such a run is not planned"):
        gp.run(DISCS, until=gp.Accuracy(name, 0.1), path=tmp_path / "run.nc")


def test_what_needs_particles_that_stay_is_refused(trajectory):
    """By one line that names the face: all observables but those that declare that they do not."""
    path, data = trajectory
    served = {"number", "density", "velocity", "temperature", "pressure", "flux"}
    for name, one in analysis.observables.OBSERVABLES.items():
        assert one.varying == (name in served)
        if name not in served:
            with pytest.raises(gp.SceneError, match="faces.x_low.*open.*particles that stay"):
                getattr(analysis, one.function)(path)
    for refused in (gp.view, analysis.by_species, read_frames):
        with pytest.raises(gp.SceneError, match="faces.x_low.*changes the particles"):
            refused(path)
    with pytest.raises(gp.SceneError, match="faces.x_low.*a slider would state"):
        LiveGas(DISCS)
    with pytest.raises(gp.SceneError, match="none is open"):
        closed = gp.Simulation(gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(3, 0.5, temperature=1.0)]))
        closed.advance(duration=1.0)
        analysis.particle_number(closed)
    assert "count" not in data.attrs and math.isfinite(data.attrs["dimension"])
