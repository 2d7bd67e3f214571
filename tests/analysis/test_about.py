"""The rule of motion: temperature, speeds, msd, vacf and D are about one flow, or about rest."""

import numpy as np
import pytest

import gaspart as gp

CHANNEL = gp.Container((6.0, 8.0, 8.0), ("wall", "periodic", "periodic"))
PLATES = {"x_low": gp.Thermal(1.0), "x_high": gp.Thermal(1.0)}


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    """Spheres that a force drives along thermal plates."""
    scene = gp.Scene(CHANNEL, [gp.Species(60, 0.5, temperature=1.0)], gravity=(0.0, 0.2, 0.0), faces=PLATES)
    path = tmp_path_factory.mktemp("driven") / "a.nc"
    return gp.run(scene, gp.EventDriven(), 1, 150.0, 0.25, path, displacements=True)


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


def test_half_the_slope_of_displacements_is_the_integral_of_velocities(driven):
    """The slope of msd is 2 d times the integral of vacf, both about the flow."""
    msd = gp.measure(driven, "msd").estimate
    vacf = gp.measure(driven, "vacf").estimate
    lags = msd.lag.values
    middle = int(np.searchsorted(lags, 3.0))
    slope = float(msd[middle + 1] - msd[middle - 1]) / (lags[middle + 1] - lags[middle - 1]) / 6.0
    integral = float(vacf[: middle + 1].integrate("lag"))
    assert slope == pytest.approx(integral, rel=0.05)


def test_all_observables_of_motion_are_about_the_same_flow(driven):
    first = float(gp.measure(driven, "vacf").estimate[0])
    table = gp.analysis.by_species(driven)
    assert first == pytest.approx(float(table.temperature[0]), rel=1e-6)
    assert first == pytest.approx(float(table.vacf[0, 0]), rel=1e-6)
    speeds = gp.measure(driven, "speeds")
    square = float((speeds.estimate * speeds.speed**2).sum() * np.diff(speeds.speed)[0])
    assert square / 3.0 == pytest.approx(first, rel=0.02)


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


def test_a_flow_that_changes_has_no_displacements_about_it(tmp_path):
    gas = gp.Species(32, 0.1, temperature=1.0)
    scene = gp.Scene(gp.Container((8.0, 6.0), ("wall", "periodic")), [gas])
    moved = gp.Scene(scene.container, [gas], faces={"x_low": gp.Vibrating(0.2, 1.0)})
    path = gp.run(moved, gp.EventDriven(), 1, 20.0, 0.25, tmp_path / "a.nc")
    with pytest.raises(gp.SceneError, match='about a flow that changes .*; pass about="rest"'):
        gp.measure(path, "msd")
    assert np.isfinite(gp.measure(path, "msd", about="rest").estimate).all()


def test_motion_is_about_the_flow_or_about_rest(driven):
    with pytest.raises(gp.SceneError, match="about = 'walls': must be one of"):
        gp.measure(driven, "msd", about="walls")
