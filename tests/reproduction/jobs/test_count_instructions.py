"""Removal of absent features from the source of kernels."""

import ast
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from gaspart.reproduction.jobs.count_instructions import FEATURES, count_instructions, strip_features
from gaspart.reproduction.points.point import Point

ROOT = Path(__file__).parents[3]


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
def test_absent_features_leave_nothing_in_the_machine_code(tmp_path):
    gas = {"dimension": 3, "count": 50, "radius": 0.5, "side": 9, "boundary": "periodic", "temperature": 1.0}
    point = Point("price", "plain", "count_instructions", gas, str(tmp_path), 3)
    Path(point.path).parent.mkdir(parents=True)
    count_instructions(**point.arguments).write(point.path)
    ds = xr.load_dataset(point.path)
    assert ds["engine"].values.tolist() == ["event", "step"]
    assert ds["stripped"].values.min() > 1000
    assert np.abs(ds["instructions"] / ds["stripped"] - 1.0).max() < 1e-3
