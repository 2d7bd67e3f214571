"""The price of features: ratios to the plain scene, and removal of absent features from the source."""

import ast
from pathlib import Path

import numpy as np
import pytest

from gaspart.claims import judge
from gaspart.experiments.jobs.measure_cost import measure_cost
from gaspart.experiments.price.claims import price_of_features as claims
from gaspart.experiments.price.measure import price_of_features
from gaspart.experiments.price.stripped import FEATURES, instructions, stripped
from gaspart.planning import grid

ROOT = Path(__file__).parents[3]
SETTINGS = {"count_instructions": False}


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    root = tmp_path_factory.mktemp("points")
    common = {"scene": str(ROOT / "config/scenes/price.yaml"), "engine": "event", "duration": 2, "samples": 2}
    small = {"scene.species.0.count": 100, "scene.species.1.count": 100}
    made = []
    for k, feature in enumerate([{}, {"scene.species.1.mass": 4.0}, {"record_events": True}]):
        point = grid.Point("price", str(k), "measure_cost", {**common, **small, **feature}, str(root), 3)
        recipe = grid.recipe(point)
        run = measure_cost(
            grid.scene(point), grid.engines(point), tuple(recipe["seeds"][0]), recipe["equilibration"],
            recipe["stretch"], recipe["repeats"], recipe["record"],
        )  # fmt: skip
        Path(point.path).parent.mkdir(parents=True, exist_ok=True)
        run.to_netcdf(point.path)
        made.append(point)
    return made


def test_costs_are_those_of_the_plain_scene_times_a_ratio(points):
    ds = price_of_features(points, SETTINGS)
    assert ds["feature"].values.tolist() == ["plain", "two masses", "recording"]
    assert ds["ratio"].values == pytest.approx(ds["seconds"].values / ds["seconds"].values[0])
    assert ds["ratio_error"].values[0] == 0.0
    assert np.all(ds["pair_tests"] > 1.0)


def test_there_must_be_a_plain_scene(points):
    with pytest.raises(ValueError, match="no plain scene"):
        price_of_features(points[1:], SETTINGS)


def test_claims_can_fail(points):
    ds = price_of_features(points, SETTINGS).assign(
        ratio=("point", [1.0, 1.1, 2.0]),
        ratio_error=("point", [0.0, 0.02, 0.02]),
        instructions=("kernel", [1000, 1000]),
        stripped=("kernel", [1000, 900]),
    )
    ds = ds.assign_coords(kernel=["event", "step"])
    assert judge(claims(ds)) == ["agrees", "disagrees", "agrees", "disagrees"]


def test_branches_on_absent_features_are_cut_out():
    source = """
def move(body, gravity):
    if gravity is not None:
        body.fall(gravity)
    if oversized is None:
        body.go()
    else:
        body.look()
    return 1.0 if masses is None else masses[body], other is None
"""
    assert stripped(source).split("\n")[1:] == [
        "    pass",
        "    body.go()",
        "    return (1.0, other is None)",
    ]


def test_what_follows_the_return_of_an_absent_feature_is_cut_out():
    source = """
def is_full(record):
    if record is None:
        return False
    return record.filled == record.room
"""
    assert stripped(source).split("\n")[1:] == ["    return False"]


def test_all_optional_arguments_of_the_kernels_are_features_or_choices_of_a_method():
    methods = {"queue", "threads", "cells", "boxes", "square"}
    optional = {
        test.left.id
        for path in (ROOT / "src/gaspart/kernels").rglob("*.py")
        for test in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(test, ast.Compare) and isinstance(test.ops[0], ast.Is | ast.IsNot)
        if isinstance(test.left, ast.Name) and test.left.id.islower()
        if ast.unparse(test.comparators[0]) == "None"
    }
    assert optional == FEATURES | methods


@pytest.mark.thorough
def test_absent_features_leave_nothing_in_the_machine_code():
    for own, bare in instructions().values():
        assert bare > 1000
        assert abs(own / bare - 1.0) < 1e-3
