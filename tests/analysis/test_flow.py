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
    faces = {"x_low": gp.Thermal(1.0, velocity=(0.0, -1.5)), "x_high": gp.Thermal(1.0, velocity=(0.0, 1.5))}
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


@pytest.mark.thorough
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


@pytest.mark.thorough
def test_a_force_along_a_channel_drives_a_flow_however_weak(tmp_path):
    faces = dict.fromkeys(("x_low", "x_high"), gp.Thermal(1.0))
    container = gp.Container((20.0, 20.0), ("wall", "periodic"))
    species = [gp.Species(200, 0.5, temperature=1.0)]
    for force in (0.001, 0.05):
        scene = gp.Scene(container, species, faces=faces, gravity=(0.0, force))
        path = gp.run(scene, gp.EventDriven(), 1, 60.0, 0.5, tmp_path / f"{force}.nc")
        with open_run(path, None) as run:
            assert run.flow_axes == [0]


# The rule of motion: temperature, speeds, msd, vacf and D are about one flow, or about rest.


CHANNEL = gp.Container((6.0, 8.0, 8.0), ("wall", "periodic", "periodic"))
PLATES = {"x_low": gp.Thermal(1.0), "x_high": gp.Thermal(1.0)}


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    """Spheres that a force drives along thermal plates."""
    scene = gp.Scene(CHANNEL, [gp.Species(60, 0.5, temperature=1.0)], gravity=(0.0, 0.2, 0.0), faces=PLATES)
    path = tmp_path_factory.mktemp("driven") / "a.nc"
    return gp.run(scene, gp.EventDriven(), 1, 150.0, 0.25, path, displacements=True)


@pytest.mark.thorough
def test_particles_spread_along_a_flow_as_across_it(driven):
    """About the flow the squared displacement does not grow like t^2, and both directions are alike."""
    found = gp.measure(driven, "msd", per_axis=True)
    late = found.sel(lag=slice(30.0, None)).isel(lag=0)
    along, across = (late.sel(axis=axis) for axis in "yz")
    error = np.hypot(float(along.error), float(across.error))
    assert error < 0.2 * float(across.estimate)
    assert abs(float(along.estimate) - float(across.estimate)) < 4.0 * error
    about_rest = gp.measure(driven, "msd", per_axis=True, about="rest").sel(axis="y")
    assert float(about_rest.sel(lag=late.lag).estimate) > 5.0 * float(across.estimate)


@pytest.mark.thorough
def test_all_observables_of_motion_are_about_the_same_flow(driven):
    first = float(gp.measure(driven, "vacf").estimate[0])
    table = gp.analysis.by_species(driven)
    assert first == pytest.approx(float(table.temperature[0]), rel=1e-6)
    assert first == pytest.approx(float(table.vacf[0, 0]), rel=1e-6)
    speeds = gp.measure(driven, "speeds")
    square = float((speeds.estimate * speeds.speed**2).sum() * np.diff(speeds.speed)[0])
    assert square / 3.0 == pytest.approx(first, rel=0.02)


@pytest.mark.thorough
def test_about_rest_the_energy_of_the_flow_counts(driven):
    with gp.open_trajectory(driven) as data:
        part = data.isel(frame=slice(data.sizes["frame"] // 4, None))
        velocities = part["velocities"].values.astype(float)
    exact = (velocities**2).mean(axis=(0, 1)).sum() / 3.0
    table = gp.analysis.by_species(driven, about="rest")
    assert float(table.temperature[0]) == pytest.approx(exact, rel=1e-6)
    assert float(gp.measure(driven, "vacf", about="rest").estimate[0]) == pytest.approx(exact, rel=1e-3)
    profile = gp.measure(driven, "temperature", axis="x", about="rest")
    assert np.nanmean(profile.estimate) > 1.1 * float(gp.analysis.by_species(driven).temperature[0])


def test_momentum_is_kept_about_rest_and_has_no_theory(tmp_path):
    """Without a flow both differ by the motion of the centre of mass alone: by (N - 1) / N if it rests."""
    gas = gp.Species(32, 0.3, temperature=1.0, exact_temperature=True)
    scene = gp.Scene(gp.Container((6.0, 6.0, 6.0), "periodic"), [gas])
    path = gp.run(scene, gp.EventDriven(), 1, 40.0, 0.25, tmp_path / "a.nc")
    flow, rest = (gp.measure(path, "msd", about=about) for about in ("flow", "rest"))
    np.testing.assert_allclose(rest.estimate[1:], flow.estimate[1:] * 31.0 / 32.0, rtol=1e-6)
    assert flow.theory is not None and rest.theory is None


@pytest.mark.thorough
def test_a_flow_that_changes_has_no_displacements_about_it(tmp_path):
    gas = gp.Species(32, 0.1, temperature=1.0)
    scene = gp.Scene(gp.Container((8.0, 6.0), ("wall", "periodic")), [gas])
    moved = gp.Scene(scene.container, [gas], faces={"x_low": gp.Vibrating(0.2, 1.0)})
    path = gp.run(moved, gp.EventDriven(), 1, 20.0, 0.25, tmp_path / "a.nc")
    with pytest.raises(gp.SceneError, match='about a flow that changes .*; pass about="rest"'):
        gp.measure(path, "msd")
    assert np.isfinite(gp.measure(path, "msd", about="rest").estimate).all()


def test_motion_is_about_the_flow_or_about_rest(couette):
    with pytest.raises(gp.SceneError, match="about = 'walls': must be one of"):
        gp.measure(couette, "msd", about="walls")


@pytest.mark.interpreted
@pytest.mark.parametrize("dimension", [2, 3])
def test_between_sheared_images_it_is_about_the_flow(tmp_path, dimension):
    """Points in the flow u_x = rate y: their c_x = v_x - u_x falls by rate c_y t, as they never collide."""
    rate, count, box = 0.6, 64, gp.Container((20.0,) * dimension, "periodic")
    faces = {"y_high": gp.LeesEdwards(rate)}
    scene = gp.Scene(box, [gp.Species(count, 1e-7, temperature=1.0)], faces=faces)
    start = gp.Simulation(scene, seed=1).initial_state
    path = gp.run(scene, gp.EventDriven(), 1, 4.0, 0.05, tmp_path / "run.nc")
    c = start.velocities.copy()
    c[:, 0] -= rate * (start.positions[:, 1] - 10.0)
    c -= c.mean(axis=0)
    later = c[:, 0] - rate * c[:, 1] * 0.05 * np.arange(81)[:, None]
    square = (later**2).mean() + (c[:, 1:] ** 2).sum() / count  # of the velocity about the flow
    for axis in "xyz"[:dimension]:
        found = {of: A.profile(path, of, axis, bins=4, start=0.0) for of in ("density", "temperature")}
        density, temperature = (found[of].estimate.values for of in found)
        assert density.mean() == pytest.approx(scene.number_density, rel=1e-12)
        mean = (density * temperature).sum() / density.sum()
        assert mean == pytest.approx(square / dimension * count / (count - 1.0), rel=1e-5)
        assert found["temperature"].theory is None
    speeds = A.speed_distribution(path, bins=400, start=0.0, fastest=20.0)
    middle, width = speeds["speed"].values, 0.05
    second = (speeds.estimate.values * middle**2).sum() * width
    assert second == pytest.approx(square * count / (count - 1.0), rel=2e-3) and speeds.theory is None
