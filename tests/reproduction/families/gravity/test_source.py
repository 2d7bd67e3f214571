from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from reproduction.families.gravity.data import ideal_column, point
from reproduction.families.gravity.test_measure import SETTINGS, run

import gaspart as gp
from gaspart.reproduction.families.gravity import measure


@pytest.fixture
def column(tmp_path):
    """A point of a mixture whose sample begins at 10."""
    scene = gp.Scene(
        gp.Container((6.0, 12.0)),
        [gp.Species(20, 0.1, speed=1.0), gp.Species(20, 0.1, mass=3.0, speed=1.0)],
        gravity=(0.0, -0.2),
    )
    scene.to_file(tmp_path / "scene.yaml")
    return point(tmp_path / "scene.yaml")


def test_the_oscillation_that_is_left_where_the_sample_begins(column, monkeypatch):
    time = np.arange(0.0, 13.0, 0.1)
    noise = np.random.default_rng(1).normal(0.0, 0.002, time.size)
    kinetic = 50.0 * (1.0 + 0.2 * np.exp(-time / 5.0) * np.cos(4.0 * time + 1.0) + noise)
    monkeypatch.setattr(
        measure,
        "open_trajectory",
        lambda path: xr.Dataset({"time": ("frame", time), "kinetic_energy": ("frame", kinetic)}),
    )
    found = measure.ringing(column)["ringing"]
    assert abs(found.value - 0.2 * np.exp(-2.0)) < 4.0 * found.error
    assert 0.0001 < found.error < 0.002
    assert found.freedom == np.sum(time > 3.0) - 5


def test_shares_of_the_light_discs_in_layers_of_the_container(column, monkeypatch):
    place, sample = ideal_column(np.random.default_rng(2), 1, [1.0, 1.0, 1.0, 3.0])
    place = replace(place, diameter=0.2, height=3.8)  # the container is 4 high
    sample.positions[0, :, 1] = [0.1, 0.2, 3.0, 0.3]
    monkeypatch.setattr(measure, "field", lambda point: place)
    monkeypatch.setattr(measure, "stretches", lambda point, number: [sample])
    share, error = measure.layer_fractions(column, 2)["share"]
    assert share == pytest.approx([2.0 / 3.0, 1.0])
    assert error == pytest.approx([np.sqrt(2.0 / 27.0), 0.0])
    sample.positions[0, 3, 1] = 1.95  # just above the middle of the container
    assert measure.layer_fractions(column, 2)["share"][0] == pytest.approx([1.0, 0.5])


def test_only_the_source_s_own_run_is_compared_with_its_numbers(column, tmp_path):
    settings = SETTINGS | {"blocks": 2, "source_shares": [0.5] * 3}
    own = replace(column, experiment="column_source")
    made = [run(p, tmp_path) for p in (column, own)]
    ds = measure.separation(made, settings)
    assert np.isnan(ds["collisions"][0]) and np.isnan(ds["share"][0]).all()
    sim = gp.Simulation(own.scene, own.engine, seed=own.seed(0))
    sim.advance(duration=10.0)
    assert ds["collisions"][1] == sim.tally.collisions + sim.tally.wall_hits.sum() > 0
    assert ds["share"][1].sizes == {"layer": 3} and np.isfinite(ds["share"][1]).any()
    assert ds.attrs["source_shares"] == [0.5] * 3 and ds.attrs["source_collisions"] == 100.0
