from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from reproduction.families.gravity.data import ideal_column, point
from reproduction.families.stored import runs_of

import gaspart as gp
from gaspart.reproduction.families.gravity import measure as gravity
from gaspart.reproduction.families.shared import columns
from gaspart.theory.gravity import ideal_profile

SETTINGS = {"bins": 8, "blocks": 4, "clear": 0.5, "ranges": [[0.001, 0.01]]}
SETTINGS |= {"source_collisions": 100.0, "source_temperature": 1.0, "source_shares": [0.5]}
SETTINGS |= {"columns": {"source": "column_source"}}


def run(point, root):
    """The point with its simulations made."""
    made = replace(point, root=str(root))
    times = made.schedule
    for k, path in enumerate(made.replica_paths):
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        scene, engine = made.scene, made.engine
        gp.run(scene, engine, made.seed(k), times.duration, times.sample_interval, path)
    return made


def test_the_profile_of_an_ideal_column_is_barometric():
    place, stretch = ideal_column(np.random.default_rng(1), 400, np.ones(100))
    profile = columns.profile(place, stretch, 8)
    edges = np.linspace(0.0, 4.0, 9)
    fine = ideal_profile(np.linspace(0.0, 4.0, 8001)[:-1] + 0.25e-3, 4.0, 1.0).reshape(8, 1000).mean(axis=1)
    expected = 100.0 * fine / 3.0
    error = expected / np.sqrt(expected * 400 * 3.0 * np.diff(edges))
    assert np.all(np.abs(profile.density[0] - expected) < 4.0 * error)
    assert profile.temperature == pytest.approx(np.ones(8), abs=0.05)
    assert profile.pressure == pytest.approx(expected, rel=0.03)  # rho kT, T = 1
    assert stretch.energies.mean() == pytest.approx(1.0, abs=0.02)


def test_the_pressure_is_the_mean_over_each_bin_of_the_weight_above():
    place, stretch = ideal_column(np.random.default_rng(2), 1, [1.0, 1.0, 4.0])
    stretch.positions[0, :, 1] = [0.5, 1.0, 3.25]
    pressure = columns.profile(place, stretch, 2).pressure * place.width - stretch.ceiling
    # Below 0.5 all six of mass are above; from 3.25 on nothing is.
    assert pressure == pytest.approx([(0.5 * 6 + 0.5 * 5 + 1.0 * 4) / 2.0, 1.25 * 4 / 2.0])


@pytest.mark.parametrize("boundary", ["wall", "periodic"])
def test_a_column_of_two_kinds_balances_and_separates(tmp_path, boundary):
    scene = gp.Scene(
        gp.Container((6.0, 12.0), (boundary, "wall")),
        [gp.Species(40, 0.05, temperature=0.5), gp.Species(40, 0.05, mass=3.0, temperature=0.5)],
        gravity=(0.0, -0.2),
    )
    scene.to_file(tmp_path / "scene.yaml")
    made = run(point(tmp_path / "scene.yaml", duration=2000.0, equilibration=400.0, samples=400), tmp_path)
    ds = gravity.separation([made], SETTINGS | {"blocks": 10}).isel(point=0)
    assert float(ds["imbalance"]) < 1e-9
    assert float(ds["range_ratio"][0]) == pytest.approx(1.0, abs=0.1)
    for name in ("slope_ratio", "exchange_ratio", "mean_height_ratio", "species_temperature_ratio"):
        error = ds[f"{name}_error"].values
        assert np.all(error < 0.15), name
        assert np.all(np.abs(ds[name].values - 1.0) < 4.5 * error + 0.02), name
    assert float(ds["density"].sel(species=1)[0]) > 2.0 * float(ds["density"].sel(species=1)[-1])


def test_fewer_frames_than_stretches_are_refused(tmp_path):
    scene = gp.Scene(gp.Container((4.0, 4.0)), [gp.Species(5, 0.1, temperature=1.0)], gravity=(0.0, -1.0))
    scene.to_file(tmp_path / "scene.yaml")
    made = run(point(tmp_path / "scene.yaml", samples=3, duration=3.0, equilibration=0.0), tmp_path)
    with pytest.raises(ValueError, match="blocks: 4"):
        gravity.barometric([made], SETTINGS)


@pytest.fixture
def boxes(tmp_path, monkeypatch):
    """Pairs of points with made-up kinetic energies: of the right distribution in a very high box."""
    scene = gp.Scene(
        gp.Container((1000.0, 1000.0)), [gp.Species(20, 0.01, temperature=1.0)], gravity=(0.0, -1.0)
    )
    scene.to_file(tmp_path / "scene.yaml")
    settings = {"samples": 4000, "duration": 4000.0, "equilibration": 0.0}
    points = [
        point(tmp_path / "scene.yaml", **settings, **{"scene.species.0.temperature": t, "scene.gravity.1": g})
        for g in (-100.0, 0.0)
        for t in (1.0, 1e5)
    ]
    points = [replace(p, name=f"run-{n}") for n, p in enumerate(points)]
    rng = np.random.default_rng(3)
    stored = {}
    for p in points:
        made = p.scene
        pull = made.gravity[1] if made.gravity else 0.0
        start = gp.Simulation(made, gp.EventDriven(), seed=p.seed(0)).initial_state
        energy = start.kinetic_energy - pull * (start.positions[:, 1] - 0.01).sum()
        share = rng.beta(20, 20, 4001) if pull else np.ones(4001)
        columns = {"kinetic_energy": ("frame", energy * share), "time": ("frame", np.arange(4001.0))}
        stored[p.replica_path(0)] = xr.Dataset(columns)
    monkeypatch.setattr(gravity, "runs", runs_of(stored))
    return points


def test_heat_capacity_without_and_with_gravity(boxes):
    # What was made up is the distribution in a box much higher than the one of the scene.
    ds = gravity.heat_capacity(boxes, {"blocks": 20})
    high, flat = ds.isel(pair=0), ds.isel(pair=1)
    assert float(flat["slope"]) == pytest.approx(1.0) == float(flat["slope_expected"])
    assert flat["fluctuation"].values == pytest.approx(np.ones(2))
    assert abs(float(high["slope"]) - 2.0) < 4.0 * float(high["slope_error"])
    exact = 41.0 / 21.0  # (2 N + 1) / (N + 1)
    assert np.all(np.abs(high["fluctuation"] - exact) < 4.0 * high["fluctuation_error"])
    assert float(high["fluctuation_error"].max()) < 0.1


def test_points_that_are_not_pairs_are_refused(boxes):
    for chosen in (boxes[:3], boxes[1:3]):
        with pytest.raises(ValueError, match="pair"):
            gravity.heat_capacity(chosen, {"blocks": 20})
