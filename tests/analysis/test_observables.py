"""Observables of a user's own run, against theory and exact cases."""

import math

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.run import REPEATED
from gaspart.cli import main

A = gp.analysis
SPHERES = gp.Scene(gp.Container((11.0,) * 3, "periodic"), [gp.Species(500, 0.5, temperature=1.3, mass=2.0)])
DISCS = gp.Scene(gp.Container((20.0, 20.0)), [gp.Species(150, 0.5, temperature=1.0)])


@pytest.fixture(scope="module")
def spheres(tmp_path_factory):
    """A fluid of spheres at a packing fraction of 0.2: 160 collisions of each."""
    path = tmp_path_factory.mktemp("runs") / "spheres.nc"
    return gp.run(SPHERES, gp.EventDriven(), 1, 40.0, 0.1, path)


@pytest.fixture(scope="module")
def discs():
    """A simulation of discs between walls."""
    simulation = gp.Simulation(DISCS, gp.EventDriven(), seed=3)
    simulation.advance(duration=300.0)
    return simulation


def test_displacements_follow_particles_across_periodic_faces(spheres, tmp_path):
    path = gp.run(SPHERES, gp.EventDriven(), 1, 40.0, 0.1, tmp_path / "a.nc", displacements=True)
    stored, followed = (A.mean_squared_displacement(source).estimate for source in (path, spheres))
    assert np.allclose(stored, followed, rtol=1e-4, atol=1e-6)  # positions are float32
    far = gp.run(SPHERES, gp.EventDriven(), 1, 400.0, 10.0, tmp_path / "b.nc")
    with pytest.raises(gp.SceneError, match="make the run with --displacements"):
        A.mean_squared_displacement(far)


def test_the_profile_of_a_dilute_atmosphere_is_barometric(tmp_path):
    container = gp.Container((20.0, 10.0, 40.0), ("periodic", "periodic", "wall"))
    scene = gp.Scene(container, [gp.Species(200, 0.5, temperature=1.0)], gravity=(0.0, 0.0, -0.05))
    path = gp.run(scene, gp.EventDriven(), 1, 8000.0, 20.0, tmp_path / "a.nc")
    density = A.profile(path, bins=8, start=3000.0)
    apart = (density.estimate - density.theory) / density.error
    assert float((apart**2).mean()) < 1.0 + 3.0 * math.sqrt(2.0 / 8.0) + 2.0 / 15.0
    assert float(density.estimate[0]) > 3.0 * float(density.estimate[-1])
    total = float(density.estimate.mean()) * 40.0 * 200.0
    assert total == pytest.approx(200.0)
    temperature = A.profile(path, "temperature", bins=4, start=3000.0)
    assert float((temperature.deviation**2).mean()) < 1.0 + 3.0 * math.sqrt(2.0 / 4.0) + 2.0 / 15.0


def test_a_path_a_dataset_and_a_simulation_give_the_same(tmp_path):
    scene = gp.Scene(gp.Container((9.0,) * 3, "periodic"), [gp.Species(100, 0.5, temperature=1.0)])
    interval = 0.125
    duration = (REPEATED - 1) * interval
    path = gp.run(scene, gp.EventDriven(), 5, duration, interval, tmp_path / "a.nc")
    simulation = gp.Simulation(scene, gp.EventDriven(), seed=5)
    simulation.advance(duration=duration)
    with gp.open_trajectory(path) as trajectory:
        for function in (A.compressibility_factor, A.collision_rate, A.velocity_autocorrelation):
            first, second, third = (function(it) for it in (path, trajectory, simulation))
            assert first.identical(second)
            assert np.allclose(first.estimate, third.estimate, rtol=1e-5, atol=1e-6)
            assert np.allclose(first.error, third.error, rtol=1e-3, atol=1e-6)


def test_the_time_stepped_engine_is_measured_at_even_times():
    simulation = gp.Simulation(SPHERES, gp.TimeStepped(time_step=0.003), seed=2)
    simulation.advance(duration=3.0)
    found = A.compressibility_factor(simulation)
    assert abs(float(found.deviation)) < 3.5
    assert A.mean_squared_displacement(simulation).sizes["lag"] > 30


def test_results_have_units_and_plot_themselves(spheres, discs):
    for found in (A.compressibility_factor(spheres), A.speed_distribution(spheres), A.wall_pressure(discs)):
        numbers = [variable for variable in found.variables.values() if variable.dtype.kind == "f"]
        assert len(numbers) >= 4 and all("units" in variable.attrs for variable in numbers)
        axis = found.plot(theory=True)
        assert len(axis.lines) >= 2 and axis.get_ylabel() and axis.get_legend()
    axis = A.order_parameter(spheres).plot(theory=True)
    assert "no theory for this scene" in [text.get_text() for text in axis.get_legend().get_texts()]


WALLED = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.5, temperature=1.0)])


def test_a_simulation_that_has_not_advanced_is_refused():
    with pytest.raises(gp.SceneError, match="has not advanced"):
        A.collision_rate(gp.Simulation(WALLED, gp.EventDriven(search="direct"), seed=1))


def test_a_run_that_is_too_short_is_refused(tmp_path):
    path = gp.run(WALLED, gp.EventDriven("direct"), 1, 1.0, 0.1, tmp_path / "a.nc")
    with pytest.raises(gp.SceneError, match="frames = 8: an error needs 17"):
        A.collision_rate(path)
    with pytest.raises(gp.SceneError, match="start = 3.0: leaves 0 frames"):
        A.collision_rate(path, start=3.0)
    few = gp.run(WALLED, gp.EventDriven("direct"), 1, 1.0, 0.1, tmp_path / "b.nc", follow=10)
    with pytest.raises(gp.SceneError, match="follow = 10: needs all 20 particles"):
        A.speed_distribution(few)


def test_the_command_prints_and_writes_the_same_numbers(spheres, tmp_path, capsys):
    path = str(spheres)
    assert main(["measure", path, "Z", "msd"]) == 0
    lines = capsys.readouterr().out.splitlines()
    found = A.compressibility_factor(spheres)
    assert lines[0].startswith(f"Z = {float(found.estimate):.6g} +- ") and "theory 2.3" in lines[0]
    assert lines[1].split() == ["lag", "msd", "error", "theory", "its", "error"]
    table = tmp_path / "speeds.csv"
    assert main(["measure", path, "speeds", "-o", str(table)]) == 0
    title, *rows = table.read_text().splitlines()
    assert "speed: length / time" in title and len(rows) == 41
    picture = tmp_path / "speeds.png"
    assert main(["measure", path, "speeds", "-o", str(picture)]) == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    for arguments, complaint in (
        (["speeds", "-o", str(table)], "exists; move it away"),
        (["speeds", "Z", "-o", str(table), "--force"], "-o takes one observable"),
        (["speeds", "-o", "a.txt"], "must end in .csv or .png"),
        (["friction"], "'friction': unknown name; known are Z"),
    ):
        assert main(["measure", path, *arguments]) == 2
        assert complaint in capsys.readouterr().err
