"""The table of all observables of each species."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.analysis.observables import observables_with, selecting

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


def test_a_row_for_each_species_that_moves(table):
    assert table["species"].values.tolist() == [0, 1, 3]
    assert table["count"].values.tolist() == [100, 40, 1]
    rows = table[["count", "temperature", "temperature_error", "mean_speed", "D", "D_error"]].to_dataframe()
    assert rows.index.tolist() == [0, 1, 3] and rows["D"].notna().tolist() == [True, True, False]
    assert "D of species 3: must cover 768 collisions of a particle or more" in table.attrs["not_measured"]
    assert all("units" in table[name].attrs for name in table.data_vars)


def test_what_accepts_a_species_has_its_value_there(path, table):
    motion = [name for name in selecting("species") if name in observables_with(scatter="particles")]
    assert {"D", "msd", "vacf"} <= set(motion)
    for name in motion:
        found = gp.analysis.measuring.measure(path, name, species=1)
        assert np.array_equal(table[name].sel(species=1), found.estimate)
        assert np.array_equal(table[f"{name}_error"].sel(species=1), found.error)
        assert table[name].attrs["units"] == found.estimate.attrs["units"]


def test_temperatures_and_speeds_agree_with_equipartition(path, table):
    with gp.open_trajectory(path) as run:
        whole = float((run["kinetic_energy"][60:] * 2 / (3 * 141)).mean())
    off = (table["temperature"] - whole) / table["temperature_error"]
    assert (abs(off) < 4.0).all() and (table["temperature_error"] > 0.0).all()
    theory = np.sqrt(8.0 * whole / (np.pi * np.array([1.0, 4.0, 20.0])))
    assert (abs(table["mean_speed"] - theory) < 4.0 * table["mean_speed_error"]).all()
    assert table["mean_speed_error"].sel(species=0) < 0.05


def test_a_condition_of_momentum_is_allowed_for(tmp_path):
    """Of two particles of masses 1 and 9 the light one has 0.9 of the energy at any time, at equal
    temperatures."""
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
