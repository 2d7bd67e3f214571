"""The table of all observables of each species."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.observables import observables_with, selecting
from gaspart.cli import main

SCENE = gp.Scene(
    gp.Container((9.0, 9.0, 9.0), "periodic"),
    [
        gp.Species(100, 0.5, mass=1.0, temperature=1.0),
        gp.Species(40, 0.5, mass=4.0, temperature=1.0),
        gp.Species(2, 0.5, fixed=True),
    ],
    particles=[gp.Particle((4.5, 4.5, 4.5), (0.0, 0.0, 0.0), 1.0, mass=20.0)],
)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    folder = tmp_path_factory.mktemp("species")
    return gp.run(SCENE, gp.EventDriven(), 3, 60.0, 0.25, folder / "run.nc", displacements=True)


@pytest.fixture(scope="module")
def table(path):
    return gp.analysis.by_species(path)


@pytest.mark.thorough
def test_a_row_for_each_species_that_moves(table):
    assert table["species"].values.tolist() == [0, 1, 3]
    assert table["count"].values.tolist() == [100, 40, 1]
    rows = table[["count", "temperature", "temperature_error", "mean_speed", "D", "D_error"]].to_dataframe()
    assert rows.index.tolist() == [0, 1, 3] and rows["D"].notna().tolist() == [True, True, False]
    assert "D of species 3: must cover 768 collisions of a particle or more" in table.attrs["not_measured"]
    assert all("units" in table[name].attrs for name in table.data_vars)


@pytest.mark.thorough
def test_what_accepts_a_species_has_its_value_there(path, table):
    motion = [name for name in selecting("species") if name in observables_with(scatter="particles")]
    assert {"D", "msd", "vacf"} <= set(motion)
    for name in motion:
        found = gp.analysis.measuring.measure(path, name, species=1)
        assert np.array_equal(table[name].sel(species=1), found.estimate)
        assert np.array_equal(table[f"{name}_error"].sel(species=1), found.error)
        assert table[name].attrs["units"] == found.estimate.attrs["units"]


@pytest.mark.thorough
def test_temperatures_and_speeds_agree_with_equipartition(path, table):
    with gp.open_trajectory(path) as run:
        whole = float((run["kinetic_energy"][60:] * 2 / (3 * 141)).mean())
    off = (table["temperature"] - whole) / table["temperature_error"]
    assert (abs(off) < 4.0).all() and (table["temperature_error"] > 0.0).all()
    theory = np.sqrt(8.0 * whole / (np.pi * np.array([1.0, 4.0, 20.0])))
    assert (abs(table["mean_speed"] - theory) < 4.0 * table["mean_speed_error"]).all()
    assert table["mean_speed_error"].sel(species=0) < 0.05


def test_a_condition_of_momentum_is_allowed_for(tmp_path):
    """Of two particles of masses 1 and 9 the light one has 0.9 of the energy, at equal temperatures."""
    kinds = [gp.Species(1, 0.5, mass=1.0, temperature=1.0), gp.Species(1, 0.5, mass=9.0, temperature=1.0)]
    scene = gp.Scene(gp.Container((6.0, 6.0, 6.0), "periodic"), kinds)
    path = gp.run(scene, gp.EventDriven(), 1, 200.0, 0.25, tmp_path / "two.nc")
    with gp.open_trajectory(path) as run:
        light, heavy = run["velocities"].values[-1].astype(float)
    expected = 0.9 * ((light - heavy) ** 2).sum() / 3.0
    table = gp.analysis.by_species(path)
    assert np.allclose(table["temperature"], expected, rtol=1e-5)
    assert "D" not in table and "D of species 0" in table.attrs["not_measured"]


def test_a_simulation_and_what_does_not_move():
    walls = gp.Scene(gp.Container((12.0, 12.0)), [gp.Species(40, 0.5, temperature=1.0)])
    sim = gp.Simulation(walls, gp.EventDriven(), 1)
    sim.advance(duration=40.0)
    found = gp.analysis.by_species(sim)
    assert (
        "container.boundary" not in found.attrs["not_measured"]
        and "no periodic axis" in found.attrs["not_measured"]
    )
    assert float(found["temperature"][0]) == pytest.approx((sim.state.velocities**2).mean(), rel=1e-5)


# Observables of one species, or of some particles.


A = gp.analysis
SIDE = 9.0
NAME = "diffusion_coefficient"


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """A heavy sphere, 60 light and 60 heavier ones in a periodic cube."""
    kinds = [gp.Species(60, 0.5, temperature=1.0), gp.Species(60, 0.5, mass=4.0, temperature=1.0)]
    alone = gp.Particle((4.5, 4.5, 4.5), (0.1, 0.0, 0.0), 0.5, mass=20.0)
    scene = gp.Scene(gp.Container((SIDE,) * 3, "periodic"), kinds, [alone])
    folder = tmp_path_factory.mktemp("selected")
    return gp.run(scene, gp.EventDriven(), 1, 100.0, 0.25, folder / "run.nc", displacements=True)


def test_a_selection_is_the_mean_of_its_parts(file):
    light, heavy = range(1, 49), range(61, 109)
    parts = [A.mean_squared_displacement(file, lags=16, particles=one).estimate for one in (light, heavy)]
    both = A.mean_squared_displacement(file, lags=16, particles=[*light, *heavy])
    np.testing.assert_allclose(both.estimate, 0.5 * (parts[0] + parts[1]), rtol=1e-9)


def test_one_particle_has_an_error_from_stretches_of_the_run(file):
    found = A.mean_squared_displacement(file, lags=8, particles=[0])
    assert found.estimate.equals(A.mean_squared_displacement(file, lags=8, species=2).estimate)
    assert (found.error[1:] > 0.0).all()
    with gp.open_trajectory(file) as data:
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
def test_a_mistake_is_one_line(file, function, selection, line):
    with pytest.raises(gp.SceneError, match=line):
        getattr(A, function)(file, **selection)


def test_the_command_line_selects(file, capsys):
    assert main(["measure", str(file), "msd", "D", "--species", "1"]) == 0
    assert "D = " in capsys.readouterr().out
    assert main(["measure", str(file), "msd", "--particles", "0,1"]) == 0
    assert main(["measure", str(file), "Z", "--species", "1"]) == 2
    assert "cannot be chosen for Z, only for msd, D, vacf" in capsys.readouterr().err


def test_tracers_have_the_diffusion_of_all_with_the_error_of_one(tmp_path):
    """Each of 32 spheres by itself: their mean is D, and they scatter by what each states."""
    scene = gp.Scene(gp.Container((4.0,) * 3, "periodic"), [gp.Species(32, 0.5, temperature=1.0)])
    file = gp.run(scene, gp.EventDriven(), 1, 600.0, 0.5, tmp_path / "run.nc", displacements=True)
    with gp.open_trajectory(file) as data:
        run = data.load()
    for lag in (None, 2.0):
        each = [A.diffusion_coefficient(run, particles=[n], lag=lag) for n in range(32)]
        values, errors = (np.array([float(one[key]) for one in each]) for key in (NAME, f"{NAME}_error"))
        whole = float(A.diffusion_coefficient(run, lag=lag).estimate)
        assert values.mean() == pytest.approx(whole, abs=3.0 * values.std(ddof=1) / 32**0.5)
        square = (((values - whole) / errors) ** 2).mean()
        assert square == pytest.approx(15.0 / 13.0, abs=3.0 * 0.45)  # Student's of 15 degrees of freedom


def test_at_a_lag_it_is_the_slope_of_the_displacement(file):
    found = A.diffusion_coefficient(file, species=0, lag=0.5, per_axis=True)
    moved = A.mean_squared_displacement(file, species=0, lags=4, per_axis=True).estimate
    np.testing.assert_allclose(found.estimate, (moved[:, 3] - moved[:, 1]) / (4.0 * 0.25), rtol=1e-9)
    assert "at the lag 0.5" in found.estimate.attrs["long_name"]
