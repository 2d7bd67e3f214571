"""Columns under gravity: made-up stretches with known answers."""

import numpy as np
import pytest
import xarray as xr

import gaspart as gp
from gaspart.reproduction.figures import _columns, gravity
from gaspart.reproduction.figures._columns import Field, Stretch
from gaspart.reproduction.points.point import Point


def one_frame(masses, heights, height, diameter):
    """The field of discs of these masses, and a stretch of one frame of them."""
    masses = np.array(masses)
    place = Field(1.0, 3.0, height, diameter, masses, (masses > 1.0).astype(int), False)
    positions = np.stack([np.ones(masses.size), heights], axis=-1)[None]
    return place, Stretch(positions, np.ones((1, masses.size)), 2.0 + place.weight, 2.0, 0.0, 1.0)


def test_the_pressure_is_the_mean_over_each_bin_of_the_weight_above():
    place, stretch = one_frame([1.0, 1.0, 4.0], [0.5, 1.0, 3.25], 4.0, 0.01)
    *_, pressure = _columns.profile(place, stretch, 2)
    # Below 0.5 all six of mass are above; from 3.25 on nothing is.
    above = pressure * place.width - stretch.ceiling
    assert above == pytest.approx([(0.5 * 6 + 0.5 * 5 + 1.0 * 4) / 2.0, 1.25 * 4 / 2.0])


@pytest.fixture
def source_column(tmp_path):
    """A point of a mixture whose sample begins at 10."""
    scene = gp.Scene(
        gp.Container((6.0, 12.0)),
        [gp.Species(20, 0.1, speed=1.0), gp.Species(20, 0.1, mass=3.0, speed=1.0)],
        gravity=(0.0, -0.2),
    )
    scene.to_file(tmp_path / "scene.yaml")
    settings = {"duration": 40.0, "samples": 20, "equilibration": 10.0, "scene": str(tmp_path / "scene.yaml")}
    return Point("column", "single", "simulate", settings, "results/points", 1)


def test_the_oscillation_that_is_left_where_the_sample_begins(source_column, monkeypatch):
    time = np.arange(0.0, 13.0, 0.1)
    noise = np.random.default_rng(1).normal(0.0, 0.002, time.size)
    kinetic = 50.0 * (1.0 + 0.2 * np.exp(-time / 5.0) * np.cos(4.0 * time + 1.0) + noise)
    monkeypatch.setattr(
        gravity,
        "open_trajectory",
        lambda path: xr.Dataset({"time": ("frame", time), "kinetic_energy": ("frame", kinetic)}),
    )
    found = gravity.ringing(source_column)["ringing"]
    assert abs(found.value - 0.2 * np.exp(-2.0)) < 4.0 * found.error
    assert 0.0001 < found.error < 0.002
    assert found.freedom == np.sum(time > 3.0) - 5


def test_shares_of_the_light_discs_in_layers_of_the_container(source_column, monkeypatch):
    place, sample = one_frame([1.0, 1.0, 1.0, 3.0], [0.1, 0.2, 3.0, 0.3], 3.8, 0.2)  # in a container 4 high
    monkeypatch.setattr(gravity, "field", lambda point: place)
    monkeypatch.setattr(gravity, "stretches", lambda point, number: [sample])
    share, error = gravity.layer_fractions(source_column, 2)["share"]
    assert share == pytest.approx([2.0 / 3.0, 1.0])
    assert error == pytest.approx([np.sqrt(2.0 / 27.0), 0.0])
    sample.positions[0, 3, 1] = 1.95  # just above the middle of the container
    assert gravity.layer_fractions(source_column, 2)["share"][0] == pytest.approx([1.0, 0.5])
