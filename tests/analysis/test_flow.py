"""Temperatures of gases that flow: about the flow, by every function that states one."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.run import open_run

A = gp.analysis


@pytest.fixture(scope="module")
def couette(tmp_path_factory):
    """Discs between plates that slide at -1.5 and 1.5: about the flow 1.11 at the plates, 1.29 in the middle,
    with it 1.29 to 1.99."""
    faces = {
        "x_low": gp.Thermal(1.0, velocity=(0.0, -1.5)),
        "x_high": gp.Thermal(1.0, velocity=(0.0, 1.5)),
    }
    container = gp.Container((20.0, 20.0), ("wall", "periodic"))
    scene = gp.Scene(container, [gp.Species(200, 0.5, temperature=1.0)], faces=faces)
    path = tmp_path_factory.mktemp("couette") / "run.nc"
    return gp.run(scene, gp.EventDriven(), 1, 200.0, 0.25, path)


def test_between_plates_that_slide_it_is_about_the_flow(couette):
    found = A.profile(couette, "temperature", "x", bins=20)
    field = A.field(couette, "temperature", "x", cells=20)
    assert found.estimate.values == pytest.approx(field.estimate.values, rel=1e-12)
    assert found.error.values == pytest.approx(field.error.values, rel=1e-9)
    ends, middle = found.estimate[[1, -2]], found.estimate[8:12]
    assert abs(float(ends.mean()) - 1.13) < 3.0 * float(found.error[[1, -2]].max())
    assert abs(float(middle.mean()) - 1.29) < 3.0 * float(found.error[8:12].max())
    assert (found.error[1:-1] < 0.05).all() and (found["temperature_freedom"][1:-1] >= 2.0).all()


def test_along_the_flow_it_is_the_mean_across_the_gap(couette):
    across, along = (A.profile(couette, "temperature", axis, bins=10) for axis in "xy")
    density = A.profile(couette, axis="x", bins=10).estimate
    mean = float((across.estimate * density).sum() / density.sum())
    assert (abs(along.estimate - mean) < 3.5 * along.error).all()
    table = A.by_species(couette)
    assert abs(float(table["temperature"][0]) - mean) < 3.0 * float(table["temperature_error"][0])
    assert float(table["temperature_error"][0]) < 0.02


def test_speeds_are_those_about_the_flow(couette):
    found = A.speed_distribution(couette)
    assert found.theory is None and "about the local flow" in found.estimate.attrs["long_name"]
    speed, width = found["speed"], float(found["speed"][1] - found["speed"][0])
    square = float((found.estimate * speed**2).sum() * width)
    with open_run(couette, None) as run:
        assert square == pytest.approx(2.0 * run.temperature, rel=0.01)


def test_behind_a_shock_it_is_about_the_flow_of_the_moment(tmp_path):
    """A wall at speed 2 drives a shock at 4.59; 2.78 behind it, by the jump conditions. With the flow 4.1."""
    faces = {"z_low": gp.Vibrating(40.0, 40.0, "sawtooth")}
    container = gp.Container((8.0, 8.0, 100.0), ("periodic", "periodic", "wall"))
    scene = gp.Scene(container, [gp.Species(1222, 0.5, temperature=1.0)], faces=faces)
    path = gp.run(scene, gp.EventDriven(), 1, 14.0, 0.0625, tmp_path / "shock.nc")
    found = A.profile(path, "temperature", bins=40, start=9.0)
    density = A.profile(path, bins=40, start=9.0)
    behind = (found["position"] > 29.0) & (found["position"] < 40.0)  # the wall is at 28, the front at 41
    ahead = found["position"] > 68.0
    assert float(found.estimate[behind].mean()) == pytest.approx(2.78, rel=0.08)
    assert float(found.estimate[ahead].mean()) == pytest.approx(1.0, rel=0.08)
    assert float(density.estimate[behind].mean()) == pytest.approx(0.342, rel=0.06)
    assert np.isnan(density.estimate[found["position"] < 17.0]).all()


@pytest.mark.parametrize("drift", [0.0, 1.0])
def test_in_a_wind_it_is_about_the_wind(tmp_path, drift):
    """Both walls slide with the gas, or rest with it: the same state in another frame."""
    velocity = (0.0, drift) if drift else None
    faces = dict.fromkeys(("x_low", "x_high"), gp.Thermal(1.0, velocity=velocity))
    container = gp.Container((16.0, 16.0), ("wall", "periodic"))
    scene = gp.Scene(container, [gp.Species(80, 0.5, temperature=1.0)], faces=faces)
    path = gp.run(scene, gp.EventDriven(), 1, 400.0, 0.5, tmp_path / "wind.nc")
    found = A.profile(path, "temperature", "y", bins=4)
    assert (abs(found.estimate - 1.0) < 3.5 * found.error).all()
    assert (found.error < 0.04).all()


def test_a_gas_blown_past_an_obstacle_has_the_temperature_about_the_wind(tmp_path):
    """Its momentum is not conserved: the mean velocity is a wind while it lasts."""
    post = gp.Particle((2.0, 2.0), (0.0, 0.0), 0.02, fixed=True)
    species = gp.Species(100, 0.2, temperature=1.0, exact_temperature=True)
    scene = gp.Scene(gp.Container((20.0, 20.0), "periodic"), [species], [post])
    at_rest = gp.Simulation(scene, gp.EventDriven(), 1).state.copy()
    at_rest.velocities[1:] += (3.0, 0.0)
    path = gp.run(scene, gp.EventDriven(), 1, 40.0, 0.25, tmp_path / "wind.nc", initial=at_rest)
    with gp.open_trajectory(path) as data:  # the wind slows down, and heats the gas
        velocities = data["velocities"].values[8:, 1:].astype(float)
    about = velocities - velocities.mean(axis=1, keepdims=True)
    expected = float((about**2).mean() * 100.0 / 99.0)
    found = A.profile(path, "temperature", "x", bins=4, start=2.0)
    assert expected < 2.0 and (velocities**2).mean() > 5.0
    assert float(found.estimate.mean()) == pytest.approx(expected, rel=0.05)
    assert float(A.by_species(path, start=2.0)["temperature"][0]) == pytest.approx(expected, rel=0.05)


def test_a_force_along_a_channel_drives_a_flow_however_weak(tmp_path):
    faces = dict.fromkeys(("x_low", "x_high"), gp.Thermal(1.0))
    container = gp.Container((20.0, 20.0), ("wall", "periodic"))
    species = [gp.Species(200, 0.5, temperature=1.0)]
    for force in (0.001, 0.05):
        scene = gp.Scene(container, species, faces=faces, gravity=(0.0, force))
        path = gp.run(scene, gp.EventDriven(), 1, 60.0, 0.5, tmp_path / f"{force}.nc")
        with open_run(path, None) as run:
            assert run.flow_axes == [0]
            energy, temperature = float((run.velocities**2).mean()), run.temperature
        if force > 0.01:  # 1.2 about a flow of 1.1
            assert temperature < 0.75 * energy
            found = A.profile(path, "temperature", "y", bins=4)
            assert (abs(found.estimate - temperature) < 4.0 * found.error).all()
