"""Displacement and diffusion along each axis."""

import numpy as np
import pytest
from scenes import gas

import gaspart as gp


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    return gp.run(gas(3, 256, 0.2), gp.EventDriven(), 4, 60.0, 0.25, folder / "run.nc", displacements=True)


def test_displacements_along_axes_sum_to_the_whole(path):
    whole = gp.analysis.mean_squared_displacement(path, lags=20)
    found = gp.analysis.mean_squared_displacement(path, lags=20, per_axis=True)
    assert found.estimate.dims == ("axis", "lag") and list(found["axis"].values) == ["x", "y", "z"]
    assert np.allclose(found.estimate.sum("axis"), whole.estimate, rtol=1e-10)
    assert np.allclose(found.theory.sum("axis"), whole.theory)
    with gp.open_trajectory(path) as data:
        moved = data["displacements"].values[60:]
    moved = moved - moved.mean(axis=1, keepdims=True)  # about the centre of mass
    lag = ((moved[5:] - moved[:-5]) ** 2).mean(axis=(0, 1)) * 256 / 255
    assert np.allclose(found.estimate.isel(lag=5), lag, rtol=1e-6)


def test_diffusion_along_axes_has_the_mean_of_all_and_agrees_with_theory(path):
    whole = gp.analysis.diffusion_coefficient(path)
    found = gp.analysis.diffusion_coefficient(path, per_axis=True)
    assert found.estimate.dims == ("axis",) and found.estimate.size == 3
    assert float(found.estimate.mean()) == pytest.approx(float(whole.estimate), rel=1e-10)
    assert (abs(found.deviation) < 4.0).all()
    assert (found.error > whole.error).all()


def test_a_slit_bounds_one_axis(tmp_path):
    """Between walls displacements are bounded, along the periodic axis they are not."""
    scene = gp.Scene(gp.Container((8.0, 8.0, 3.0), ("periodic", "periodic", "wall")), gas(3, 60, 0.2).species)
    path = gp.run(scene, gp.EventDriven(), 4, 40.0, 0.25, tmp_path / "slit.nc", displacements=True)
    last = gp.analysis.mean_squared_displacement(path, lags=60, per_axis=True).estimate.isel(lag=-1)
    assert float(last.sel(axis="z")) < 2.0**2 < float(last.sel(axis="x"))
