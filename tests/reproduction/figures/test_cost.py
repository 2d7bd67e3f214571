"""Ratios to the scene without a feature, and speeds on several cores, of small jobs and of made-up times."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numba import config

from gaspart.analysis.estimate import Estimate
from gaspart.reproduction.figures import cost
from gaspart.reproduction.figures._timings import SYSTEMATIC
from gaspart.reproduction.jobs.measure_cost import measure_cost
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Table

ROOT = Path(__file__).parents[3]


def made(folder, name, settings):
    point = Point("gas", name, "measure_cost", settings, str(folder), 3)
    Path(point.path).parent.mkdir(parents=True, exist_ok=True)
    measure_cost(**point.arguments).write(point.path)
    return point


@pytest.fixture(scope="module")
def priced(tmp_path_factory):
    root = tmp_path_factory.mktemp("points")
    common = {"scene": str(ROOT / "config/scenes/price.yaml"), "engine": "event", "duration": 2, "samples": 2}
    small = {"scene.species.0.count": 100, "scene.species.1.count": 100}
    features = {}, {"scene.species.1.mass": 4.0}, {"record_events": True}
    return [
        made(root, str(k), {
            **common, **small, **feature, "equilibration": equilibration,
            "without": list(feature) or ["scene.gravity"],
        })
        for k, (feature, equilibration) in enumerate(product(features, (0, 0.5)))
    ]  # fmt: skip


def test_costs_are_those_of_the_plain_scene_times_a_ratio(priced):
    ds = cost.measure_price(priced, {})
    assert ds["feature"].values.tolist() == ["plain", "two masses", "recording"]
    assert ds["ratio_freedom"].values.tolist() == [1.0] * 3
    assert np.all(ds["ratio_error"] > 0.0) and np.all(ds["ratio"] > 0.0)
    assert np.all(ds["pair_tests"] > 1.0)


def test_scatter_between_jobs_is_the_uncertainty():
    columns = {"engine": "event", "feature": "walls", "seconds": 1.0, "pair_tests": 3.0}
    columns |= {"box_visits": 2.0, "crossings": 1.0}
    ratio = cost.price_row([columns | {"log_ratio": value} for value in (0.0, 0.1, 0.2)])["ratio"]
    assert ratio.value == pytest.approx(np.exp(0.1))
    assert ratio.error == pytest.approx(np.exp(0.1) * 0.1 / np.sqrt(3.0))
    assert ratio.freedom == 2.0
    assert np.isnan(cost.price_row([columns | {"log_ratio": 0.0}])["ratio"].error)


GAS = {
    "dimension": 2, "count": 200, "radius": 0.5, "packing_fraction": 0.1, "boundary": "periodic",
    "temperature": 1.0, "samples": 2,
}  # fmt: skip
STEPS = GAS | {"engine": "step", "time_step": 0.01, "steps": 40, "threads": 2, "without": ["threads"]}
EVENTS = GAS | {"engine": "event", "collisions_per_particle": 4, "copies": 2, "without": ["copies"]}


@pytest.fixture
def points(tmp_path):
    return [made(tmp_path, "steps", STEPS), made(tmp_path, "events", EVENTS)]


def timed(point, own, alone, waited=1.0):
    """The file of a point with these times on the wall, and processors for this share of them."""
    with xr.open_dataset(point.path) as file:
        run = file.load()
    run = run.isel(repeat=[0] * len(own)).assign(wall_seconds=(("partition", "repeat"), [own, alone]))
    run["seconds"] = run["wall_seconds"] * run["cores"] * waited
    run.attrs["cores"] = 2
    run.to_netcdf(point.path)


def test_speeds_are_those_of_the_wall_and_bits_those_of_one_core(points):
    timed(points[0], own=[1.0, 2.0, 1.0], alone=[1.8, 3.6, 1.8])
    timed(points[1], own=[1.0, 1.0, 1.0], alone=[0.9, 0.9, 0.9])
    ds = cost.measure_cores(points, {})
    assert ds.run_engine.values.tolist() == ["time-stepped", "event-driven"]
    assert ds.run_copies.values.tolist() == [1, 2] and ds.run_cores.values.tolist() == [2, 2]
    assert ds.run_speed.values == pytest.approx([1.8, 1.8])
    assert ds.run_speed_error.values == pytest.approx([1.8 * SYSTEMATIC] * 2)
    assert ds.run_same.values.tolist() == [1, 1] and ds.cores == 2


def test_what_others_take_of_the_cores_is_in_every_uncertainty(points):
    for point in points:
        timed(point, own=[1.0, 1.0], alone=[0.2, 0.2], waited=0.9)
    ds = cost.measure_cores(points, {})
    assert ds.waiting == pytest.approx(0.1)
    assert ds.run_speed_error.values == pytest.approx(np.hypot([0.2, 0.4], 0) * SYSTEMATIC + 0.2, abs=0.01)
    without = cost.measure_cores(points[:1], {})
    assert np.isnan(without.waiting) and np.isnan(without.run_speed_error.values).all()


def test_what_needs_more_cores_than_there_are_compares_bits_only(tmp_path, monkeypatch):
    monkeypatch.setattr(config, "NUMBA_NUM_THREADS", 1)
    ds = cost.measure_cores([made(tmp_path, "steps", STEPS), made(tmp_path, "events", EVENTS)], {})
    assert ds.cores == 1 and np.isnan(ds.run_speed.values).all() and ds.run_same.values.tolist() == [1, 1]
    assert np.isnan(ds.model_serial.values).all()


def test_other_bits_are_noticed(points):
    with xr.open_dataset(points[0].path) as file:
        run = file.load()
    run["bits"] = "partition", ["one", "another"]
    run.to_netcdf(points[0].path)
    assert cost.measure_cores(points, {}).run_same.values.tolist() == [0, 1]


def fitted(cores, count, speed, engine="a"):
    gas = Table(xr.Dataset(coords={"run": range(len(count))}), "run")
    columns = {"cores": cores, "count": np.array(count), "speed": Estimate(speed, 0.01)}
    return cost.fit_speed_up(gas.assign(**columns, engine=engine, packing_fraction=0.1))


@pytest.mark.parametrize(("serial", "overhead"), [(0.05, 800.0), (0.0, 800.0), (0.05, 0.0), (0.0, 0.0)])
def test_the_model_finds_the_shares_that_made_the_speeds(serial, overhead):
    cores, count = np.array([2, 2, 2, 4]), np.array([1e4, 1e5, 1e6, 1e5])
    found = fitted(cores, count, cost.speed_up(cores, count, serial, overhead))
    assert found["serial"].value == pytest.approx(serial, abs=1e-6)
    assert found["overhead"].value == pytest.approx(overhead, abs=1e-2)


def test_enskog_is_modelled_where_two_threads_share_its_collisions():
    """Not a gas of one slab, nor slabs that more threads share unevenly."""
    shared = cost.speed_up(2.0, np.array([1e5, 1e6]), 0.05, 800.0)
    speeds = np.array([2, 2, 2, 4]), [1e4, 1e5, 1e6, 1e6], [1.0, *shared, 2.5]
    assert fitted(*speeds, engine="DSMC, Enskog")["serial"].value == pytest.approx(0.05)
    assert fitted(*speeds, engine="time-stepped")["serial"].value > 0.1
