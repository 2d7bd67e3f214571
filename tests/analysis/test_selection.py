"""Observables of one species, or of some particles."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.cli import main

A = gp.analysis
SIDE = 9.0
NAME = "diffusion_coefficient"


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A heavy sphere, 60 light and 60 heavier ones in a periodic cube."""
    kinds = [
        gp.Species(60, 0.5, temperature=1.0),
        gp.Species(60, 0.5, mass=4.0, temperature=1.0),
    ]
    alone = gp.Particle((4.5, 4.5, 4.5), (0.1, 0.0, 0.0), 0.5, mass=20.0)
    scene = gp.Scene(gp.Container((SIDE,) * 3, "periodic"), kinds, [alone])
    folder = tmp_path_factory.mktemp("selected")
    return gp.run(scene, gp.EventDriven(), 1, 100.0, 0.25, folder / "run.nc", displacements=True)


def test_short_times_have_the_thermal_speed_of_the_species(path):
    for species, mass in ((0, 1.0), (1, 4.0)):
        found = A.velocity_autocorrelation(path, lags=4, species=species)
        assert float(found.estimate[0]) == pytest.approx(1.0 / mass, rel=0.1)
    light, heavy = (float(A.diffusion_coefficient(path, species=k).estimate) for k in (0, 1))
    assert light > heavy > 0.0


def test_a_selection_is_the_mean_of_its_parts(path):
    light, heavy = range(1, 49), range(61, 109)
    parts = [A.mean_squared_displacement(path, lags=16, particles=one).estimate for one in (light, heavy)]
    both = A.mean_squared_displacement(path, lags=16, particles=[*light, *heavy])
    np.testing.assert_allclose(both.estimate, 0.5 * (parts[0] + parts[1]), rtol=1e-9)


def test_one_particle_has_an_error_from_stretches_of_the_run(path):
    found = A.mean_squared_displacement(path, lags=8, particles=[0])
    assert found.estimate.equals(A.mean_squared_displacement(path, lags=8, species=2).estimate)
    assert (found.error[1:] > 0.0).all()
    with gp.open_trajectory(path) as data:
        last = data.isel(frame=slice(100, None))
        moved = last["displacements"].values
        masses = np.r_[20.0, np.ones(60), np.full(60, 4.0)]
    centre = np.einsum("tnd,n->td", moved, masses) / masses.sum()
    way = np.diff(moved[:, 0] - centre, axis=0) / np.sqrt(1.0 - 20.0 / masses.sum())
    assert float(found.estimate[1]) == pytest.approx((way**2).sum(axis=1).mean(), rel=0.1)


@pytest.mark.parametrize(
    ("function", "selection", "line"),
    [
        ("mean_squared_displacement", {"species": 3}, "species = 3: there are 3, numbered from 0"),
        ("mean_squared_displacement", {"particles": [121]}, "particles = 121: there are 121"),
        ("velocity_autocorrelation", {"species": 0, "particles": [1]}, "species = 0: excludes particles"),
        ("diffusion_coefficient", {"species": 2}, "must cover 768 collisions of a particle"),
        ("diffusion_coefficient", {"species": 0, "lag": 0.1}, "lag = 0.1: must be between 0.25, the"),
        ("diffusion_coefficient", {"species": 0, "lag": 80.0}, "lag = 80.0: must be between"),
        ("mean_squared_displacement", {"particles": []}, "none of them moves"),
    ],
)
def test_a_mistake_is_one_line(path, function, selection, line):
    with pytest.raises(gp.SceneError, match=line):
        getattr(A, function)(path, **selection)


def test_the_command_line_selects(path, capsys):
    assert main(["measure", str(path), "msd", "D", "--species", "1"]) == 0
    assert "D = " in capsys.readouterr().out
    assert main(["measure", str(path), "msd", "--particles", "0,1"]) == 0
    assert main(["measure", str(path), "Z", "--species", "1"]) == 2
    assert "cannot be chosen for Z, only for msd, D, vacf" in capsys.readouterr().err


def test_tracers_have_the_diffusion_of_all_with_the_error_of_one(tmp_path):
    """Each of 32 spheres by itself: their mean is D, and they scatter by what each states."""
    scene = gp.Scene(gp.Container((4.0,) * 3, "periodic"), [gp.Species(32, 0.5, temperature=1.0)])
    path = gp.run(scene, gp.EventDriven(), 1, 600.0, 0.5, tmp_path / "run.nc", displacements=True)
    with gp.open_trajectory(path) as data:
        run = data.load()
    for lag in (None, 2.0):
        each = [A.diffusion_coefficient(run, particles=[n], lag=lag) for n in range(32)]
        values, errors = (np.array([float(one[key]) for one in each]) for key in (NAME, f"{NAME}_error"))
        whole = float(A.diffusion_coefficient(run, lag=lag).estimate)
        assert values.mean() == pytest.approx(whole, abs=3.0 * values.std(ddof=1) / 32**0.5)
        square = (((values - whole) / errors) ** 2).mean()
        assert square == pytest.approx(15.0 / 13.0, abs=3.0 * 0.45)  # Student's of 15 degrees of freedom


def test_at_a_lag_it_is_the_slope_of_the_displacement(path):
    found = A.diffusion_coefficient(path, species=0, lag=0.5, per_axis=True)
    moved = A.mean_squared_displacement(path, species=0, lags=4, per_axis=True).estimate
    np.testing.assert_allclose(found.estimate, (moved[:, 3] - moved[:, 1]) / (4.0 * 0.25), rtol=1e-9)
    assert "at the lag 0.5" in found.estimate.attrs["long_name"]
