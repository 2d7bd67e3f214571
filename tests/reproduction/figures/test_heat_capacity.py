"""Heat capacity of pairs of runs whose kinetic energies are made up."""

import numpy as np
import pytest
import xarray as xr
from reproduction.figures.stored import runs_of

import gaspart as gp
from gaspart.reproduction.figures import heat_capacity
from gaspart.reproduction.points.point import Point


@pytest.fixture
def boxes(tmp_path, monkeypatch):
    """Pairs of points with made-up kinetic energies: of the right distribution in a very high box."""
    scene = gp.Scene(
        gp.Container((1000.0, 1000.0)), [gp.Species(20, 0.01, temperature=1.0)], gravity=(0.0, -1.0)
    )
    scene.to_file(tmp_path / "scene.yaml")
    settings = {"scene": str(tmp_path / "scene.yaml"), "samples": 4000, "duration": 4000.0}
    settings |= {"equilibration": 0.0}
    made = [
        settings | {"scene.species.0.temperature": temperature, "scene.gravity.1": pull}
        for pull in (-100.0, 0.0)
        for temperature in (1.0, 1e5)
    ]
    points = [Point("column", f"run-{n}", "simulate", own, "results/points", 1) for n, own in enumerate(made)]
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
    monkeypatch.setattr(heat_capacity, "runs", runs_of(stored))
    return points


def test_heat_capacity_without_and_with_gravity(boxes):
    # What was made up is the distribution in a box much higher than the one of the scene.
    ds = heat_capacity.measure(boxes, {"blocks": 20})
    high, flat = ds.isel(pair=0), ds.isel(pair=1)
    assert float(flat["slope"]) == pytest.approx(1.0) == float(flat["slope_expected"])
    assert flat["fluctuation"].values == pytest.approx(np.ones(2))
    assert abs(float(high["slope"]) - 2.0) < 4.0 * float(high["slope_error"])
    exact = 41.0 / 21.0  # (2 N + 1) / (N + 1)
    assert np.all(np.abs(high["fluctuation"] - exact) < 4.0 * high["fluctuation_error"])
    assert float(high["fluctuation_error"].max()) < 0.1
