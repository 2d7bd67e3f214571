"""Columns under gravity: made-up stretches, and short runs, with known answers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from reproduction.made import simulated

import gaspart as gp
from gaspart.reproduction.figures import _columns, gravity
from gaspart.reproduction.figures._columns import Field, Stretch
from gaspart.reproduction.points.point import Point
from gaspart.theory.gravity import ideal_profile


def point(scene_file, **settings):
    """One point of a grid that has a scene file; nothing of it is run."""
    settings = {"scene": str(scene_file), "duration": 40.0, "samples": 20, "equilibration": 10.0} | settings
    return Point("column", "single", "simulate", settings, "results/points", 1)


def ideal_column(rng, frames, masses, height=4.0, width=3.0, strength=1.0, temperature=1.0):
    """An ideal gas: its field, and a stretch of independent frames of it."""
    masses = np.asarray(masses, dtype=float)
    weights = masses * strength / temperature
    chance = rng.random((frames, masses.size)) * -np.expm1(-weights * height)
    heights = -np.log1p(-chance) / weights
    across = width * rng.random(heights.shape)
    energies = temperature * rng.exponential(size=heights.shape)
    ceiling = temperature * sum(
        ideal_profile(height, height, weight) for weight in weights
    )  # the pressure there times the width
    place = Field(strength, width, height, 0.01, masses, (masses > masses.min()).astype(int), False)
    floor = float(ceiling + place.weight)
    return place, Stretch(
        np.stack([across, heights], axis=-1), energies, floor, float(ceiling), 0.0, temperature
    )


SETTINGS = {"bins": 8, "blocks": 4, "clear": 0.5, "ranges": [[0.001, 0.01]]}
SETTINGS |= {"source_collisions": 100.0, "source_temperature": 1.0, "source_shares": [0.5]}
SETTINGS |= {"columns": {"source": "column_source"}}


def test_the_profile_of_an_ideal_column_is_barometric():
    place, stretch = ideal_column(np.random.default_rng(1), 400, np.ones(100))
    density, energy, pressure = _columns.profile(place, stretch, 8)
    edges = np.linspace(0.0, 4.0, 9)
    fine = ideal_profile(np.linspace(0.0, 4.0, 8001)[:-1] + 0.25e-3, 4.0, 1.0).reshape(8, 1000).mean(axis=1)
    expected = 100.0 * fine / 3.0
    error = expected / np.sqrt(expected * 400 * 3.0 * np.diff(edges))
    assert np.all(np.abs(density[0] - expected) < 4.0 * error)
    assert energy / density[0] == pytest.approx(np.ones(8), abs=0.05)
    assert pressure == pytest.approx(expected, rel=0.03)  # rho kT, T = 1
    assert stretch.energies.mean() == pytest.approx(1.0, abs=0.02)


def test_the_pressure_is_the_mean_over_each_bin_of_the_weight_above():
    place, stretch = ideal_column(np.random.default_rng(2), 1, [1.0, 1.0, 4.0])
    stretch.positions[0, :, 1] = [0.5, 1.0, 3.25]
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
    return point(tmp_path / "scene.yaml")


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
    place, sample = ideal_column(np.random.default_rng(2), 1, [1.0, 1.0, 1.0, 3.0])
    place = replace(place, diameter=0.2, height=3.8)  # the container is 4 high
    sample.positions[0, :, 1] = [0.1, 0.2, 3.0, 0.3]
    monkeypatch.setattr(gravity, "field", lambda point: place)
    monkeypatch.setattr(gravity, "stretches", lambda point, number: [sample])
    share, error = gravity.layer_fractions(source_column, 2)["share"]
    assert share == pytest.approx([2.0 / 3.0, 1.0])
    assert error == pytest.approx([np.sqrt(2.0 / 27.0), 0.0])
    sample.positions[0, 3, 1] = 1.95  # just above the middle of the container
    assert gravity.layer_fractions(source_column, 2)["share"][0] == pytest.approx([1.0, 0.5])


@pytest.mark.thorough
def test_only_the_source_s_own_run_is_compared_with_its_numbers(source_column, tmp_path):
    settings = SETTINGS | {"blocks": 2, "source_shares": [0.5] * 3}
    own = replace(source_column, experiment="column_source")
    made = [simulated(replace(point, root=str(tmp_path))) for point in (source_column, own)]
    ds = gravity.measure_two_kinds(made, settings)
    assert np.isnan(ds["collisions"][0]) and np.isnan(ds["share"][0]).all()
    sim = gp.Simulation(own.scene, own.engine, seed=own.seed(0))
    sim.advance(duration=10.0)
    assert ds["collisions"][1] == sim.tally.collisions + sim.tally.wall_hits.sum() > 0
    assert ds["share"][1].sizes == {"layer": 3} and np.isfinite(ds["share"][1]).any()
    assert ds.attrs["source_shares"] == [0.5] * 3 and ds.attrs["source_collisions"] == 100.0
