"""The price of features: ratios to the plain scene, and removal of absent features from the source."""

from __future__ import annotations

import ast
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from reproduction.families.drawn import Points, draw, shows, varied

from gaspart.errors import SceneError
from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.cost.claims import price_of_features as claims
from gaspart.reproduction.families.cost.figure import price_of_features as draw_price_of_features
from gaspart.reproduction.families.cost.measure import _row
from gaspart.reproduction.families.cost.measure import price_of_features as measure_price_of_features
from gaspart.reproduction.jobs.count_instructions import FEATURES, count_instructions, strip_features
from gaspart.reproduction.jobs.measure_cost import measure_cost
from gaspart.reproduction.points import jobs
from gaspart.reproduction.points.point import Point

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    root = tmp_path_factory.mktemp("points")
    common = {"scene": str(ROOT / "config/scenes/price.yaml"), "engine": "event", "duration": 2, "samples": 2}
    small = {"scene.species.0.count": 100, "scene.species.1.count": 100}
    made = []
    features = {}, {"scene.species.1.mass": 4.0}, {"record_events": True}, {"stress": True}
    for k, (feature, equilibration) in enumerate(product(features, (0, 0.5))):
        varied = {**feature, "equilibration": equilibration, "without": list(feature) or ["scene.gravity"]}
        point = Point("price", str(k), "measure_cost", {**common, **small, **varied}, str(root), 3)
        Path(point.path).parent.mkdir(parents=True, exist_ok=True)
        measure_cost(**point.arguments).write(point.path)
        made.append(point)
    return made


def test_costs_are_those_of_the_plain_scene_times_a_ratio(points):
    ds = measure_price_of_features(points, {})
    assert ds["feature"].values.tolist() == ["plain", "two masses", "recording", "stress"]
    assert ds["ratio_freedom"].values.tolist() == [1.0] * 4
    assert np.all(ds["ratio_error"] > 0.0) and np.all(ds["ratio"] > 0.0)
    assert np.all(ds["pair_tests"] > 1.0)


def test_the_scene_beside_lacks_the_feature_and_is_timed_as_often(points):
    with xr.open_dataset(points[2].path) as made:
        assert made.sizes == {"partition": 2, "repeat": 2}
        assert made["collisions"].values[0] != made["collisions"].values[1]
    with xr.open_dataset(points[0].path) as made:  # the plain scene beside itself
        assert made["collisions"].values[0] == made["collisions"].values[1]


def test_only_costs_have_a_scene_beside_them(points):
    with pytest.raises(SceneError, match="without"):
        jobs.validate(replace(points[0], job="simulate"))


def test_scatter_between_jobs_is_the_uncertainty(tmp_path):
    """Jobs of the same work that are disturbed differently."""
    columns = {"engine": "event", "feature": "walls", "seconds": 1.0, "pair_tests": 3.0}
    columns |= {"box_visits": 2.0, "crossings": 1.0}
    ratio = _row([columns | {"log_ratio": value} for value in (0.0, 0.1, 0.2)])["ratio"]
    assert ratio.value == pytest.approx(np.exp(0.1))
    assert ratio.error == pytest.approx(np.exp(0.1) * 0.1 / np.sqrt(3.0))
    assert ratio.freedom == 2.0
    assert np.isnan(_row([columns | {"log_ratio": 0.0}])["ratio"].error)


def test_claims_can_fail(points):
    ds = measure_price_of_features(points, {}).assign(
        ratio=("point", [1.0, 1.1, 2.0, 1.1]),
        ratio_error=("point", [0.01, 0.02, 0.02, 0.02]),
        ratio_freedom=("point", [20.0] * 4),
        instructions=("kernel", [1000, 1000]),
        stripped=("kernel", [1000, 900]),
    )
    ds = ds.assign_coords(kernel=["event", "step"])
    assert judge(claims(ds)) == ["agrees", "disagrees", "agrees", "agrees", "disagrees", "agrees"]
    assert judge(claims(ds.assign(ratio=("point", [1.2, 1.1, 1.2, 1.1]))))[2] == "disagrees"


def test_branches_on_absent_features_are_cut_out():
    source = """
def move(particle, gravity):
    if gravity is not None:
        particle.fall(gravity)
    if oversized is None:
        particle.go()
    else:
        particle.look()
    return 1.0 if masses is None else masses[particle], other is None
"""
    assert strip_features(source).split("\n")[1:] == [
        "    pass",
        "    particle.go()",
        "    return (1.0, other is None)",
    ]


def test_what_follows_the_return_of_an_absent_feature_is_cut_out():
    source = """
def is_full(record):
    if record is None:
        return False
    return record.filled == record.room
"""
    assert strip_features(source).split("\n")[1:] == ["    return False"]


def test_all_optional_arguments_of_the_kernels_are_features_or_choices_of_a_method():
    methods = {"all_pairs", "lists", "queue", "threads", "cells", "boxes", "square", "dense", "least_part"}
    optional = {
        test.left.id
        for path in (ROOT / "src/gaspart/kernels").rglob("*.py")
        if path.parent.name != "compile"  # which compiles kernels, and has none
        for test in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(test, ast.Compare) and isinstance(test.ops[0], ast.Is | ast.IsNot)
        if isinstance(test.left, ast.Name) and test.left.id.islower()
        if ast.unparse(test.comparators[0]) == "None"
    }
    assert optional == FEATURES | methods


@pytest.mark.thorough
def test_absent_features_leave_nothing_in_the_machine_code(points, tmp_path):
    gas = {"dimension": 3, "count": 50, "radius": 0.5, "side": 9, "boundary": "periodic", "temperature": 1.0}
    point = Point("price", "plain", "count_instructions", gas, str(tmp_path), 3)
    Path(point.path).parent.mkdir(parents=True)
    count_instructions(**point.arguments).write(point.path)
    ds = measure_price_of_features([*points, point], {})
    assert ds["kernel"].values.tolist() == ["event", "step"]
    assert ds["stripped"].values.min() > 1000
    assert np.abs(ds["instructions"] / ds["stripped"] - 1.0).max() < 1e-3


def test_times_and_counted_work_are_drawn_for_each_feature():
    ones = np.ones(4)
    columns = dict.fromkeys(("seconds", "ratio", "ratio_error", "pair_tests", "crossings"), ("point", ones))
    ds = varied(xr.Dataset({**columns}))
    ds["engine"] = ("point", ["event", "event", "event", "step"])
    ds["feature"] = ("point", ["plain", "walls", "gravity", "plain"])
    ds["crossings"] = ds["crossings"] * (ds["engine"] == "event")
    times, work = draw(draw_price_of_features, ds).axes
    event, step = ds.isel(point=[0, 1, 2]), ds.isel(point=[3])
    rows, others = np.array([0.0, -1.0, -2.0]) + 0.06, np.array([-0.06])
    shows(
        times,
        Points(event["ratio"], rows, x_error=event["ratio_error"]),
        Points(step["ratio"], others, x_error=step["ratio_error"]),
    )
    counted = (event["pair_tests"], rows), (event["crossings"], rows), (step["pair_tests"], others)
    shows(work, *(Points(*one) for one in counted))
    assert [label.get_text() for label in times.get_yticklabels()] == ["plain", "walls", "gravity"]
    assert times.get_yticks().tolist() == [0, -1, -2]
